/* Which order BDF may take; see cvode_order.h. */
#include "cvode_order.h"

/* steps in a row that make one try the high order, and go back the first time */
enum { LONG = 20, PATIENCE = 100 };

/* Below the first the tolerance asks for steps that the high order can take as well: without
 * damping order 5 makes a motion grow by (h omega)^6 / 6 a step, its error term, which is 4e-5
 * there and would be 3e-3 at twice the step. From the second on the high order's steps may be
 * held by stability, and a step of the low order beyond the third shows that they were. */
#define SHORT 0.25
#define HELD  0.3
#define FAR   1.0

void cvode_order_begin(struct cvode_order *self) {
    *self = (struct cvode_order){.chosen = true, .patience = PATIENCE};
}

void cvode_order_forget(struct cvode_order *self) {
    self->high = false;
    self->row = 0;
}

bool cvode_order_watch(struct cvode_order *self, double h_omega) {
    const bool speaks = self->high ? h_omega > HELD : h_omega < SHORT;
    self->row = speaks ? self->row + 1 : 0;
    /* the low order is of use: what comes after it may be tried as soon as at first */
    if (!self->high && h_omega > FAR)
        self->patience = PATIENCE;
    if (self->row < (self->high ? self->patience : LONG))
        return false;
    /* doubled, so that steps lost to a vain change stay a small part of all */
    if (self->high && self->patience < UINT32_MAX / 2)
        self->patience *= 2;
    self->high = !self->high;
    self->row = 0;
    return true;
}
