/* visibility.h - visibility: the particles that are seen through a rectangle from a
 * viewpoint.
 *
 * A particle is visible if it lies in front of the eye, its perspective image lies in the
 * rectangle, and nothing lies on the straight line to it: no triangle of any body except
 * those it is a corner of, and no visible collider. (Flag thesis, ch. 5: the points that
 * OpenGL's selection finds; here by geometry in doubles, so that all machines see the same.) */
#ifndef CS_VISIBILITY_H
#define CS_VISIBILITY_H

#include "model/system/system.h"

/* A viewpoint in the form that tests need. */
struct cs_visibility_query {
    double eye[3];          /* m */
    double axes[3][3];      /* unit vectors: to the right, up, and in the direction of view */
    double low[2], high[2]; /* the rectangle as slopes: right / forward, up / forward */
};

/* Scratch arrays for n particles, owned by the caller's arena. */
struct cs_visibility_scratch {
    /* (3,n) m, positions relative to the eye, along its axes */
    double *projected;
    /* (n) cell of each candidate; (n) candidates by cell; (n + 1) position in `order` where the
     * candidates of each cell start */
    uint32_t *cells, *order, *cell_starts;
};

/* Prepares a viewpoint from an event of the scene that was checked: eye and target differ, up
 * is not along the view, the rectangle is not empty. */
void cs_visibility_query_make(struct cs_visibility_query *visibility,
                              const struct cs_viewpoint_force *viewpoint_force);

/* Takes the scratch arrays from an arena. CS_ERR_MEMORY. */
enum cs_status cs_visibility_scratch_init(struct cs_visibility_scratch *work, uint32_t n,
                                          struct cs_arena *arena, struct cs_error *error);

/* Sets seen (n): true for the particles of a body (-1: of all bodies) that are visible at
 * time t and positions x (3,n). The rectangle includes its sides. The line ends a billionth
 * of its length before the particle: a particle that touches a surface is not hidden by it.
 * Planes are infinite, and the space behind them is solid, as are the other colliders. A
 * particle with a position that is not finite is not visible. */
void cs_visibility_query_run(const struct cs_visibility_query *visibility,
                             const struct cs_system *system, double t, const double *x,
                             int64_t body, const struct cs_visibility_scratch *work,
                             bool *seen);

#endif
