/* Own implicit methods on one Newton iteration (newton.h), as a module. */
#include "newton_methods.h"

static const struct cs_integrator *const integrators[] = {
    &backward_euler, &implicit_midpoint, &bdf2,  &tr_bdf2, &sdirk2,
    &ros2,           &newmark,           &gauss, &esdirk,  &energy_momentum,
};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
