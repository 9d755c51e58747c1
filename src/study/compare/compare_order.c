/* compare_order.c - observed orders: slopes of error against step. */
#include "study/compare/compare.h"

#include <math.h>
#include <string.h>

/* Two successive slopes within that are steady. */
#define STEADY 0.1

static bool is_usable(const struct cs_cell *cell, double bar, double scale) {
    // near the bar the reference's own error is measured, near the motion everything is lost
    return cs_cell_is_finished(cell) && cell->error > 10 * bar && cell->error < 0.1 * scale;
}

/* NAN where there is none */
static double slope(const struct cs_cell *a, const struct cs_cell *b, double bar,
                    double scale) {
    if (a->adaptive || b->adaptive || strcmp(a->method, b->method) ||
        !is_usable(a, bar, scale) || !is_usable(b, bar, scale) || !(b->step < a->step))
        return (double)NAN;
    return log(a->error / b->error) / log(a->step / b->step);
}

void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale) {
    for (uint32_t k = 0; k < n; k++) {
        const double here = k > 0 ? slope(cells + k - 1, cells + k, bar, scale) : (double)NAN;
        const double before =
            k > 1 ? slope(cells + k - 2, cells + k - 1, bar, scale) : (double)NAN;
        const double after =
            k + 1 < n ? slope(cells + k, cells + k + 1, bar, scale) : (double)NAN;
        const bool steady = fabs(here - before) < STEADY || fabs(here - after) < STEADY;
        cells[k].order = steady ? here : (double)NAN;
    }
}
