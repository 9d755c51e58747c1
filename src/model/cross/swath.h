/* swath.h - where points may be during a straight move, as boxes. */
#ifndef CS_SWATH_H
#define CS_SWATH_H

#include <float.h>
#include <stdbool.h>
#include <stddef.h>

/* The box of some points where the move begins, and the box of their displacements. */
struct cs_swath {
    double low[3], high[3];
    double least[3], most[3];
};

/* Of no point. */
static inline struct cs_swath cs_swath_none(void) {
    const double b = DBL_MAX;
    return (struct cs_swath){{b, b, b}, {-b, -b, -b}, {b, b, b}, {-b, -b, -b}};
}

static inline void cs_swath_widen(double *low, double *high, double below, double above) {
    // not a number widens nothing
    *low = below < *low ? below : *low;
    *high = above > *high ? above : *high;
}

/* A point of (3,n) from x0 to x1; x1 NULL: it stays. */
static inline void cs_swath_add(struct cs_swath *swath, size_t n, size_t i, const double *x0,
                                const double *x1) {
    for (size_t c = 0; c < 3; c++) {
        const double x = x0[c * n + i], move = x1 ? x1[c * n + i] - x : 0;
        cs_swath_widen(swath->low + c, swath->high + c, x, x);
        cs_swath_widen(swath->least + c, swath->most + c, move, move);
    }
}

static inline void cs_swath_join(struct cs_swath *swath, const struct cs_swath *other) {
    for (size_t c = 0; c < 3; c++) {
        cs_swath_widen(swath->low + c, swath->high + c, other->low[c], other->high[c]);
        cs_swath_widen(swath->least + c, swath->most + c, other->least[c], other->most[c]);
    }
}

/* Whether points of one may come as near to points of the other as `reach` at one share of the
 * move. Only displacements against each other matter: what moves as a whole costs nothing. Of
 * boxes that stay it is exact. */
static inline bool cs_swaths_meet(const struct cs_swath *a, const struct cs_swath *b,
                                  double reach) {
    for (size_t c = 0; c < 3; c++) {
        const double closing = a->least[c] - b->most[c], opening = a->most[c] - b->least[c];
        const double low = a->low[c] - b->high[c] + (closing < 0 ? closing : 0);
        const double high = a->high[c] - b->low[c] + (opening > 0 ? opening : 0);
        if (!(low <= reach && high >= -reach))
            return false;
    }
    return true;
}

#endif
