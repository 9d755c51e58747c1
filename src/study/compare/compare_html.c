/* Prints a comparison as one self-contained HTML file. */
#include "study/compare/compare_html.h"

#include "study/compare/compare_svg.h"
#include "study/compare/compare_table.h"
#include "study/compare/verdict.h"

#include <math.h>

/* Head of the page with its style. */
static void add_head(const struct cs_compare *compare, struct cs_text *out) {
    cs_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
                     "<title>Error against run time: ");
    cs_svg_add_text(out, compare->scene);
    cs_text_add(out,
                "</title>\n<style>body{font-family:sans-serif;max-width:60em;margin:2em auto}"
                "pre{background:#f4f4f4;padding:.6em;overflow:auto}table{border-collapse:"
                "collapse;font-size:80%%}td,th{padding:.15em .5em;text-align:right;"
                "border-bottom:1px solid #ddd}td:first-child,th:first-child{text-align:left}"
                ".front{font-weight:bold}</style></head><body>\n<h1>Error against run time: ");
    cs_svg_add_text(out, compare->scene);
    cs_text_add(out, "</h1>\n");
}

/* Adds a text of another printer as it is; frees it. */
static void add_preformatted(const char *title, struct cs_text *text, struct cs_text *out) {
    cs_text_add(out, "<h2>%s</h2>\n<pre>", title);
    cs_svg_add_text(out, cs_text_get(text));
    cs_text_add(out, "</pre>\n");
    out->failed |= text->failed;
    cs_text_finish(text);
}

/* Error against the column x; energy error if the norm has no reference. */
static void add_diagram(const struct cs_compare *compare, const struct cs_ranking *ranking,
                        const char *x, struct cs_text *out) {
    const bool known = cs_norm_is_known(ranking->norm, &compare->reference);
    const struct cs_plot_settings settings = {
        .cells = compare->cells.cells,
        .n = compare->cells.n,
        .x = cs_column_find(x),
        .y = cs_norm_column(known ? ranking->norm : CS_NORM_ENERGY)};
    cs_svg_print(&settings, out);
}

static void add_number(double value, struct cs_text *out) {
    cs_text_add(out, "<td>");
    if (isfinite(value))
        cs_text_add(out, "%.3g", value);
    cs_text_add(out, "</td>");
}

/* One row of the table; bold if it is on the front. */
static void add_row(const struct cs_cell *cell, bool front, struct cs_text *out) {
    const double numbers[] = {cell->error,          cell->path_error,   cell->max_error,
                              cell->velocity_error, cell->energy_error, cell->order,
                              cell->work,           1e3 * cell->cpu,    1e3 * cell->cpu_low,
                              1e3 * cell->cpu_high, cell->runs};
    cs_text_add(out, "<tr%s><td>", front ? " class=\"front\"" : "");
    cs_svg_add_text(out, cell->series);
    cs_text_add(out, "</td><td>");
    cs_svg_add_text(out, cell->options);
    cs_text_add(out, "</td>");
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        add_number(numbers[k], out);
    cs_text_add(out, "<td>");
    cs_svg_add_text(out, cell->outcome);
    cs_text_add(out, "</td></tr>\n");
}

static void add_table(const struct cs_compare *compare, const struct cs_ranking *ranking,
                      struct cs_text *out) {
    cs_text_add(out, "<h2>All rows</h2>\n<p>Bold: nothing is both cheaper and more accurate. "
                     "Errors at the end in m (RMS; path: over all frames; largest: of a "
                     "particle) and m/s; energy as a fraction of the largest kinetic energy; "
                     "times in ms, median and quartiles.</p>\n<table><tr>");
    static const char *const names[] = {"series",   "options", "error",  "path", "largest",
                                        "velocity", "energy",  "order",  "work", "time",
                                        "25 %",     "75 %",    "rounds", ""};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        cs_text_add(out, "<th>%s</th>", names[k]);
    cs_text_add(out, "</tr>\n");
    for (uint32_t k = 0; k < compare->cells.n; k++)
        add_row(compare->cells.cells + k, ranking->on_pareto_front[k], out);
    cs_text_add(out, "</table>\n");
}

/* Machine and build, as of the time of the report. */
static void add_machine(struct cs_text *out) {
    struct cs_machine machine;
    struct cs_text text = {0};
    cs_machine_detect(&machine);
    cs_text_add(&text, "%s: %s, %ld processors, load %.1f\nclothsim %s, %s, %s\n", machine.host,
                machine.processor, machine.processors, machine.load, machine.version,
                machine.compiler, machine.flags);
    add_preformatted("Machine", &text, out);
}

void cs_html_print(const struct cs_compare *compare, const struct cs_ranking *ranking,
                   struct cs_text *out) {
    struct cs_text command = {0}, reference = {0}, verdict = {0}, warnings = {0}, series = {0};
    struct cs_text ledger = {0};
    const char *typed = compare->settings->command;
    add_head(compare, out);
    cs_text_add(&command, "%s\n", typed ? typed : "");
    cs_table_add_reference(compare, &reference);
    cs_verdict_print(ranking, "", compare, &verdict);
    cs_compare_warn(compare, "", &warnings);
    cs_table_add_series(compare, &series);
    cs_table_add_ledger(compare, &ledger);
    if (typed)
        add_preformatted("Command", &command, out);
    add_preformatted("Reference", &reference, out);
    add_preformatted("Verdict", &verdict, out);
    add_preformatted("Notes", &warnings, out);
    cs_text_add(out, "<h2>Diagrams</h2>\n<p>Yellow: the front, where nothing is both cheaper "
                     "and more accurate. Bars: quartiles of the rounds. Crosses: runs that "
                     "did not finish. Grey: below the "
                     "reference's own error.</p>\n");
    if (compare->reference.families_agree) {
        add_diagram(compare, ranking, "cpu", out);
        add_diagram(compare, ranking, "work", out);
    }
    add_preformatted("Series", &series, out);
    if (ledger.length)
        add_preformatted("Energy balance", &ledger, out);
    add_table(compare, ranking, out);
    add_machine(out);
    cs_text_add(out, "</body></html>\n");
    cs_text_finish(&command);
}
