/* compare_report.h - the files of a comparison beside compare.csv: JSON, Markdown, diagrams. */
#ifndef CS_COMPARE_REPORT_H
#define CS_COMPARE_REPORT_H

#include "study/compare/compare_table.h"

/* Writes compare.json, compare.md, error_time.gp and error_work.gp, and the diagrams' PNG and
 * SVG where gnuplot is found. */
enum cs_status cs_compare_write_report(const struct cs_compare *compare,
                                       struct cs_error *error);

#endif
