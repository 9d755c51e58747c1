/* cvode_history.h - moves CVODE's history along with a state that a commit has moved.
 *
 * The history is a polynomial in time, kept as its value and its scaled derivatives at the last
 * step (Nordsieck form). An impulse, as of a contact, shifts the whole of it: the value is
 * moved, the derivatives stay, and the error control meets what the move changes in the forces.
 * A new start, at order 1 with a step to match, would follow every step in which anything
 * touches: on a sphere with rtol = 1e-5 five times the steps, and no smaller an error.
 *
 * CVODE has no call for that. Its value vector is the one into which a start copies the state;
 * that it is the right one is checked by CVodeGetDky at the first move. Where it is not, there
 * is no moving, and the method starts anew.
 */
#ifndef CVODE_HISTORY_H
#define CVODE_HISTORY_H

#include "sundials_common.h"

struct cvode_history {
    N_Vector value;   /* borrowed from CVODE; NULL: not known */
    N_Vector scratch; /* to check with */
    bool is_checked;
};

/* Before and after CVodeReInit. */
void cvode_history_update(struct cvode_history *history, struct sundials *base);
void cvode_history_find(struct cvode_history *history, const struct sundials *base);

/* Moves the history to base->state; false: it cannot be done, start anew. */
bool cvode_history_move(struct cvode_history *history, struct sundials *base);

#endif
