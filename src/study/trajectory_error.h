/* trajectory_error.h - measures the distance of one recorded run from another.
 *
 * Pointwise figures (end, path, velocity) compare each particle with itself. Beyond the horizon
 * of predictability (reference/horizon.h) they saturate; statistical figures (energy, centre of
 * mass, box) remain meaningful there. */
#ifndef CS_TRAJECTORY_ERROR_H
#define CS_TRAJECTORY_ERROR_H

#include "session/recorded_run.h"

/* Distances of a run from the reference. */
struct cs_trajectory_error {
    double end, end_max;   /* m: mass-weighted RMS and largest distance at the last frame */
    double path, path_max; /* m over all frames */
    double velocity;       /* m/s at the last frame, mass-weighted RMS */
    double energy;         /* J, largest over frames */
    double centre, box;    /* m, largest over frames */
    double strain;         /* of the run itself, largest over frames */
};

/* Compares the frames 1..`frames`, which both runs must have. Pointwise figures use the frames
 * up to pointwise_frames only; they are NAN if these are fewer than `frames`. */
void cs_trajectory_error_compute(struct cs_trajectory_error *error,
                                 const struct cs_system *system,
                                 const struct cs_trajectory *trajectory,
                                 const struct cs_trajectory *reference, uint32_t frames,
                                 uint32_t pointwise_frames);

/* Root mean square of a - b over n >= 1 values. */
double cs_rms_difference(const double *a, const double *b, size_t n);

/* sqrt(sum m |a - b|^2 / sum m) of two (3,n) at a frame of a run, over the particles that can
 * move there or could before: those that an event releases from then on. 0 without any. The
 * mass as weight makes it independent of the resolution of a mesh. */
double cs_distance_rms(const struct cs_system *system, const struct cs_trajectory *run,
                       uint32_t frame, const double *a, const double *b);
/* Largest distance of a particle, pinned ones included. */
double cs_distance_max(const struct cs_system *system, const double *a, const double *b);
/* The distance of each particle, (n). */
void cs_distance_each(uint32_t n, const double *a, const double *b, double *out);

#endif
