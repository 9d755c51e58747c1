/* compare_report.h - writes the files of a comparison besides compare.csv: JSON, Markdown,
 * diagrams. */
#ifndef CS_COMPARE_REPORT_H
#define CS_COMPARE_REPORT_H

#include "study/compare/compare_table.h"

/* Writes compare.json, compare.md, error_time.gp and error_work.gp, and compare.html on
 * request; PNG, SVG and PDF of the diagrams if gnuplot is found. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_write_report(const struct cs_compare *compare,
                                       struct cs_error *error);

#endif
