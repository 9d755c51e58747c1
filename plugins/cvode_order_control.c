/* cvode_order_control.c - the switch between the highest orders 2 and 5 of BDF.
 *
 * The error term of order 5. Backward differences on y = e^(z t/h) give for k steps of equal
 * length
 *   sum over j = 1..k of (1/j) (1 - e^-z)^j = z - z^(k+1)/(k+1) + ...
 * The numerical motion for y' = i omega y thus has z = i a + (i a)^(k+1)/(k+1) + ..., a = h
 * omega. For k = 5 the amplitude changes by a^6/6 per step, 4e-5 at a = 0.25 and 3e-3 at 0.5.
 * With equal steps that is a loss up to a = 0.71, and growth only beyond. Order 4 grows by
 * a^6/3 for small a. CVODE's steps are not equal, and pass through order 4 on the way to 5:
 * an undamped spring doubled its energy in 21 s at a = 0.5. So a^6/6 is taken as the scale of
 * a growth that no tolerance sees.
 *
 * Damping with the ratio d = delta / omega takes d a per step. It is twice the error term
 * while a^6/3 < d a, which is a^5 < 3 d. */
#include "cvode_order_control.h"

/* Steps in a row: LONG allow order 5, PATIENCE return to order 2 the first time. */
enum { LONG = 20, PATIENCE = 100 };

/* All six values were found by trial. Theory gives the scale of SHORT and the rule a^5 < 3 d.
 * - SHORT, from the error term: below it order 5 may be tried without damping. It was 0.5
 *   until an undamped spring in a catalogue of extreme scenes doubled its energy.
 * - SHORT_DAMPED: the same while damping takes twice the error term. Stability holds order 5
 *   near 0.53, which limits it. Tuned on sheets of 8 x 8 and 16 x 16 and a drum, rtol 1e-3 to
 *   1e-6: up to 2.6 times fewer forces, at 0.1 to 0.5 of the error. Of 36 runs no other
 *   changed by more than 5 % in forces (docs/notes).
 * - BEYOND: hysteresis. Just above either limit, order 5 itself may be what keeps the steps
 *   short.
 * - FAR: a step of order 2 longer than that shows that it was. */
#define SHORT        0.25
#define SHORT_DAMPED 0.4
#define BEYOND       1.2
#define FAR          1.0

void cvode_order_begin(struct cvode_order *self, double damping) {
    *self = (struct cvode_order){
        .is_automatic = true, .steps_to_wait = PATIENCE, .damping = damping};
}

/* True if the tolerance asks for steps that order 5 can take: a < SHORT, or a^5 < 3 d below
 * SHORT_DAMPED. */
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
    /* order 2 takes longer steps than 5 could: the next try has the patience of the first */
    if (!self->is_high && h_omega > FAR)
        self->steps_to_wait = PATIENCE;
    if (self->row < (self->is_high ? self->steps_to_wait : LONG))
        return false;
    /* doubled: the steps lost to vain changes stay a small fraction of all */
    if (self->is_high && self->steps_to_wait < UINT32_MAX / 2)
        self->steps_to_wait *= 2;
    self->is_high = !self->is_high;
    self->row = 0;
    return true;
}
