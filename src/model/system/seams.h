/* seams.h - stitches between particles and points of bodies, as a part of the system. A seam to
 * a collider has none: its particles are held (cs_event_attach_seams in event/event_state.h).
 *
 * A stitch joins a particle p to a particle or a point of a triangle q: with weights 1 of p and
 * -w of the corners of q, d = sum weight x = x_p - x_q. It is a spring of rest length L with a
 * damper, a stiff spring and no constraint, so that it is in the equation of motion of every
 * method, at that method's order (force/term_seams.c). The same weights give the force on each
 * of its particles: momentum is conserved, and angular momentum by the spring.
 *
 * A stitch that is longer than its breaking length after an accepted step is broken from then
 * on. That is judged in commit; the broken ones are in checkpoints and in the hash of a state.
 */
#ifndef CS_SEAMS_H
#define CS_SEAMS_H

#include "model/system/particle_system.h"

struct cs_body;
struct cs_seam;
struct cs_seam_side;

struct cs_stitch {
    uint32_t at[4], n;                                  /* particles: p, then 1 or 3 of q */
    double weight[4];                                   /* 1 of p, those of q times -1 */
    double stiffness, damping, length, breaking_length; /* N/m, N s/m, m, m or NAN */
    uint32_t seam;                                      /* its number in the scene */
};

/* Part of a stitch at one of its particles. */
struct cs_stitch_end {
    uint32_t particle, stitch;
    double weight;
};

/* The system's arena owns all arrays. */
struct cs_seams {
    uint32_t n, n_ends, n_broken;
    struct cs_stitch *stitches; /* (n) in the order of the scene's seams */
    struct cs_stitch_end *ends; /* (n_ends) ascending by particle, then by stitch */
    bool *broken;               /* (n) */
    bool breaks;                /* some may break */
    double *forces;             /* (3 n) scratch: N, on p, of each stitch at work */
    bool is_kept;               /* the matrix that was prepared last has products */
    double
        *blocks; /* (12 n) of each stitch in the matrix kept last: by places, by velocities */
    /* (view.n) particle with which contact takes a particle for one: the first of those that
     * are stitched together, of a triangle the corner of largest weight */
    uint32_t *merged;
};

/* Lists the points that entries of a list choose, of one entry ascending, each once; returns
 * their number. body: that they are of, count points from `first` on, at x (3,n) at the start.
 * marks (n) are false and free for use. out NULL: counts. */
struct cs_seam_points {
    const struct cs_body *body;
    const double *x;
    uint32_t n, first, count;
};
uint32_t cs_seam_points_list(const struct cs_seam_points *points,
                             const struct cs_list *particles, bool *marks, uint32_t *out);

/* The points of a side that is a body. */
struct cs_seam_points cs_seam_points_of(const struct cs_system *system,
                                        const struct cs_seam_side *side);

/* Fails unless the sides have the same number of points, or the other one three with weights.
 */
enum cs_status cs_seam_check_counts(uint32_t number, const struct cs_seam *seam,
                                    const uint32_t n[2], struct cs_error *error);

/* Builds system->seams from the scene's seams, at the start positions. Fails with CS_ERR_SCENE
 * if sides have different numbers of particles or a particle is sewn to itself. */
enum cs_status cs_seams_build(struct cs_system *system, struct cs_error *error);

/* x_p - x_q in m of a stitch, or of other (3,n) vectors. */
static inline void cs_stitch_difference(const struct cs_stitch *stitch, size_t n,
                                        const double *x, double d[3]) {
    for (size_t c = 0; c < 3; c++) {
        d[c] = x[c * n + stitch->at[0]];
        for (uint32_t k = 1; k < stitch->n; k++)
            d[c] += stitch->weight[k] * x[c * n + stitch->at[k]];
    }
}

/* Breaks the stitches that are too long at x (3,n), after an accepted step. Returns true if one
 * did. Nothing without seams. */
bool cs_seams_break(const struct cs_system *system, const double *x);

/* Breaks the stitches of a seam of the scene that are whole. */
void cs_seams_open(const struct cs_system *system, uint32_t seam);

/* The particle that stands for a point in tests for common points: sewn particles are one. */
static inline uint32_t cs_seams_merged(const struct cs_system *system, uint32_t point) {
    return system->seams && point < system->view.n ? system->seams->merged[point] : point;
}

/* Returns whether one of n points of a pair is tangled and another one is a collider's. */
static inline bool cs_seams_tangled(const struct cs_system *system, const uint32_t *points,
                                    uint32_t n) {
    bool tangled = false, collider = false;
    for (uint32_t k = 0; system->tangled && k < n; k++) {
        tangled = tangled || cs_system_is_tangled(system, points[k]);
        collider = collider || points[k] >= system->view.n;
    }
    return tangled && collider;
}

/* Returns whether a point and a triangle, or two edges, have a point in common, or two that are
 * sewn together, or one that is tangled. Such pairs have no contact. at: points, then corners;
 * or ends of both edges. */
static inline bool cs_seams_join_pair(const struct cs_system *system, const uint32_t points[4],
                                      bool edges) {
    const uint32_t *at = points;
    uint32_t merged[4];
    if (system->seams) {
        for (int k = 0; k < 4; k++)
            merged[k] = cs_seams_merged(system, points[k]);
        at = merged;
    }
    return at[0] == at[2] || at[0] == at[3] ||
           (edges ? at[1] == at[2] || at[1] == at[3] : at[0] == at[1]) ||
           cs_seams_tangled(system, points, 4);
}

#endif
