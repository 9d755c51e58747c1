/* stability_report.h - a map of stability as text, CSV, JSON and diagram. */
#ifndef CS_STABILITY_REPORT_H
#define CS_STABILITY_REPORT_H

#include "study/stability/stability.h"

/* How a map looks: as a table for people, one row a cell, and as JSON. */
void cs_stability_print_table(const struct cs_stability *map, struct cs_text *out);
void cs_stability_print_csv(const struct cs_stability *map, struct cs_text *out);
void cs_stability_print_borders_csv(const struct cs_stability *map, struct cs_text *out);
void cs_stability_print_json(const struct cs_stability *map, struct cs_text *out);
/* A gnuplot script that draws NAME.png from NAME.csv and NAME_border.csv, all in one folder. */
void cs_stability_print_plot(const struct cs_stability *map, const char *name,
                             struct cs_text *out);

#endif
