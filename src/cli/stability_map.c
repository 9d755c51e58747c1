/* Makes the stability map of one method or of all, and writes its files. */
#include "cli/stability_map.h"

#include "base/file.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "cli/run_output.h"
#include "cli/show/screen.h"
#include "io/subprocess.h"
#include "study/stability/stability_report.h"

#include <stdio.h>

/* Writes one file of a map; frees the text. */
static enum cs_status write_file(const struct cs_stability_options *options, const char *name,
                                 const char *ending, struct cs_text *text,
                                 struct cs_error *error) {
    char path[4200];
    snprintf(path, sizeof path, "%s/%s%s", options->map.folder, name, ending);
    cs_file_write_text(path, text, error);
    cs_text_finish(text);
    return error->status;
}

/* Refuses a map whose files would overwrite the scene, or, but for -y, earlier ones. A shard
 * writes none. */
static enum cs_status check_files(const struct cs_stability_options *options,
                                  const struct cs_stability *map, struct cs_error *error) {
    static const char *const endings[] = {".csv", "_border.csv", ".json", ".gp"};
    enum { FILES = sizeof endings / sizeof *endings };
    const char *folder = options->map.folder, *list[FILES + 1] = {NULL};
    char name[CS_SERIES_BYTES], files[FILES][CS_SERIES_BYTES + 16], path[4200];
    cs_series_file_name(map->series, name);
    for (int k = 0; k < FILES; k++) {
        snprintf(files[k], sizeof files[k], "%s%s", name, endings[k]);
        list[k] = files[k];
        snprintf(path, sizeof path, "%s/%s", folder, files[k]);
        if (!options->overwrite && options->map.shard.count < 2 &&
            cs_output_check_file(path, error))
            return error->status;
    }
    return cs_study_files_check(&map->settings->session, folder, list, error);
}

static enum cs_status write_files(const struct cs_stability_options *options,
                                  const struct cs_stability *map, struct cs_gnuplot *gnuplot,
                                  struct cs_error *error) {
    char name[CS_SERIES_BYTES];
    struct cs_text cells = {0}, borders = {0}, json = {0}, plot = {0};
    cs_series_file_name(map->series, name);
    cs_stability_print_csv(map, &cells);
    cs_stability_print_borders_csv(map, &borders);
    cs_stability_print_json(map, &json);
    cs_stability_print_plot(map, name, &plot);
    write_file(options, name, ".csv", &cells, error);
    if (!error->status)
        write_file(options, name, "_border.csv", &borders, error);
    if (!error->status)
        write_file(options, name, ".json", &json, error);
    if (!error->status)
        write_file(options, name, ".gp", &plot, error);
    /* the picture is made of the files above */
    if (!error->status && !cs_gnuplot_run(options->map.folder, name, gnuplot, error))
        cs_print_gnuplot_warning(gnuplot, error);
    /* not before all results are in files */
    if (!error->status && !cs_journal_remove(map, error))
        cs_manifest_write_study(options->map.folder, error);
    cs_text_finish(&borders);
    cs_text_finish(&json);
    cs_text_finish(&plot);
    return error->status;
}

/* Reports a shard: some of the columns are no map yet. */
static void print_shard(const struct cs_stability *map, bool quiet) {
    if (!quiet)
        printf("%s: shard %u of %u is in %s (see: clothsim merge)\n", map->series,
               map->settings->shard.index, map->settings->shard.count, map->journal.table.path);
}

/* For --strict: fails if a cell was not stable. */
static enum cs_status check_cells(const struct cs_stability *map, struct cs_error *error) {
    uint32_t bad = 0;
    for (uint32_t c = 0; c < map->n_columns; c++)
        for (uint32_t r = 0; r < map->n_rows; r++)
            bad += !cs_stability_is_sound(map->columns[c].cells[r].verdict);
    return bad ? cs_fail(error, CS_ERR_UNSTABLE, "%s: %u of %u cells are not stable",
                         map->series, bad, map->n_columns * map->n_rows)
               : CS_OK;
}

/* An incomplete map (of a shard) writes no files: its results are in the journal. */
enum cs_status cs_stability_map_one(const struct cs_stability_options *options,
                                    struct cs_error *error) {
    struct cs_progress progress;
    struct cs_stability map;
    struct cs_stability_settings asked = options->map;
    const bool quiet = options->quiet;
    struct cs_gnuplot gnuplot = {0};
    struct cs_screen screen;
    if (options->show && cs_screen_open(&screen, false, error))
        return error->status;
    asked.progress = cs_progress_show;
    asked.ctx = &progress;
    cs_progress_begin(&progress, "cell", quiet);
    if (!cs_stability_open(&map, &asked, error) && !check_files(options, &map, error))
        cs_stability_run(&map, error);
    cs_progress_end(&progress);
    if (error->status == CS_ERR_INTERRUPT) {
        *error = (struct cs_error){0};
        cs_fail(
            error, CS_ERR_INTERRUPT,
            "interrupted; finished cells are in %s, and the same command continues from there",
            map.journal.table.path);
        cs_manifest_write_study(options->map.folder, error);
    }
    if (!error->status && !map.is_complete) {
        if (!cs_manifest_write_study(options->map.folder, error))
            print_shard(&map, quiet);
    } else if (!error->status && !cs_folder_create(options->map.folder, error) &&
               !write_files(options, &map, &gnuplot, error) && (!quiet || options->show)) {
        struct cs_text out = {0};
        char name[CS_SERIES_BYTES];
        cs_series_file_name(map.series, name);
        if (options->show)
            cs_screen_print_map(&screen, &map, &out);
        else
            cs_stability_print_table(&map, &out);
        /* gnuplot may be missing or fail: the line then says that there is no picture */
        if (!quiet)
            cs_text_add(&out, "  %.3g s; %s/%s.csv, _border.csv, .json, .gp%s\n\n", map.wall,
                        options->map.folder, name,
                        gnuplot.drawn      ? ", .png"
                        : gnuplot.n_failed ? "; no picture"
                                           : "; gnuplot not found: no picture");
        cs_print_out(stdout, &out, error);
    }
    if (!error->status && options->strict)
        check_cells(&map, error);
    cs_stability_finish(&map);
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
