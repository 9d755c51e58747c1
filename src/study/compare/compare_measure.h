/* compare_measure.h - measures error and counts of one cell, and the observed orders. */
#ifndef CS_COMPARE_MEASURE_H
#define CS_COMPARE_MEASURE_H

#include "study/compare/compare_state.h"

/* Runs one cell within compare->budget and fills its errors, counts, outcome and module. cpu is
 * the time of this one run. A method that fails or blows up is an outcome. CS_ERR_INTERRUPT,
 * CS_ERR_MEMORY; the cell is then incomplete. */
enum cs_status cs_compare_measure(const struct cs_compare *compare, struct cs_cell *cell,
                                  struct cs_error *error);

/* Fills the orders of n cells, sorted by falling step within a series, where two successive
 * slopes agree. bar and scale in m: the reference's error, and the motion. */
void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale);

#endif
