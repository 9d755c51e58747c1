/* step_subdivision.h - how a step that may be refused is cut, and for how long it stays cut.
 *
 * A refused step is taken as two halves, each of which may be refused in turn. What refuses a
 * step mostly refuses the next one too: so the parts stay as short, also in the steps that
 * follow, until one twice as long may be tried. Two in a row earn a try that looks well, a good
 * many earn one in any case.
 */
#ifndef CS_STEP_SUBDIVISION_H
#define CS_STEP_SUBDIVISION_H

#include <clothsim/integrator.h>

enum { STEP_SUBDIVISION_GROW_AFTER = 2, STEP_SUBDIVISION_GROW_ALWAYS_AFTER = 16 };

struct step_subdivision {
    uint32_t depth,
        parts_done; /* a step has 2^depth parts of this length, of which `at` are done */
    uint32_t accepted_in_row; /* parts of this length in a row */
};

/* s, of a part of a step of h */
static inline double step_subdivision_length(const struct step_subdivision *cuts, double h) {
    return h / (double)(1u << cuts->depth);
}

static inline bool step_subdivision_are_over(const struct step_subdivision *cuts) {
    return cuts->parts_done == 1u << cuts->depth;
}

/* A part that is as long as two can begin here, and they have earned it. */
static inline bool step_subdivision_may_grow(const struct step_subdivision *cuts) {
    return cuts->depth > 0 && cuts->parts_done % 2 == 0 &&
           cuts->accepted_in_row >= STEP_SUBDIVISION_GROW_AFTER;
}

static inline void step_subdivision_grow(struct step_subdivision *cuts) {
    *cuts = (struct step_subdivision){cuts->depth - 1, cuts->parts_done / 2, 0};
}

/* The part was refused, and is to be halved. */
static inline void step_subdivision_refuse(struct step_subdivision *cuts) {
    *cuts = (struct step_subdivision){cuts->depth + 1, 2 * cuts->parts_done, 0};
}

/* The part was taken. */
static inline void step_subdivision_accept(struct step_subdivision *cuts) {
    cuts->parts_done++;
    cuts->accepted_in_row++;
}

#endif
