/* compare.h - compares error and cost of many methods on one scene.
 *
 *   scene -> key -> compare.csv of an earlier run -> verified reference and horizon
 *   -> cells, by falling step or tolerance -> each run, measured, appended to compare.csv
 *   -> rounds of timed runs -> orders, ranking, verdict, warnings -> report
 * Cells are timed one at a time in this process; only stepping is timed. A series ends at its
 * first cell over budget, because shorter steps take longer. */
#ifndef CS_COMPARE_H
#define CS_COMPARE_H

#include "study/compare/compare_state.h"

/* Makes the comparison and fills compare.csv. If there is no valid reference, the cells have
 * costs and counts only: that is a result. On failure the finished rows stay in compare.csv.
 * settings must outlive *compare; cs_compare_finish must be called in any case. CS_ERR_USAGE
 * for methods that cannot be read or a folder of another comparison; CS_ERR_SCENE,
 * CS_ERR_MODULE, CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error);
/* Frees all results; a zeroed object is allowed. */
void cs_compare_finish(struct cs_compare *compare);

#endif
