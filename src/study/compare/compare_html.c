/* Prints a comparison as one HTML file that needs no other: legible from 400 pixels on, and
 * printed on paper. */
#include "base/install_paths.h"
#include "session/provenance_write.h"
#include "study/compare/compare.h"
#include "study/compare/compare_curves.h"
#include "study/compare/equal_error.h"

#include <math.h>

/* Columns of the table of rows; on a narrow screen a row is a paragraph, and each number has
 * the name of its column before it. */
static const char *const columns[] = {"series",   "options", "error",  "path", "largest",
                                      "velocity", "energy",  "order",  "work", "time",
                                      "25 %",     "75 %",    "rounds", ""};
enum { COLUMNS = sizeof columns / sizeof *columns, TEXT_COLUMNS = 2 };

/* The style: lines wrap, and rows stay whole on paper. */
static void add_style(struct cs_text *out) {
    cs_text_add(
        out,
        "<style>:root{color-scheme:light "
        "dark}body{font-family:sans-serif;max-width:78em;margin:1em auto;"
        "padding:0 1em}pre{background:#8882;padding:.6em;white-space:pre-wrap;"
        "overflow-wrap:anywhere}svg{width:100%%;height:auto;max-width:60em}th{cursor:pointer}"
        "table{border-collapse:collapse;font-size:80%%;width:100%%}"
        "td,th{padding:.15em .4em;text-align:right;border-bottom:1px solid #ddd}"
        "td:nth-child(-n+2),th:nth-child(-n+2){text-align:left;overflow-wrap:anywhere}"
        ".front{font-weight:bold}"
        ".strip{display:grid;gap:.5em;font-size:80%%;"
        "grid-template-columns:repeat(auto-fill,minmax(min(46%%,15em),1fr))}"
        "figure{margin:0;overflow-wrap:anywhere}figure img{width:100%%;display:block}"
        ".bar{display:flex;flex-wrap:wrap;gap:.5em;align-items:center;font-size:80%%}"
        ".bar i{height:1em;flex:1 1 12em;max-width:30em;print-color-adjust:exact}\n");
    /* on a narrow screen a row is a paragraph */
    cs_text_add(out, "@media screen and (max-width:62em){tr:first-child{display:none}"
                     "tr,td{display:block}tr{border-bottom:1px solid #ddd;padding:.3em 0}"
                     "td{display:inline-block;border:0;padding:0 .8em 0 0;text-align:left}"
                     "td:empty{display:none}td::before{color:#666;font-weight:normal}");
    cs_text_add(out, "td[title]::before{content:attr(title) \" \"}");
    cs_text_add(out, "}\n@media print{@page{size:A4 landscape;margin:12mm}"
                     "body{max-width:none;margin:0;padding:0;font-size:75%%}svg{max-width:42em}"
                     "tr,figure,svg,pre{break-inside:avoid}h2,h3,.bar{break-after:avoid}}\n"
                     /* the figure is black on white: turned, its hues stay */
                     "@media screen and (prefers-color-scheme:dark){svg{filter:invert(.9) "
                     "hue-rotate(180deg)}}</style>");
}

/* A click on the name of a column sorts the rows by it, another one the other way; empty fields
 * come last. */
static const char sorting[] =
    "<script>document.querySelectorAll('th').forEach((head,c)=>head.onclick=()=>{\n"
    "const table=head.closest('table'),way=head.way=-head.way||1;\n"
    "const key=row=>row.cells[c].textContent;\n"
    "[...table.rows].slice(1).sort((a,b)=>{const p=key(a),q=key(b);return !p-!q||\n"
    "way*(p-q||(isNaN(p)?p.localeCompare(q):0))}).forEach(row=>table.tBodies[0].append(row))"
    "})</script>\n";

/* Head of the page. */
static void add_head(const struct cs_compare *compare, struct cs_text *out) {
    cs_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
                     "<meta name=\"viewport\" content=\"width=device-width\">\n"
                     "<title>Error against run time: ");
    cs_text_add_html(out, compare->scene);
    cs_text_add(out, "</title>\n");
    add_style(out);
    cs_text_add(out, "</head><body>\n<h1>Error against run time: ");
    cs_text_add_html(out, compare->scene);
    cs_text_add(out, "</h1>\n");
}

/* Adds a text of another printer as it is; frees it. */
static void add_preformatted(const char *title, struct cs_text *text, struct cs_text *out) {
    cs_text_add(out, "<h2>%s</h2>\n<pre>", title);
    cs_text_add_html(out, cs_text_get(text));
    cs_text_add(out, "</pre>\n");
    out->failed |= text->failed;
    cs_text_finish(text);
}

/* The figure, for a page that needs no other file; what it misses is in the table. */
static void add_diagram(const struct cs_compare *compare, struct cs_text *out) {
    struct cs_plot_settings settings;
    struct cs_diagram plot;
    struct cs_error error = {0};
    cs_compare_plot_settings(compare, CS_WIDTH_PAGE, &settings);
    if (!cs_plot_make(&plot, &settings, &error))
        cs_diagram_add_svg(cs_renderer_folder(), &plot, out, &error);
    if (error.status) {
        cs_text_add(out, "<p>No diagram: ");
        cs_text_add_html(out, error.message);
        cs_text_add(out, "</p>\n");
    }
    cs_plot_finish(&plot);
}

static void add_number(const char *column, double value, struct cs_text *out) {
    if (isfinite(value))
        cs_text_add(out, "<td title=\"%s\">%.3g</td>", column, value);
    else
        cs_text_add(out, "<td></td>");
}

/* Series and options, in two fields. */
static void add_names(const struct cs_cell *cell, struct cs_text *out) {
    struct cs_text options = {0};
    cs_text_add(out, "<td>");
    cs_text_add_html(out, cell->series);
    cs_text_add(out, "</td><td>");
    cs_options_add_short(cell->options, &options);
    cs_text_add_html(out, cs_text_get(&options));
    out->failed |= options.failed;
    cs_text_finish(&options);
    cs_text_add(out, "</td>");
}

/* One row of the table; bold if it is on the front. */
static void add_table_row(const struct cs_cell *cell, bool front, struct cs_text *out) {
    const double numbers[] = {cell->error,          cell->path_error,   cell->max_error,
                              cell->velocity_error, cell->energy_error, cell->order,
                              cell->work,           1e3 * cell->cpu,    1e3 * cell->cpu_low,
                              1e3 * cell->cpu_high, cell->runs};
    cs_text_add(out, "<tr%s>", front ? " class=\"front\"" : "");
    add_names(cell, out);
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        add_number(columns[TEXT_COLUMNS + k], numbers[k], out);
    cs_text_add(out, "<td>");
    cs_text_add_html(out, cell->outcome);
    cs_text_add(out, "</td></tr>\n");
}

static void add_table(const struct cs_compare *compare, const struct cs_ranking *ranking,
                      struct cs_text *out) {
    cs_text_add(out, "<h2>All rows</h2>\n<p>Bold: nothing is both cheaper and more accurate. "
                     "Errors at the end in m (RMS; path: over all frames; largest: of a "
                     "particle) and m/s; energy as a fraction of the largest kinetic energy; "
                     "times in ms, median and quartiles.</p>\n<table><tr>");
    for (int k = 0; k < COLUMNS; k++)
        cs_text_add(out, "<th>%s</th>", columns[k]);
    cs_text_add(out, "</tr>\n");
    for (uint32_t k = 0; k < compare->cells.n; k++)
        add_table_row(compare->cells.cells + k, ranking->on_pareto_front[k], out);
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

void cs_compare_print_html(const struct cs_compare *compare, const struct cs_ranking *ranking,
                           struct cs_text *out) {
    struct cs_text command = {0}, reference = {0}, verdict = {0}, warnings = {0}, series = {0},
                   ledger = {0};
    const char *typed = compare->settings->command;
    add_head(compare, out);
    cs_text_add(&command, "%s\n", typed ? typed : "");
    cs_table_add_reference(compare, &reference);
    cs_verdict_print(ranking, "", compare, &verdict);
    cs_compare_warn(compare, "", &warnings);
    cs_table_add_series(compare, true, &series);
    if (typed)
        add_preformatted("Command", &command, out);
    add_preformatted("Reference", &reference, out);
    add_preformatted("Verdict", &verdict, out);
    add_preformatted("Notes", &warnings, out);
    cs_compare_contact_sheet_add(compare, true, out);
    /* two families that disagree leave nothing to draw errors against */
    cs_text_add(out, "<h2>Diagram</h2>\n");
    if (compare->reference.families_agree)
        add_diagram(compare, out);
    add_preformatted("Series", &series, out);
    cs_table_add_ledger(compare, &ledger);
    if (ledger.length)
        add_preformatted("Energy balance", &ledger, out);
    add_table(compare, ranking, out);
    add_machine(out);
    cs_text_add(out, "%s", sorting);
    cs_text_add(out, "</body></html>\n");
    cs_text_finish(&command);
}
