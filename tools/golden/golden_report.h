/* golden_report.h - the rows of a check in the formats of programs and browsers. */
#ifndef CS_GOLDEN_REPORT_H
#define CS_GOLDEN_REPORT_H

#include "golden/golden_row.h"

/* Rows so far; zeroed: none. */
struct cs_golden_report {
    struct cs_text json, junit, html;
    double seconds; /* of all rows */
};

/* Words for a row: "ok", "DIFFERS", "FAILED", "skip", "accepted", "added". */
const char *cs_golden_verdict(const struct cs_golden *golden, const struct cs_golden_row *row);
/* True if the row makes the check fail. */
bool cs_golden_is_failure(const struct cs_golden *golden, const struct cs_golden_row *row);
/* Adds "image NAME SCENE  INTEGRATOR  OVERRIDES  frame N", without what the row has not. */
void cs_golden_add_name(const struct cs_golden_row *row, struct cs_text *out);

/* Adds a row to all formats. Pictures of a row that differs are read from the golden folder;
 * one that cannot be read is left out. */
void cs_golden_report_add(struct cs_golden_report *report, const struct cs_golden *golden,
                          const struct cs_golden_row *row);

/* Print the whole report with the counts of the check: for programs; as JUnit; as one page
 * that holds its pictures. */
void cs_golden_report_print_json(const struct cs_golden_report *report,
                                 const struct cs_golden *golden, struct cs_text *out);
void cs_golden_report_print_junit(const struct cs_golden_report *report,
                                  const struct cs_golden *golden, struct cs_text *out);
void cs_golden_report_print_html(const struct cs_golden_report *report,
                                 const struct cs_golden *golden, struct cs_text *out);
void cs_golden_report_finish(struct cs_golden_report *report);

#endif
