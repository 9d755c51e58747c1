/* horizon.h - how long a trajectory can be compared point by point.
 *
 * Two runs of one method start 1e-13 m apart in one particle. How far they are apart later is
 * what the scene makes of any error, whatever the method: a property of the cloth.
 */
#ifndef CS_HORIZON_H
#define CS_HORIZON_H

#include "study/recorded_run.h"

#define CS_HORIZON_START 1e-13 /* m */

struct cs_horizon {
    double growth;     /* RMS distance at the last frame / at the start */
    double separation; /* m, RMS at the last frame */
    double time; /* s of the first frame with an RMS distance of the accuracy; HUGE_VAL: none */
};

/* Measures with velocity-verlet at its own step, else with `fallback` ("NAME:options"). Where
 * neither gets through, the amplification is NAN and the time 0. accuracy in m.
 * CS_ERR_INTERRUPT, CS_ERR_MEMORY, CS_ERR_MODULE. */
enum cs_status cs_horizon_measure(struct cs_horizon *horizon,
                                  const struct cs_recorded_run_settings *settings,
                                  double accuracy, const char *fallback,
                                  struct cs_error *error);

#endif
