/* Which order BDF may take; see cvode_order_control.h. */
#include "cvode_order_control.h"

/* steps in a row that make one try the high order, and go back the first time */
enum { LONG = 20, PATIENCE = 100 };

/* Below SHORT the tolerance asks for steps that the high order can take as well: without
 * damping order 5 makes a motion grow by (h omega)^6 / 6 a step, its error term, which is 4e-5
 * there. Damping takes (delta / omega) h omega away, and while that is the double of what grows
 * steps may be longer, up to SHORT_DAMPED; stability holds order 5 at 0.53. A little beyond
 * either the high order's steps may be held by it, and a step of the low order beyond FAR shows
 * that they were. */
#define SHORT        0.25
#define SHORT_DAMPED 0.4
#define BEYOND       1.2
#define FAR          1.0

void cvode_order_begin(struct cvode_order *self, double damping) {
    *self = (struct cvode_order){
        .is_automatic = true, .steps_to_wait = PATIENCE, .damping = damping};
}

static bool is_short(const struct cvode_order *self, double h_omega) {
    const double square = h_omega * h_omega;
    return h_omega < SHORT ||
           (h_omega < SHORT_DAMPED && square * square * h_omega < 3 * self->damping);
}

void cvode_order_reset(struct cvode_order *self) {
    self->is_high = false;
    self->row = 0;
}

bool cvode_order_update(struct cvode_order *self, double h_omega) {
    const bool speaks =
        self->is_high ? !is_short(self, h_omega / BEYOND) : is_short(self, h_omega);
    self->row = speaks ? self->row + 1 : 0;
    /* the low order is of use: what comes after it may be tried as soon as at first */
    if (!self->is_high && h_omega > FAR)
        self->steps_to_wait = PATIENCE;
    if (self->row < (self->is_high ? self->steps_to_wait : LONG))
        return false;
    /* doubled, so that steps lost to a vain change stay a small part of all */
    if (self->is_high && self->steps_to_wait < UINT32_MAX / 2)
        self->steps_to_wait *= 2;
    self->is_high = !self->is_high;
    self->row = 0;
    return true;
}
