/* compare_time.h - what the cells of a comparison cost, timed in rounds. */
#ifndef CS_COMPARE_TIME_H
#define CS_COMPARE_TIME_H

#include "study/compare/compare_state.h"

/* Times every finished cell that was run only once, and the contenders for the verdict (see
 * ranking.h) in rounds, until their ratios are known well enough, or until settings.runs rounds
 * or the time for it is over. CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
enum cs_status cs_compare_time(struct cs_compare *compare, struct cs_error *error);

#endif
