/* cvode_order_control.h - chooses the highest order that BDF may take, while a run goes.
 *
 * Orders above 2 are not stable near the imaginary axis. On weakly damped cloth they follow
 * no tolerance: their steps h stay near h omega = 0.5, omega the largest frequency, where
 * order 2 could take far longer ones. If the tolerance itself asks for shorter steps, they
 * are by far the better ones.
 *
 * BDF therefore starts with order 2 at most. It may take order 5 after LONG short steps in a
 * row. It returns to order 2 after many steps in a row that look as if stability limits them,
 * and each time waits for twice as many. */
#ifndef CS_CVODE_ORDER_CONTROL_H
#define CS_CVODE_ORDER_CONTROL_H

#include <stdbool.h>
#include <stdint.h>

/* The two highest orders to choose from: order 2 is A-stable, 5 is CVODE's maximum for BDF. */
enum { CVODE_ORDER_LOW = 2, CVODE_ORDER_HIGH = 5 };

/* The state of the choice. Zeroed: not automatic. */
struct cvode_order {
    bool is_automatic; /* chosen here; false: the user gave an order, the rest is not used */
    double damping;    /* delta / omega of the scene: the damping ratio */
    bool is_high;      /* order 5 is allowed now */
    uint32_t row;      /* steps in a row that call for a change */
    uint32_t steps_to_wait; /* steps in a row that return to order 2 */
};

/* Starts the automatic choice with order 2. damping: delta / omega of the fastest motions. */
void cvode_order_begin(struct cvode_order *self, double damping);

/* The library lost its history and starts with order 1: back to at most 2. The patience
 * stays. */
void cvode_order_reset(struct cvode_order *self);

/* Judges a step of h omega radians of the fastest motion. Returns true if the highest order
 * changes now; is_high then is the new one. */
bool cvode_order_update(struct cvode_order *self, double h_omega);

#endif
