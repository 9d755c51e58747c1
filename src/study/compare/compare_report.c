/* Writes compare.json with everything for programs, compare.md as a report for readers, and the
 * diagram; compare_html.c prints the page. */
#include "study/compare/compare.h"

#include "base/file.h"
#include "base/install_paths.h"
#include "base/json_writer.h"
#include "session/provenance_write.h"

#include <stdio.h>
#include <string.h>

/* --- compare.json --- */

static void add_machine(struct cs_text *out) {
    struct cs_machine machine;
    cs_machine_detect(&machine);
    cs_json_write(
        out,
        "  'machine': {'processor': %s, 'processors': %ld, 'load': %g, 'version': %s, "
        "'compiler': %s, 'flags': %s},\n",
        machine.processor, machine.processors, machine.load, machine.version, machine.compiler,
        machine.flags);
}

static void add_reference(const struct cs_compare_reference *reference, struct cs_text *out) {
    cs_json_write(out, "  'reference': {'methods': [");
    /* a family, its tighter twin, the other family, its tighter twin */
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS; k++)
        cs_json_write(out, ", %s", reference->methods[k]);
    cs_json_write(out, "], 'agree': %d, 'pointwise': %d, 'reason': %s",
                  reference->families_agree, reference->pointwise, reference->reason);
    cs_json_write(
        out, ", 'bar': %g, 'bar_max': %g, 'motion': %g, 'kinetic_energy': %g, 'strain': %g",
        reference->error_bar, reference->error_bar_max, reference->motion_scale,
        reference->kinetic, reference->strain);
    cs_json_write(out, ", 'accuracy': %g, 'amplification': %g, 'horizon': %g},\n",
                  reference->accuracy, reference->horizon.growth, reference->horizon.time);
}

static void add_rank(const struct cs_rank *rank, const struct cs_cell *cells,
                     struct cs_text *out) {
    cs_json_write(out, "{'best': %ld, 'least_work': %ld", (long)(rank->best - cells),
                  (long)(rank->frugal - cells));
    if (rank->runner_up)
        cs_json_write(out, ", 'next': %ld", (long)(rank->runner_up - cells));
    /* without both at that error there is no number */
    if (rank->has_factor)
        cs_json_write(out,
                      ", 'factor': %g, 'interval': [%g, %g], 'pairs': %u, 'told_apart': %d, "
                      "'work_factor': %g, 'work_interval': [%g, %g]",
                      rank->ratio.median, rank->ratio.low, rank->ratio.high, rank->ratio.pairs,
                      rank->is_significant, rank->work.median, rank->work.low, rank->work.high);
    for (enum cs_norm norm = 0; norm < CS_NORMS; norm++)
        if (rank->better_by_norm[norm])
            cs_text_add(out, ", \"by_%s\": %td", cs_norm_names[norm],
                        rank->better_by_norm[norm] - cells);
}

/* Ranks as JSON; cells are given by index in the list "cells". */
static void add_verdict(const struct cs_ranking *ranking, const struct cs_compare *compare,
                        struct cs_text *out) {
    const struct cs_cell *cells = compare->cells.cells;
    cs_json_write(out, "  'rank': %s,\n  'verdict': [", cs_norm_names[ranking->norm]);
    for (uint32_t k = 0; k < ranking->n; k++) {
        cs_json_write(out, ",\n    ");
        add_rank(ranking->ranks + k, cells, out);
        cs_text_add(out, ", \"error\": 1e%d}", ranking->ranks[k].exponent);
    }
    cs_json_write(out, "],\n  'stable_at_frame_step': ");
    if (ranking->frame.best) {
        add_rank(&ranking->frame, cells, out);
        cs_text_add(out, "},\n");
    } else
        cs_text_add(out, "null,\n");
}

/* All columns of a cell, from the table of columns. */
static void add_json_cell(const struct cs_cell *cell, bool front, struct cs_text *out) {
    cs_json_write(out, ",\n    {'front': %d", front);
    for (uint32_t c = 0; c < cs_n_columns; c++) {
        const struct cs_column *column = cs_columns + c;
        const char *field = (const char *)cell + column->offset;
        if (column->type == CS_CELL_TEXT)
            cs_json_write(out, ", %s: %s", column->name, field);
        else if (column->type == CS_CELL_FLAG)
            cs_json_write(out, ", %s: %d", column->name, *(const bool *)field);
        else
            cs_json_write(out, ", %s: %g", column->name, cs_cell_number(cell, column));
    }
    cs_text_add(out, "}");
}

/* The whole comparison as one object. */
static void print_json(const struct cs_compare *compare, const struct cs_ranking *ranking,
                       struct cs_text *out) {
    cs_json_write(out, "{\n  'schema': 1,\n  'scene': %s,\n", compare->scene);
    cs_json_write(out, "  'particles': %u, 'springs': %u, 'time': %g, 'fps': %g,\n",
                  compare->particles, compare->springs, compare->time, compare->fps);
    cs_json_write(out, "  'contact': %s, 'switched_off': %s,\n",
                  compare->contact ? "force" : "", cs_text_get(&compare->switched_off));
    add_machine(out);
    add_reference(&compare->reference, out);
    add_verdict(ranking, compare, out);
    /* in the order of the sweep: the verdict above refers to cells by index */
    cs_json_write(out, "  'cells': [");
    for (uint32_t k = 0; k < compare->cells.n; k++)
        add_json_cell(compare->cells.cells + k, ranking->on_pareto_front[k], out);
    cs_text_add(out, "\n  ]\n}\n");
}

/* --- compare.md --- */

/* Adds lines as they are; frees them. */
static void add_code(struct cs_text *lines, struct cs_text *out) {
    cs_text_add(out, "```\n");
    cs_text_add_lines(out, cs_text_get(lines));
    cs_text_add(out, "```\n");
    out->failed |= lines->failed;
    cs_text_finish(lines);
}

/* Adds a list of lines that begin with "- "; frees them. */
static void add_list(const char *title, struct cs_text *lines, struct cs_text *out) {
    const char *line = cs_text_get(lines);
    cs_text_add(out, "## %s\n\n", title);
    for (size_t length; *line; line += length + (line[length] == '\n')) {
        struct cs_text item = {0};
        length = strcspn(line, "\n");
        cs_text_add(&item, "%.*s", (int)length, line);
        cs_text_add_markdown(out, cs_text_get(&item));
        cs_text_add(out, "\n");
        cs_text_finish(&item);
    }
    cs_text_add(out, "\n");
    out->failed |= lines->failed;
    cs_text_finish(lines);
}

/* Head of the report: scene, reference, machine, and how times were measured. */
static void add_setting(const struct cs_compare *compare, struct cs_text *out) {
    struct cs_machine machine;
    struct cs_text reference = {0};
    cs_machine_detect(&machine);
    cs_text_add(out, "# Error against run time: ");
    cs_text_add_markdown(out, compare->scene);
    cs_text_add(out, "\n\n");
    cs_table_add_reference(compare, &reference);
    add_code(&reference, out);
    cs_text_add(
        out,
        "\nMachine: %s, %ld processors, load %.1f. clothsim %s, %s, %s. Times are "
        "processor\ntime of stepping only. The cells that the verdict rests on were timed in "
        "turns, "
        "in %u\nrounds: medians; factors are those of pairs of one round, with their 95 %% "
        "interval.\n\n",
        *machine.processor ? machine.processor : "unknown", machine.processors, machine.load,
        machine.version, machine.compiler, machine.flags, compare->rounds.n);
}

static void print_markdown(const struct cs_compare *compare, const struct cs_ranking *ranking,
                           bool drawn, struct cs_text *out) {
    struct cs_text verdict = {0}, warnings = {0}, methods = {0}, ledger = {0};
    add_setting(compare, out);
    cs_verdict_print(ranking, "- ", compare, &verdict);
    add_list("Verdict", &verdict, out);
    cs_compare_warn(compare, "- ", &warnings);
    if (warnings.length)
        add_list("Warnings", &warnings, out);
    if (drawn)
        cs_text_add(out, "## Diagram\n\n![error against work and time](compare.png)\n\n");
    cs_compare_contact_sheet_add(compare, false, out);
    cs_table_add_series(compare, true, &methods);
    cs_text_add(out, "## Methods\n\n");
    add_code(&methods, out);
    cs_text_add(out, "\n");
    cs_table_add_ledger(compare, &ledger);
    if (ledger.length) {
        cs_text_add(out, "## Energy balance\n\nEnergy gained by the end; `integrator` is the "
                         "energy that the method itself gained or lost.\n\n");
        add_code(&ledger, out);
        cs_text_add(out, "\n");
    }
    cs_text_add(out, "All cells are in compare.csv.\n");
}

/* --- the files --- */

/* Writes the diagram in two widths. Without the module that draws there is none, and a warning
 * says so. */
static enum cs_status draw(struct cs_compare *compare, struct cs_error *error) {
    static const struct {
        const char *name;
        double width;
    } figures[] = {{"compare", CS_WIDTH_PAGE}, {"compare_column", CS_WIDTH_COLUMN}};
    char title[400], path[4200];
    snprintf(title, sizeof title, "%.255s, %.4g s, %u particles", compare->scene, compare->time,
             compare->particles);
    for (int k = 0; k < 2 && !error->status; k++) {
        struct cs_plot_settings settings;
        struct cs_diagram plot;
        struct cs_error unseen = {0};
        cs_compare_plot_settings(compare, figures[k].width, &settings);
        settings.title = title;
        snprintf(path, sizeof path, "%s/%s", compare->settings->folder, figures[k].name);
        if (!cs_plot_make(&plot, &settings, error) &&
            cs_diagram_write(cs_renderer_folder(), &plot, path, CS_FORMATS_ALL, &unseen) ==
                CS_ERR_MODULE)
            snprintf(compare->undrawn, sizeof compare->undrawn, "%.299s", unseen.message);
        else if (unseen.status)
            *error = unseen;
        cs_plot_finish(&plot);
    }
    return error->status;
}

static enum cs_status write_text(const struct cs_compare *compare, const char *name,
                                 struct cs_text *text, struct cs_error *error) {
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", compare->settings->folder, name);
    return cs_file_write_text(path, text, error);
}

enum cs_status cs_compare_write_report(struct cs_compare *compare, struct cs_error *error) {
    struct cs_ranking ranking;
    struct cs_text json = {0}, markdown = {0}, html = {0};
    if (cs_ranking_make(&ranking, compare, error))
        return error->status;
    // two families that disagree leave nothing to draw errors against
    if (compare->reference.families_agree)
        draw(compare, error);
    const bool drawn = compare->reference.families_agree && !*compare->undrawn;
    print_json(compare, &ranking, &json);
    print_markdown(compare, &ranking, drawn, &markdown);
    if (!error->status && !write_text(compare, "compare.json", &json, error) &&
        !write_text(compare, "compare.md", &markdown, error) && compare->settings->html) {
        cs_compare_print_html(compare, &ranking, &html);
        write_text(compare, "compare.html", &html, error);
    }
    cs_text_finish(&html);
    cs_text_finish(&json);
    cs_text_finish(&markdown);
    cs_ranking_finish(&ranking);
    return error->status;
}
