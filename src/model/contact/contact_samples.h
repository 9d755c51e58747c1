/* contact_samples.h - contact sample points on edges and triangles, so that a collider narrower
 * than a cell cannot pass between particles.
 *
 * An edge of length s is divided into m equal parts, a triangle into m^2; the inner points of
 * the division feel the law of point_contact.h. m is the smallest number that leaves no gap.
 * Let points be at D/2 from a round collider of radius R, the middle of a part of length s/m
 * between them at the height a over its centre line: a^2 = (R + D/2)^2 - (s/m)^2/4. It stays
 * D/4 in front of the surface if a >= R + D/4, which is
 *
 *   (s/m)^2 <= 4 ((R + D/2)^2 - (R + D/4)^2) = D (2 R + 3/4 D)
 *
 * That holds across the rounded edge of a box too. m = 1 needs no samples; planes never do.
 *
 * A sample is p = sum w_i x_i with constant weights w. Its force f gives w_i f to each vertex,
 * and all derivatives are those of a particle at p, seen through the weights. Energy is
 * conserved, momentum and angular momentum are transferred in full, and nothing has a kink. */
#ifndef CS_CONTACT_SAMPLES_H
#define CS_CONTACT_SAMPLES_H

#include "model/contact/collider_params.h"
#include "model/contact/contact_set.h"
#include "model/system/surfaces.h"

/* Largest number of parts of an edge. Colliders that are finer still can pass, and
 * session/scene_findings.h warns of them. */
enum { CS_CONTACT_SAMPLE_PARTS_MAX = 16 };

/* Edges or triangles [begin, end) of a system against one collider; one thread at a time
 * evaluates it. */
struct cs_contact_sample_chunk {
    /* (items, vertices_per_item) of all items; borrowed from the surfaces */
    const uint32_t *vertices;
    uint32_t vertices_per_item; /* 2: edges; 3: triangles */
    uint32_t begin, end, collider;
    /* its vertices are among the particles first to last */
    uint32_t first, last;
    /* (end - begin) number m of parts per edge; 0: no sample */
    uint8_t *subdivisions;
    /* (n_near) items from `begin` on whose samples were near the collider where they were
     * listed */
    uint8_t *near;
    uint32_t n_near;
    /* (end - begin) number of each item's first sample among all */
    uint32_t *first_numbers;
};

/* All samples of a system; its arena owns them. */
struct cs_contact_samples {
    const struct cs_system *system; /* borrowed */
    /* (colliders) at the time of the last query */
    struct cs_posed_collider_law *colliders;
    /* where near items were listed: (3,n) m, and (colliders) with the reach of the list as
     * their range, 0 before the first */
    double *x_listed;
    struct cs_posed_collider_law *listed;
    struct cs_contact_sample_chunk
        *chunks; /* (n_chunks) those with points; by colliders, edges first */
    uint32_t n_chunks;
    /* number of samples */
    size_t n_points;
    /* contacts of the last force, Jacobian product, energy or bound */
    struct cs_contact_set current_set;
    /* contacts of the solver's matrix, until the next */
    struct cs_contact_set matrix;
    /* set whose diagonal blocks are wanted */
    const struct cs_contact_set *blocks;
};

/* Reach of a list of near items in ranges: until samples and collider have moved towards each
 * other by the rest, all samples in range are of these items. */
#define CS_CONTACT_SAMPLE_MARGIN 4

/* m, the most that a sample moves relative to a collider, of which the centre moves from c0 to
 * c1, and the particles from x0 to x1 (3,n). */
double cs_contact_samples_motion(size_t n, const double c0[3], const double *x0,
                                 const double c1[3], const double *x1);

/* Returns whether samples of an item may be within `reach` m of a collider, by its box, with
 * the particles at x (3,n). */
bool cs_contact_sample_item_is_near(const struct cs_contact_sample_chunk *chunk, uint32_t item,
                                    const struct cs_posed_collider *collider, double reach,
                                    size_t n, const double *x);

/* Longest part in m of an edge that a collider cannot pass, sqrt(D (2 R + 3/4 D)); HUGE_VAL for
 * planes and meshes, which need no samples. */
double cs_contact_sample_spacing(const struct cs_posed_collider *collider, double range);

/* Longest edge in m that samples must cover: at the start, times contact.sample_stretch; needs
 * no surfaces. */
double cs_contact_sample_longest(const struct cs_system *system);

/* A triangle between the samples of its edges, which are longer than what these cover. */
struct cs_outgrown_samples {
    double depth;      /* m in the collider; 0: none is */
    double stretch;    /* its edges' largest length over that at the start */
    uint32_t collider; /* its number */
};

/* Returns the deepest of these at (t, x) with the largest stretch of all. Triangles are taken
 * at points a quarter of the spacing of samples apart, colliders only if they need samples. */
struct cs_outgrown_samples cs_contact_samples_find_outgrown(const struct cs_system *system,
                                                            double t, const double *x);

/* Builds system->contact_samples, and the surfaces if they are missing; leaves it NULL if no
 * sample is needed. After cs_collider_params_table_build. CS_ERR_MEMORY. */
enum cs_status cs_contact_samples_build(struct cs_system *system, struct cs_error *error);

/* One sample of an edge or triangle, and the state of the iteration over them. */
struct cs_contact_sample_point {
    /* number of vertices and the vertices */
    uint32_t n, particles[3];
    /* weights, which sum to 1 */
    double w[3];
    /* w = (m - a - b, a, b) / m with m = subdivisions */
    uint32_t subdivisions, a, b;
    /* of the sample among all */
    uint32_t number;
};

/* Iterates over the samples of one item, without its vertices and, for a triangle, without its
 * edges: for (cs_contact_sample_first(chunk, item, &point); cs_contact_sample_next(&point);)
 * ... */
void cs_contact_sample_first(const struct cs_contact_sample_chunk *chunk, uint32_t item,
                             struct cs_contact_sample_point *point);
bool cs_contact_sample_next(struct cs_contact_sample_point *point);

/* Calls visit(arg, point) for each point at a collider that is no mesh: all particles, each a
 * sample of one vertex with the weight 1, then all samples. */
void cs_contact_points_visit(const struct cs_system *system, uint32_t collider,
                             void (*visit)(void *arg,
                                           const struct cs_contact_sample_point *point),
                             void *arg);

/* out = sum w_i x_i for x (3,n); 0 if x is NULL. Inlined: each particle is a sample of one. */
static inline void cs_contact_sample_interpolate(const struct cs_contact_sample_point *point,
                                                 size_t n, const double *x, double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = x ? 0 + point->w[0] * x[c * n + point->particles[0]] : 0;
    for (uint32_t k = 1; x && k < point->n; k++)
        for (size_t c = 0; c < 3; c++)
            out[c] += point->w[k] * x[c * n + point->particles[k]];
}

/* True if a vertex of a sample is on its way out of a collider: it then feels none. */
static inline bool cs_contact_sample_is_tangled(const struct cs_system *system,
                                                const struct cs_contact_sample_point *point) {
    bool tangled = false;
    for (uint32_t k = 0; system->tangled && k < point->n; k++)
        tangled = tangled || system->tangled[point->particles[k]];
    return tangled;
}

/* Effective mass in kg of a sample against a force: 1 / sum (w_i^2 / m_i); HUGE_VAL if all its
 * vertices are pinned, or one is tangled. */
double cs_contact_sample_mass(const struct cs_system *system,
                              const struct cs_contact_sample_point *point);

/* Positions and velocities of the points of all surfaces: the particles,
 * followed by the vertices of mesh colliders, which are not part of the state.
 *
 * Arrays of points are (3, n_points of surfaces.h), those of particles (3,n). Without mesh
 * colliders both are the same array, and nothing is copied. */

/* Builds system->surfaces, and system->points if a collider is a mesh, unless they exist.
 * CS_ERR_MEMORY. */
enum cs_status cs_surface_points_build(struct cs_system *system, struct cs_error *error);

/* Positions of all points at t, with the particles at x (3,n). Each end of a step has a buffer
 * of its own; the result is valid until the next call for the same end. */
enum cs_points_end { CS_POINTS_BEGIN, CS_POINTS_END };
const double *cs_surface_points_positions(const struct cs_system *system,
                                          enum cs_points_end end, double t, const double *x);

/* Velocities of all points at t, with those of particles in v (3,n), or 0 if v is NULL. Valid
 * until the next call; NULL if all are 0. */
const double *cs_surface_points_velocities(const struct cs_system *system, double t,
                                           const double *v);

/* 1/kg; 0: a pinned particle or a point of a collider. */
static inline double cs_surface_points_inverse_mass(const struct cs_system *system,
                                                    uint32_t point) {
    return point < system->view.n ? system->inv_mass[point] : 0;
}

#endif
