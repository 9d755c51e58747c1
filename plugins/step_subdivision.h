/* step_subdivision.h - the lengths of the parts of a step that may be refused.
 *
 * A refused step is taken as two halves, each of which may be refused in turn: parts of
 * h/2^depth. The cause of a refusal mostly lasts: the parts stay as short, also in the
 * following steps. A part of twice the length may be tried where it would be aligned (an even
 * number of parts is done) and after GROW_AFTER parts in a row, if it looks admissible, or
 * after GROW_ALWAYS_AFTER in any case. */
#ifndef CS_STEP_SUBDIVISION_H
#define CS_STEP_SUBDIVISION_H

#include <clothsim/integrator.h>

/* Accepted parts in a row before a longer one is tried; chosen by trial. */
enum { STEP_SUBDIVISION_GROW_AFTER = 2, STEP_SUBDIVISION_GROW_ALWAYS_AFTER = 16 };

/* The position in a step. Zeroed: whole steps. */
struct step_subdivision {
    uint32_t depth,
        parts_done; /* a step has 2^depth parts of this length, of which so many are done */
    uint32_t accepted_in_row; /* accepted parts of this length in a row */
};

/* Length in s of a part of a step of h; exact, as a division by a power of 2. */
static inline double step_subdivision_length(const struct step_subdivision *cuts, double h) {
    return h / (double)(1u << cuts->depth);
}

/* True if all parts of the step are done. */
static inline bool step_subdivision_are_over(const struct step_subdivision *cuts) {
    return cuts->parts_done == 1u << cuts->depth;
}

/* True if a part of twice the length is aligned here, and enough parts were accepted. */
static inline bool step_subdivision_may_grow(const struct step_subdivision *cuts) {
    return cuts->depth > 0 && cuts->parts_done % 2 == 0 &&
           cuts->accepted_in_row >= STEP_SUBDIVISION_GROW_AFTER;
}

/* Doubles the length of the parts. */
static inline void step_subdivision_grow(struct step_subdivision *cuts) {
    *cuts = (struct step_subdivision){cuts->depth - 1, cuts->parts_done / 2, 0};
}

/* Halves the parts after a refusal. */
static inline void step_subdivision_refuse(struct step_subdivision *cuts) {
    *cuts = (struct step_subdivision){cuts->depth + 1, 2 * cuts->parts_done, 0};
}

/* Counts an accepted part. */
static inline void step_subdivision_accept(struct step_subdivision *cuts) {
    cuts->parts_done++;
    cuts->accepted_in_row++;
}

#endif
