/* step_cuts.h - how a step that may be refused is cut, and for how long it stays cut.
 *
 * A refused step is taken as two halves, each of which may be refused in turn. What refuses a
 * step mostly refuses the next one too: so the parts stay as short, also in the steps that
 * follow, until one twice as long may be tried. Two in a row earn a try that looks well, a good
 * many earn one in any case.
 */
#ifndef STEP_CUTS_H
#define STEP_CUTS_H

#include <clothsim/integrator.h>

enum { STEP_CUTS_SOON = 2, STEP_CUTS_AT_LAST = 16 };

struct step_cuts {
    uint32_t depth, at; /* a step has 2^depth parts of this length, of which `at` are done */
    uint32_t done;      /* parts of this length in a row */
};

/* s, of a part of a step of h */
static inline double step_cuts_length(const struct step_cuts *cuts, double h) {
    return h / (double)(1u << cuts->depth);
}

static inline bool step_cuts_are_over(const struct step_cuts *cuts) {
    return cuts->at == 1u << cuts->depth;
}

/* A part that is as long as two can begin here, and they have earned it. */
static inline bool step_cuts_may_grow(const struct step_cuts *cuts) {
    return cuts->depth > 0 && cuts->at % 2 == 0 && cuts->done >= STEP_CUTS_SOON;
}

static inline void step_cuts_grow(struct step_cuts *cuts) {
    *cuts = (struct step_cuts){cuts->depth - 1, cuts->at / 2, 0};
}

/* The part was refused, and is to be halved. */
static inline void step_cuts_refuse(struct step_cuts *cuts) {
    *cuts = (struct step_cuts){cuts->depth + 1, 2 * cuts->at, 0};
}

/* The part was taken. */
static inline void step_cuts_accept(struct step_cuts *cuts) {
    cuts->at++;
    cuts->done++;
}

#endif
