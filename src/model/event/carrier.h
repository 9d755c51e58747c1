/* carrier.h - a triangle of a mesh with key frames that carries particles.
 *
 * A point of it is p = p0 + a e + b f + h n with the edges e = p1 - p0 and f = p2 - p0 and the
 * unit normal n; (a, b, h) stay the same while the triangle moves and deforms. */
#ifndef CS_CARRIER_H
#define CS_CARRIER_H

#include "model/contact/posed_collider.h"

/* p0, e, f and n in m, and their rates in m/s. */
struct cs_carrier {
    double place[4][3], rate[4][3];
};

/* The triangle of a surface at its pose. */
void cs_carrier_at(const struct cs_posed_collider *collider, uint32_t triangle,
                   struct cs_carrier *out);

/* (a, b, h) of p. Returns the squared distance in m2 of p from its point at a and b limited to
 * the triangle, which is exact over its inside; HUGE_VAL of a triangle without area. */
double cs_carrier_find(const struct cs_carrier *at, const double p[3], double own[3]);

/* Sets targets (3, particles), in m at time 0, of the particles of a seam to its collider, and
 * their entries of events->seam_of. CS_ERR_SCENE if one is held or numbers differ. */
enum cs_status cs_carrier_sew(struct cs_system *system, uint32_t seam, double *targets,
                              struct cs_error *error);

#endif
