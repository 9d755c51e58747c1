/* compare_time.h - measures the cost of the cells of a comparison in rounds. */
#ifndef CS_COMPARE_TIME_H
#define CS_COMPARE_TIME_H

#include "study/compare/compare_state.h"

/* Times every finished cell of this machine that was run only once, and the contenders for the
 * verdict (ranking.h) in rounds. Ends when the ratios of the contenders are known well enough,
 * after settings.runs rounds, or when the time for rounds is used up. Updates cpu, cpu_low,
 * cpu_high, runs and outliers of the cells. CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
enum cs_status cs_compare_time(struct cs_compare *compare, struct cs_error *error);

#endif
