/* run_report.h - reports a run as a table for readers and as JSON for programs. */
#ifndef CS_RUN_REPORT_H
#define CS_RUN_REPORT_H

#include "cli/run/job_state.h"

/* Adds the table. */
void cs_report_print_table(const struct cs_job *job, struct cs_text *out);

/* Adds the JSON: every value that decides the run, versions, counts, energies, outcome and the
 * hash of each frame. */
void cs_report_print_json(const struct cs_job *job, struct cs_text *out);

/* Adds "blew up: ... at t = ... s, particle ..." or "finished". */
void cs_report_print_outcome(const struct cs_job *job, struct cs_text *out);

#endif
