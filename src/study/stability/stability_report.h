/* stability_report.h - prints a stability map as text, CSV, JSON and a gnuplot script. */
#ifndef CS_STABILITY_REPORT_H
#define CS_STABILITY_REPORT_H

#include "base/table.h"
#include "study/stability/stability.h"

/* Adds the map as a table for readers: letters of verdicts, border and limits below, legend. */
void cs_stability_print_table(const struct cs_stability *map, struct cs_text *out);
/* The columns of both files behind the first, which is called like the axis. */
extern const struct cs_column cs_stability_columns[], cs_stability_border_columns[];
extern const uint32_t cs_stability_n_columns, cs_stability_n_border_columns;

/* Adds one row per cell; cell_left .. cell_top are the edges of its rectangle in a diagram. */
void cs_stability_print_csv(const struct cs_stability *map, struct cs_text *out);
/* Adds one row per column: border, limits of theory in s, and the mode that limits the step. */
void cs_stability_print_borders_csv(const struct cs_stability *map, struct cs_text *out);
/* Adds the whole map; limits that do not exist are null. */
void cs_stability_print_json(const struct cs_stability *map, struct cs_text *out);
/* Adds a gnuplot script that draws NAME.png from NAME.csv and NAME_border.csv in its folder. */
void cs_stability_print_plot(const struct cs_stability *map, const char *name,
                             struct cs_text *out);

#endif
