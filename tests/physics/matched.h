/* matched.h - bodies that keep their shape, and how far they are from it, for the tests. */
#ifndef MATCHED_H
#define MATCHED_H

#include "fixture.h"

#include <math.h>

#define FLOATING                                                                               \
    "{\"bodies\": [{%s, \"shape_matching\": {%s}, \"mass\": {\"total\": 1}%s}],"               \
    " \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": 60}}"
#define BOX   "\"mesh\": {\"shape\": \"box\", \"detail\": 4}"
#define BALL  "\"mesh\": {\"shape\": \"sphere\", \"detail\": 4}"
#define LIMBS "\"mesh\": {\"shape\": \"limbs\", \"detail\": 12}"
#define SHEET "\"cloth\": {\"grid\": [5, 4]}"

static inline double distance(const struct fixture *body, const double *x, size_t i, size_t j) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = x[c * body->n + i] - x[c * body->n + j];
        squared += d * d;
    }
    return sqrt(squared);
}

/* Farthest that a distance between two particles is from that at time 0. */
static inline double deformation(const struct fixture *body) {
    double most = 0;
    for (size_t i = 0; i < body->n; i++)
        for (size_t j = 0; j < i; j++)
            most = fmax(most, fabs(distance(body, body->x, i, j) -
                                   distance(body, body->system->start, i, j)));
    return most;
}

static inline double moved(const struct fixture *body) {
    double most = 0;
    for (size_t k = 0; k < 3 * body->n; k++)
        most = fmax(most, fabs(body->x[k] - body->system->start[k]));
    return most;
}

/* what a body is pressed into: one plane, its mirror image, a line, one point, and a tangle */
enum { FLAT, INVERTED, LINE, POINT, TANGLE, DAMAGES };
static inline void damage(struct fixture *body, int way) {
    for (size_t i = 0; i < body->n; i++)
        for (size_t c = 0; c < 3; c++) {
            double *x = body->x + c * body->n + i;
            if (way == FLAT)
                *x *= c != 2;
            else if (way == INVERTED)
                *x *= c == 2 ? -1 : 1;
            else if (way == LINE)
                *x *= c == 0;
            else if (way == POINT)
                *x = 0.25;
            else
                *x += 0.7 * sin(12.9898 * (double)(3 * i + c + 1));
        }
}

#endif
