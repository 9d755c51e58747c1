/* cvode_order_control.h - the highest order that BDF may take, chosen as a run goes.
 *
 * Orders above 2 are not stable near the imaginary axis: on weakly damped cloth they follow no
 * tolerance, and their steps h stay near h omega = 0.5, omega being the largest frequency,
 * where order 2 could go far beyond. Where the tolerance itself asks for steps below that they
 * are the better ones by far. So BDF begins with order 2 at most; it may take 5 after LONG
 * short steps in a row; and it begins anew, with 2, after many steps in a row that look as if
 * stability held them, each time after twice as many.
 */
#ifndef CS_CVODE_ORDER_CONTROL_H
#define CS_CVODE_ORDER_CONTROL_H

#include <stdbool.h>
#include <stdint.h>

enum { CVODE_ORDER_LOW = 2, CVODE_ORDER_HIGH = 5 };

struct cvode_order {
    bool is_automatic; /* here; else one order is asked for, and the rest of this is not used */
    double damping;    /* delta / omega of the scene */
    bool is_high;
    uint32_t row;           /* steps that speak for a change */
    uint32_t steps_to_wait; /* so many make one go back */
};

/* The order to begin with. damping: the ratio of the fastest motions. */
void cvode_order_begin(struct cvode_order *self, double damping);

/* The library's history is gone. */
void cvode_order_reset(struct cvode_order *self);

/* Looks at a step of h, h omega long; true: the order is to be changed, and is. */
bool cvode_order_update(struct cvode_order *self, double h_omega);

#endif
