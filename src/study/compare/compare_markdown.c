/* compare_markdown.c - compare.md: one report for people. */
#include "study/compare/compare_report.h"
#include "study/machine.h"

#include <math.h>

static void add_setting(const struct cs_compare *compare, struct cs_text *out) {
    struct cs_machine machine;
    cs_machine_look(&machine);
    cs_text_add(out, "# Error against run time: %s\n\n```\n", compare->scene);
    cs_table_add_reference(compare, out);
    cs_text_add(
        out,
        "```\n\nMachine: %s, %ld processors, load %.1f. clothsim %s, %s, %s. Cells were "
        "timed one\nafter the other: processor time of stepping only, a run before "
        "that is not timed,\nmedians of at least %u runs.\n\n",
        *machine.processor ? machine.processor : "unknown", machine.processors, machine.load,
        machine.version, machine.compiler, machine.flags, compare->settings->runs);
}

static void add_lines(const char *title, struct cs_text *lines, struct cs_text *out) {
    cs_text_add(out, "## %s\n\n%s\n", title, cs_text_get(lines));
    cs_text_finish(lines);
}

static void add_real(struct cs_text *out, const char *format, double value) {
    cs_text_add(out, " | ");
    if (isfinite(value))
        cs_text_add(out, format[1] == 'f' ? "%.0f" : format[1] == 'o' ? "%.2f" : "%.2e", value);
}

static void add_cell(const struct cs_cell *cell, bool front, struct cs_text *out) {
    cs_text_add(out, "| %s%s%s | %s", front ? "**" : "", cell->method, front ? "**" : "",
                cell->options);
    add_real(out, "%e", cell->error);
    add_real(out, "%e", cell->max_path_error);
    add_real(out, "%e", cell->velocity_error);
    add_real(out, "%e", cell->energy_error);
    add_real(out, "%o", cell->order);
    add_real(out, "%e", cell->achieved);
    add_real(out, "%f", cell->evals);
    add_real(out, "%f", cell->solves);
    add_real(out, "%f", cell->iterations);
    add_real(out, "%e", cell->cpu);
    cs_text_add(out, " | %s |\n", cell->outcome);
}

static void add_table(const struct cs_compare *compare, const struct cs_ranking *ranking,
                      struct cs_text *out) {
    cs_text_add(out,
                "## All cells\n\nBold: nothing is both cheaper and more accurate. Errors in m "
                "(RMS at the end; largest of all\nframes) and m/s; energy as a share of the "
                "largest kinetic energy; time in s.\n\n"
                "| method | options | error | largest | velocity | energy | order | error / "
                "rtol | force evaluations | solves | iterations | time | |\n"
                "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (uint32_t k = 0; k < compare->sweep.n; k++)
        add_cell(compare->sweep.cells + k, ranking->front[k], out);
}

void cs_compare_print_markdown(const struct cs_compare *compare,
                               const struct cs_ranking *ranking, bool drawn,
                               struct cs_text *out) {
    struct cs_text verdict = {0}, warnings = {0}, methods = {0};
    add_setting(compare, out);
    cs_ranking_print(ranking, "- ", compare, &verdict);
    add_lines("Verdict", &verdict, out);
    cs_compare_warn(compare, "- ", &warnings);
    if (*cs_text_get(&warnings))
        add_lines("Warnings", &warnings, out);
    cs_text_finish(&warnings);
    if (drawn)
        cs_text_add(out, "## Diagrams\n\n![error against time](error_time.png)\n\n"
                         "![error against work](error_work.png)\n\n");
    cs_text_add(&methods, "```\n");
    cs_table_add_methods(compare, &methods);
    cs_text_add(&methods, "```\n");
    add_lines("Methods", &methods, out);
    add_table(compare, ranking, out);
}
