/* arkode_calls.h - one spelling of ARKODE's calls: ARKStepX, and ARKodeX since SUNDIALS 7.1. */
#ifndef ARKODE_CALLS_H
#define ARKODE_CALLS_H

#include <arkode/arkode_arkstep.h>
#include <sundials/sundials_version.h>

#if SUNDIALS_VERSION_MAJOR * 100 + SUNDIALS_VERSION_MINOR >= 701
#define ARK(call) ARKode##call
#else
#define ARK(call) ARKStep##call
#endif

#endif
