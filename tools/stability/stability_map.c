/* Makes the stability map of one method or of all, and writes its files. */
#include "stability/stability_map.h"

#include "base/file.h"
#include "base/install_paths.h"
#include "borders/stability.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "cli/run_folder.h"
#include "cli/show/screen.h"
#include "session/scene_view.h"
#include "shared/table_plot.h"

#include <stdio.h>

/* Refuses a map whose files would overwrite the scene, or, but for -y, earlier ones. A shard
 * writes none. */
static enum cs_status check_files(const struct cs_stability_options *options,
                                  const struct cs_stability *stability,
                                  struct cs_error *error) {
    static const char *const endings[] = {".csv", "_border.csv", ".json",
                                          ".png", ".svg",        ".pdf"};
    enum { FILES = sizeof endings / sizeof *endings };
    const char *folder = options->map.folder, *list[FILES + 1] = {NULL};
    char name[CS_SERIES_BYTES], files[FILES][CS_SERIES_BYTES + 16], path[4200];
    cs_series_file_name(stability->series, name);
    for (int k = 0; k < FILES; k++) {
        snprintf(files[k], sizeof files[k], "%s%s", name, endings[k]);
        list[k] = files[k];
        snprintf(path, sizeof path, "%s/%s", folder, files[k]);
        if (!options->overwrite && options->map.shard.count < 2 &&
            cs_output_check_file(path, error))
            return error->status;
    }
    return cs_study_files_check(&stability->settings->session, folder, list, error);
}

/* Makes the diagram of the tables that were written. */
static enum cs_status make_plot(const struct cs_stability_options *options,
                                const struct cs_stability *stability, struct cs_diagram *plot,
                                struct cs_error *error) {
    char name[CS_SERIES_BYTES], path[4200], title[CS_TITLE_BYTES];
    struct cs_number_table table;
    cs_series_file_name(stability->series, name);
    snprintf(path, sizeof path, "%s/%s.csv", options->map.folder, name);
    snprintf(title, sizeof title, "%s: stable time steps, %.255s, %g s of motion per cell",
             stability->series, stability->session.scene->path, stability->settings->seconds);
    cs_plot_begin(plot, title, 1.35 * CS_WIDTH_COLUMN);
    return cs_table_plot_read(plot, &table, path, error);
}

/* *drawn: false without the module that draws, which is no failure. */
static enum cs_status write_files(const struct cs_stability_options *options,
                                  const struct cs_stability *stability, struct cs_diagram *plot,
                                  bool *drawn, struct cs_error *error) {
    static const struct {
        const char *ending;
        void (*print)(const struct cs_stability *stability, struct cs_text *out);
    } tables[] = {{".csv", cs_stability_print_csv},
                  {"_border.csv", cs_stability_print_borders_csv},
                  {".json", cs_stability_print_json}};
    char name[CS_SERIES_BYTES], path[4200];
    struct cs_error unseen = {0};
    cs_series_file_name(stability->series, name);
    for (size_t k = 0; k < sizeof tables / sizeof *tables && !error->status; k++) {
        struct cs_text text = {0};
        tables[k].print(stability, &text);
        snprintf(path, sizeof path, "%s/%s%s", options->map.folder, name, tables[k].ending);
        cs_file_write_text(path, &text, error);
    }
    /* the picture is made of the files above */
    snprintf(path, sizeof path, "%s/%s", options->map.folder, name);
    if (!error->status && !make_plot(options, stability, plot, error))
        *drawn = !cs_diagram_write(cs_renderer_folder(), plot, path, CS_FORMATS_ALL, &unseen);
    if (unseen.status == CS_ERR_MODULE)
        cs_print_message(unseen.message);
    else if (unseen.status)
        *error = unseen;
    /* not before all results are in files */
    if (!error->status && !cs_journal_remove(stability, error))
        cs_manifest_write_study(options->map.folder, error);
    return error->status;
}

/* Prints the table or, on a screen, the diagram of a finished map. */
static enum cs_status print_map(const struct cs_stability_options *options,
                                const struct cs_stability *stability,
                                const struct cs_screen *screen, const struct cs_diagram *plot,
                                bool drawn, struct cs_error *error) {
    char name[CS_SERIES_BYTES];
    struct cs_text out = {0};
    cs_series_file_name(stability->series, name);
    if (options->show) {
        cs_screen_print_diagram(screen, plot, &out);
        cs_print_raw(stdout, &out, error);
    } else
        cs_stability_print_table(stability, &out);
    if (!options->quiet)
        cs_text_add(&out, "  %.3g s; %s/%s.csv, _border.csv, .json%s\n\n", stability->wall,
                    options->map.folder, name, drawn ? ", .png, .svg, .pdf" : "; no picture");
    return error->status ? error->status : cs_print_out(stdout, &out, error);
}

/* Reports a shard: some of the columns are no map yet. */
static enum cs_status print_shard(const struct cs_stability *stability,
                                  struct cs_error *error) {
    struct cs_text out = {0};
    cs_text_add(&out, "%s: shard %u of %u is in %s (see: clothsim merge)\n", stability->series,
                stability->settings->shard.index, stability->settings->shard.count,
                stability->journal.table.path);
    return cs_print_out(stdout, &out, error);
}

/* For --strict: fails if a cell was not stable. */
static enum cs_status check_cells(const struct cs_stability *stability,
                                  struct cs_error *error) {
    uint32_t bad = 0;
    for (uint32_t c = 0; c < stability->n_columns; c++)
        for (uint32_t r = 0; r < stability->n_rows; r++)
            bad += !cs_stability_is_sound(stability->columns[c].cells[r].verdict);
    return bad ? cs_fail(error, CS_ERR_UNSTABLE, "%s: %u of %u cells are not stable",
                         stability->series, bad, stability->n_columns * stability->n_rows)
               : CS_OK;
}

/* An incomplete map (of a shard) writes no files: its results are in the journal. */
enum cs_status cs_stability_map_one(const struct cs_stability_options *options,
                                    struct cs_error *error) {
    struct cs_progress progress;
    struct cs_stability stability;
    struct cs_stability_settings asked = options->map;
    const bool quiet = options->quiet;
    struct cs_diagram plot = {0};
    struct cs_screen screen = {0};
    bool drawn = false;
    if (options->show && cs_screen_open(&screen, false, error))
        return error->status;
    asked.progress = cs_progress_show;
    asked.ctx = &progress;
    cs_progress_begin(&progress, "cell", quiet);
    if (!cs_stability_open(&stability, &asked, error) &&
        !check_files(options, &stability, error))
        cs_stability_run(&stability, error);
    cs_progress_end(&progress);
    if (error->status == CS_ERR_INTERRUPT) {
        *error = (struct cs_error){0};
        cs_fail(
            error, CS_ERR_INTERRUPT,
            "interrupted; finished cells are in %s, and the same command continues from there",
            stability.journal.table.path);
        cs_manifest_write_study(options->map.folder, error);
    }
    if (!error->status && !stability.is_complete) {
        if (!cs_manifest_write_study(options->map.folder, error) && !quiet)
            print_shard(&stability, error);
    } else if (!error->status && !cs_folder_create(options->map.folder, error) &&
               !write_files(options, &stability, &plot, &drawn, error) &&
               (!quiet || options->show))
        print_map(options, &stability, &screen, &plot, drawn, error);
    cs_plot_finish(&plot);
    if (!error->status && options->strict)
        check_cells(&stability, error);
    cs_stability_finish(&stability);
    return error->status;
}

enum cs_status cs_stability_map_all(struct cs_stability_options *options,
                                    struct cs_error *error) {
    struct cs_session_settings *session = &options->map.session;
    struct cs_registry registry = {0};
    if (!cs_registry_add_files(&registry, session->plugins, session->n_plugins, error))
        cs_registry_open_all(&registry, error);
    for (uint32_t k = 0; k < registry.n && !error->status; k++) {
        const struct cs_integrator *integrator = registry.entries[k].integrator;
        /* a module that was refused */
        if (!integrator)
            continue;
        const bool other = integrator->fidelity == CS_FIDELITY_OTHER;
        /* a map varies dt, and its theory is that of the equation of motion */
        if (cs_method_takes_dt(integrator) && !other) {
            session->integrator = integrator->name;
            cs_stability_map_one(options, error);
        } else if (!options->quiet)
            printf("%s: not applicable, it %s\n\n", integrator->name,
                   other                              ? "solves another model"
                   : integrator->traits & CS_ADAPTIVE ? "chooses its own steps"
                                                      : "has no option dt");
    }
    cs_registry_finish(&registry);
    return error->status;
}
