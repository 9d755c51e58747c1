/* horizon.h - measures how long a trajectory can be compared point by point.
 *
 * Two runs of one method start 1e-13 m apart in one particle. Their later distance shows how
 * the scene amplifies any error; it is a property of the scene, not of the method. The horizon
 * is the time at which the distance reaches the accuracy wanted: from there on pointwise errors
 * measure the amplification, not the method. */
#ifndef CS_HORIZON_H
#define CS_HORIZON_H

#include "study/recorded_run.h"

#define CS_HORIZON_START 1e-13 /* m */

/* Growth of a small displacement. */
struct cs_horizon {
    double growth;     /* RMS distance at the last frame / at the start */
    double separation; /* m, RMS at the last frame */
    double time; /* s of the first frame with an RMS distance of the accuracy; HUGE_VAL: none */
};

/* Measures with velocity-verlet at its own step, or with `fallback` ("NAME:options") if that
 * does not finish. If neither finishes, growth is NAN and time 0. accuracy in m.
 * CS_ERR_INTERRUPT, CS_ERR_MEMORY, CS_ERR_MODULE. */
enum cs_status cs_horizon_measure(struct cs_horizon *horizon,
                                  const struct cs_recorded_run_settings *settings,
                                  double accuracy, const char *fallback,
                                  struct cs_error *error);

#endif
