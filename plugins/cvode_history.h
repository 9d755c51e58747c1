/* cvode_history.h - moves CVODE's history with a state that a commit has changed.
 *
 * The history is a polynomial in time, stored as its value and its scaled derivatives at the
 * last step (Nordsieck form). An impulse, as of a contact, shifts all of it: the value
 * changes, the derivatives stay, and error control sees the change of the forces. A restart
 * instead, at order 1 with a step to match, would follow every step in which anything
 * touches: on a sphere with rtol = 1e-5 that takes five times the steps, at no smaller error.
 *
 * CVODE has no call for that. Its value vector is the one into which a start copies the
 * state: sundials_vector.h remembers the target of that copy. CVodeGetDky checks at the first
 * change that it is the right vector. If it is not, the history cannot be moved and the
 * method restarts. */
#ifndef CVODE_HISTORY_H
#define CVODE_HISTORY_H

#include "sundials_common.h"

/* Access to the value of the polynomial. */
struct cvode_history {
    N_Vector value;   /* borrowed from CVODE; NULL: not known */
    N_Vector scratch; /* for the check */
    bool is_checked;  /* CVodeGetDky has confirmed `value`, or refuted it */
};

/* Call update before CVodeReInit, to forget the vector, and find after it, to take the target
 * of the copy. */
void cvode_history_update(struct cvode_history *history, struct sundials *base);
void cvode_history_find(struct cvode_history *history, const struct sundials *base);

/* Sets the value of the history to base->state. Returns false if that is impossible: the
 * caller must restart CVODE. */
bool cvode_history_move(struct cvode_history *history, struct sundials *base);

#endif
