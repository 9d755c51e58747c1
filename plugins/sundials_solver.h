/* sundials_solver.h - the linear solver that the implicit methods on SUNDIALS embed. */
#ifndef SUNDIALS_SOLVER_H
#define SUNDIALS_SOLVER_H

#include "sundials.h"

/* Makes self->solver. CS_STEP_FAIL: out of memory, the host was told. */
enum cs_step sundials_solver_init(struct sundials *self);

#endif
