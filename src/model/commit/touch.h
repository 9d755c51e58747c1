/* touch.h - what an obstacle does to one particle that a step has brought behind its surface.
 */
#ifndef CS_TOUCH_H
#define CS_TOUCH_H

#include "model/contact/obstacle.h"

enum cs_touch {
    CS_TOUCH_NONE, /* it is in front, or not finite, and nothing changes */
    CS_TOUCH_PUSHED,
    CS_TOUCH_STUCK /* it is at rest on an obstacle at rest: all of velocity and move were taken
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
enum cs_touch cs_touch_resolve(const struct cs_obstacle *obstacle, double dt,
                               const double last[3], double p[3], double v[3]);

#endif
