/* conform_reference.h - the method whose solution orders and errors are measured against. */
#ifndef CS_CONFORM_REFERENCE_H
#define CS_CONFORM_REFERENCE_H

#include <clothsim/integrator.h>

/* The classical Runge-Kutta method of order 4 with option dt, for tiny steps. Independent of
 * the modules, so no module is compared with itself. */
extern const struct cs_integrator cs_conform_reference;

#endif
