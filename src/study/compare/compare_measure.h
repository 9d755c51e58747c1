/* compare_measure.h - how wrong one cell is, what it counts, and the order of a method. */
#ifndef CS_COMPARE_MEASURE_H
#define CS_COMPARE_MEASURE_H

#include "study/compare/compare_state.h"

/* Runs and measures one cell. Its time is that of this one run. */
enum cs_status cs_compare_measure(const struct cs_compare *compare, struct cs_cell *cell,
                                  struct cs_error *error);

/* Fills the orders of a method's successive cells where the slope is steady. */
void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale);

#endif
