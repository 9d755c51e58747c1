/* trajectory_error.h - how far one recorded run is from another. */
#ifndef CS_TRAJECTORY_ERROR_H
#define CS_TRAJECTORY_ERROR_H

#include "study/recorded_run.h"

struct cs_trajectory_error {
    double end, end_max;   /* m: mass-weighted RMS and largest distance at the last frame */
    double path, path_max; /* m over all frames */
    double velocity;       /* m/s at the last frame, mass-weighted RMS */
    double energy;         /* J, largest over frames */
    double centre, box;    /* m, largest over frames */
    double strain;         /* of the run itself, largest over frames */
};

/* Frames up to `frames` are compared, both runs must have them; pointwise: up to
 * `pointwise_frames` only, what ends there is NAN if that is less than `frames`. */
void cs_trajectory_error_compute(struct cs_trajectory_error *deviation,
                                 const struct cs_system *system,
                                 const struct cs_trajectory *track,
                                 const struct cs_trajectory *reference, uint32_t frames,
                                 uint32_t pointwise_frames);

/* Root of the mean square of a - b over n values. */
double cs_rms_difference(const double *a, const double *b, size_t n);

/* sqrt(sum m |a - b|^2 / sum m) of two (3,n), over the particles that can move. */
double cs_distance_rms(const struct cs_system *system, const double *a, const double *b);
double cs_distance_max(const struct cs_system *system, const double *a, const double *b);
/* The distance of each particle, (n). */
void cs_distance_each(uint32_t n, const double *a, const double *b, double *out);

#endif
