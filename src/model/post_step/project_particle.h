/* project_particle.h - projection of one particle that a step has brought behind the surface of
 * a collider: push, absorption and friction. */
#ifndef CS_PROJECT_PARTICLE_H
#define CS_PROJECT_PARTICLE_H

#include "model/contact/posed_collider.h"

/* Effect of one collider on a particle. */
enum cs_project_result {
    /* nothing: it is in front, or not finite */
    CS_PROJECT_NONE,
    CS_PROJECT_PUSHED,
    /* it is at rest on a collider at rest: velocity and displacement were taken completely */
    CS_PROJECT_STUCK
};

/* Moves a particle at p with velocity v onto the surface, offset by the collider's thickness,
 * after a step of dt that began at `last`. Against a moving collider all is relative to the
 * motion of its matter. With the outward normal n and the gap d < 0:
 *
 *   p -= d n                                             (cloth thesis, eq. 5.27 to 5.31)
 *   v -= ka (v.n) n  if v.n < 0, ka the absorption       (eq. 5.32 as meant)
 *   |T_v| -= at most mu times the change along n         (Coulomb)
 *   |T_x| -= at most mu min(ka, 1) |d|                   (Macklin et al. 2014)
 *
 * with T_v, T_x the tangential parts of v and of the displacement since `last`. A negative
 * absorption reflects the normal velocity, times |ka|. Position and velocity are corrected
 * alike, so that a particle that friction holds stays in its place. */
enum cs_project_result cs_project_particle(const struct cs_posed_collider *collider, double dt,
                                           const double last[3], double p[3], double v[3]);

#endif
