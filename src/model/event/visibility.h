/* visibility.h - visibility: which particles are seen through a rectangle from a viewpoint.
 *
 * A particle is seen if it lies in front of the eye, its perspective image lies in the
 * rectangle, and nothing lies on the straight line to it: no triangle of any body but those it
 * is a corner of, and no visible collider. (Flag thesis, ch. 5: the points that OpenGL's
 * selection finds; here by geometry in doubles, so that all machines see the same.)
 */
#ifndef CS_VISIBILITY_H
#define CS_VISIBILITY_H

#include "model/system/system.h"

/* A viewpoint made ready. */
struct cs_visibility_query {
    double eye[3];          /* m */
    double axes[3][3];      /* unit vectors: to the right, up, and in the direction of view */
    double low[2], high[2]; /* the rectangle: right over forward, up over forward */
};

/* Work of n particles, the caller's. */
struct cs_visibility_scratch {
    double *projected;                     /* (3,n) m, positions along the axes from the eye */
    uint32_t *cells, *order, *cell_starts; /* (n), (n), (n + 1) */
};

/* From a checked event of the scene (no fault, no empty rectangle). */
void cs_visibility_query_make(struct cs_visibility_query *visibility,
                              const struct cs_viewpoint_force *viewpoint_force);

enum cs_status cs_visibility_scratch_init(struct cs_visibility_scratch *work, uint32_t n,
                                          struct cs_arena *arena, struct cs_error *error);

/* seen (n) = which particles of a body (-1: of all) are seen at time t and positions x (3,n).
 * Those exactly on a side of the rectangle are in it. The line ends a billionth of its length
 * before the particle, so that one that touches a surface is not hidden by it. Planes and
 * floors reach to infinity, and what is behind them is solid, as are the other colliders. A
 * position that is not finite is not seen. */
void cs_visibility_query_run(const struct cs_visibility_query *visibility,
                             const struct cs_system *system, double t, const double *x,
                             int64_t body, const struct cs_visibility_scratch *work,
                             bool *seen);

#endif
