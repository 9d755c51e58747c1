/* touch.h - what an obstacle does to one particle that a step has brought behind its surface.
 */
#ifndef CS_TOUCH_H
#define CS_TOUCH_H

#include "model/contact/obstacle.h"

struct cs_touch {
    double depth; /* m, how far it was behind the surface and its thickness */
    double fresh; /* m of it that the last step has added */
};

/* Moves a particle that is behind the surface, moved out by the obstacle's thickness, at p with
 * velocity v, after a step of dt that began at `last`; against an obstacle that moves, all by
 * what they are in its frame. Position and velocity are corrected alike:
 *   - p goes out along the normal n by its depth (cloth thesis, eq. 5.27-5.31), and where v
 *     points inwards, v -= ka (v.n) n with the absorption ka (eq. 5.32 as meant; a negative ka
 *     turns the normal velocity round and multiplies it by |ka|);
 *   - Coulomb: the tangential velocity loses at most `friction` times the normal velocity that
 *     was changed, and the tangential move since `last` at most `friction` times the depth
 *     (Macklin et al. 2014), so that what friction holds stays where it is.
 * false: it is in front, or not finite, and nothing changes. */
bool cs_touch_resolve(const struct cs_obstacle *obstacle, double dt, const double last[3],
                      double p[3], double v[3], struct cs_touch *touch);

#endif
