/* facets.h - which facets of a triangle a point feels, and how often each counts. */
#ifndef CS_PAIR_FACETS_H
#define CS_PAIR_FACETS_H

#include "model/pair/facet.h"
#include "model/system/surfaces.h"

/* How the triangles of all surfaces hang together. */
struct cs_facets {
    const struct cs_surfaces *surfaces; /* borrowed */
    uint32_t *across;  /* (n_triangles, 3) the corner beyond the rim opposite each corner;
                          CS_NO_POINT: it is the surface's border */
    double *share;     /* (n_points) of a corner in each of its triangles */
    uint32_t *started; /* (n_points + 1) the edges whose first end a point is */
};
#define CS_NO_POINT UINT32_MAX

/* Needs the surfaces; memory from the arena. CS_ERR_MEMORY. */
enum cs_status cs_facets_init(struct cs_facets *facets, const struct cs_surfaces *surfaces,
                              struct cs_arena *arena, struct cs_error *error);

/* A facet in range, as the first rim of its triangle. */
struct cs_facet_use {
    uint32_t at[4];
    double d;     /* m */
    double count; /* how often it counts: below 0 it is taken away */
    double alone; /* and where nothing may be taken away, so that a sum is not negative: of the
                     facet that is nearest alone. Over a flat mesh the same is left. */
    struct cs_facet_form form;
    uint32_t whole[2]; /* the ends of a rim, or a corner and CS_NO_POINT, that is the same seen
                          from all its triangles; twice that: it is not */
};

/* Three rims, three corners and the plane. */
enum { CS_FACETS = 7, CS_FACETS_PAIRS = 32 };

/* A point and a triangle. */
struct cs_facets_pair {
    uint32_t at[4], triangle; /* the point and the corners */
    bool own;                 /* the triangle is of the point's own body */
    double range;             /* m */
};

/* Fills uses (n CS_FACETS) with what the points of n <= CS_FACETS_PAIRS pairs feel of their
 * triangles at x (3, n_points), one pair after the other, and returns how many they are. What
 * is the same function of the state is one: rims and corners near the foot are the plane, and a
 * rim beyond its end is a corner. */
uint32_t cs_facets_find(const struct cs_facets *facets, const struct cs_facets_pair *pairs,
                        uint32_t n, const double *x, struct cs_facet_use *uses);

/* Adds to `n` uses of one point, without any that is there twice, `more` that stand behind
 * them, and returns how many that makes. */
uint32_t cs_facets_join(struct cs_facet_use *uses, uint32_t n, uint32_t more);

/* Whether anything is left of it: counts are whole shares of a triangle. */
static inline bool cs_facets_counts(const struct cs_facet_use *use) {
    return fabs(use->count) > 1e-9 || fabs(use->alone) > 1e-9;
}

#endif
