/* Methods of orders 5 and 8 for smooth motion, as a module. */
#include "high_order_methods.h"

static const struct cs_integrator *const integrators[] = {&dop853, &dopri5,
                                                          &symmetric_multistep};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI,
    .size = sizeof(struct cs_integrator),
    .n = sizeof integrators / sizeof integrators[0],
    .integrators = integrators,
};
