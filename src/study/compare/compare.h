/* compare.h - error against cost of many methods on one scene.
 *
 *   scene -> verified reference and horizon -> sweep: cells -> each run, measured, timed
 *     -> compare.csv as rows finish -> orders, verdict, warnings -> report
 *
 * Cells are timed one after the other in this process; only stepping is timed.
 */
#ifndef CS_COMPARE_H
#define CS_COMPARE_H

#include "study/compare/compare_state.h"

/* The whole way. A reference that is none is a result: then cells have costs and counts only.
 * On failure the finished rows stay in compare.csv. */
enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error);
void cs_compare_finish(struct cs_compare *compare);

#endif
