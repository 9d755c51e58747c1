/* conform_reference.h - the solution that orders and errors are measured against. */
#ifndef CS_CONFORM_REFERENCE_H
#define CS_CONFORM_REFERENCE_H

#include <clothsim/integrator.h>

/* The classical Runge-Kutta method of order 4 with option dt, for tiny steps. It is apart from
 * the modules, so that no module is measured against itself. */
extern const struct cs_integrator cs_conform_reference;

#endif
