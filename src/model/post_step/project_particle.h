/* project_particle.h - what an obstacle does to one particle that a step has brought behind its
 * surface.
 */
#ifndef CS_PROJECT_PARTICLE_H
#define CS_PROJECT_PARTICLE_H

#include "model/contact/posed_collider.h"

enum cs_project_result {
    CS_PROJECT_NONE, /* it is in front, or not finite, and nothing changes */
    CS_PROJECT_PUSHED,
    CS_PROJECT_STUCK /* it is at rest on an obstacle at rest: all of velocity and move were
                      * taken
                      */
};

/* Moves a particle that is behind the surface, moved out by the obstacle's thickness, at p with
 * velocity v, after a step of dt that began at `last`; against an obstacle that moves, all by
 * what they are in its frame. Position and velocity are corrected alike:
 *   - p goes out along the normal n by its depth (cloth thesis, eq. 5.27-5.31), and where v
 *     points inwards, v -= ka (v.n) n with the absorption ka (eq. 5.32 as meant; a negative ka
 *     turns the normal velocity round and multiplies it by |ka|);
 *   - Coulomb: the tangential velocity loses at most `friction` times the normal velocity that
 *     was changed, and the tangential move since `last` at most `friction` times the depth
 *     (Macklin et al. 2014), so that what friction holds stays where it is. */
enum cs_project_result cs_project_particle(const struct cs_posed_collider *collider, double dt,
                                           const double last[3], double p[3], double v[3]);

#endif
