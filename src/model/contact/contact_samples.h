/* contact_samples.h - points on edges and in triangles that feel colliders as particles do,
 * where an obstacle could come in between particles.
 *
 * An edge of length s is cut into m equal parts, a triangle into m^2, whose corners feel the
 * law of touch.h. m is the least for which what lies between stays covered: with points at half
 * the range D from an obstacle whose core has a radius R about it, a part of s/m across its
 * round side is nowhere nearer than D/4, if (s/m)^2 <= D (2R + 3/4 D). That holds across the
 * rounded edge of a box too. Where m is 1 there are no such points, and on planes there never
 * are.
 *
 * A point is p = sum w_i x_i with weights w that do not change: its force f gives w_i f to each
 * corner, and all derivatives are those of a particle at p, seen through the weights. Energy is
 * kept, momentum and its moment go over in full, and there is no kink anywhere.
 */
#ifndef CS_CONTACT_SAMPLES_H
#define CS_CONTACT_SAMPLES_H

#include "model/contact/collider_query.h"
#include "model/contact/contact_set.h"
#include "model/system/surfaces.h"

/* Parts of an edge at most: what is finer still can come in, and is told of
 * (study/sampling_warning.h).
 */
enum { CS_CONTACT_SAMPLE_PARTS_MAX = 16 };

/* Edges, or triangles, [begin, end) of a system against one collider: one thread's. */
struct cs_contact_sample_chunk {
    const uint32_t *vertices;   /* (n, each) of all; borrowed from the surfaces */
    uint32_t vertices_per_item; /* 2: edges; 3: triangles */
    uint32_t begin, end, collider;
    uint32_t first, last;  /* the corners are particles [first, last] */
    uint8_t *subdivisions; /* (end - begin) of each; 0: no point in it */
};

struct cs_contact_samples {
    const struct cs_system *system;          /* borrowed */
    struct cs_posed_collider_law *colliders; /* (colliders) at the time of the last question */
    struct cs_contact_sample_chunk
        *chunks; /* (n_chunks) those with points; by colliders, edges first */
    uint32_t n_chunks;
    size_t n_points;                     /* of all chunks */
    struct cs_contact_set current_set;   /* of the last force, product, energy or bound */
    struct cs_contact_set matrix;        /* of the solver's matrix, until the next */
    const struct cs_contact_set *blocks; /* whose diagonal blocks are asked for */
};

/* The longest part in m of an edge that an obstacle of that radius does not come in by;
 * HUGE_VAL: any, of a plane or a mesh. */
double cs_contact_sample_spacing(const struct cs_posed_collider *obstacle, double range);

/* The longest edge in m of a system where it starts; it needs no surfaces. */
double cs_contact_sample_longest(const struct cs_system *system);

/* Makes system->covers, and the surfaces if they are not there; NULL where no point is needed.
 * After the pairings. CS_ERR_MEMORY. */
enum cs_status cs_contact_samples_build(struct cs_system *system, struct cs_error *error);

/* One point of an edge or triangle. */
struct cs_contact_sample_point {
    uint32_t n, particles[3]; /* corners */
    double w[3];
    uint32_t subdivisions, a, b; /* w = (parts - a - b, a, b) / parts */
};

/* All points of one item, without its corners and, of a triangle, its edges:
 * for (cs_contact_sample_first(chunk, item, &point); cs_contact_sample_next(&point);) ... */
void cs_contact_sample_first(const struct cs_contact_sample_chunk *chunk, uint32_t item,
                             struct cs_contact_sample_point *point);
bool cs_contact_sample_next(struct cs_contact_sample_point *point);

/* out = sum w_i x_i of (3,n); 0 where x is NULL. */
void cs_contact_sample_interpolate(const struct cs_contact_sample_point *point, size_t n,
                                   const double *x, double out[3]);

/* Mass in kg of a point as what pushes it feels it: 1 / sum (w_i^2 / m_i); HUGE_VAL: held. */
double cs_contact_sample_mass(const struct cs_system *system,
                              const struct cs_contact_sample_point *point);

/* As cs_collider_contact_resolves_step (contact/step_check.h), for the points. With all
 * threads. */
bool cs_contact_samples_resolve_step(const struct cs_contact_samples *samples, double t0,
                                     const double *x0, double t1, const double *x1);

#endif
