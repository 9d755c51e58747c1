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

/* Bytes that it takes, for a plan. */
size_t cs_facets_bytes(const struct cs_scene *scene);

/* A facet in range, as the first rim of its triangle. */
struct cs_facet_use {
    uint32_t at[4];
    double p[4][3], d; /* m */
    double count;      /* how often it counts: below 0 it is taken away */
    double alone; /* and where nothing may be taken away, so that a sum is not negative: of the
                     facet that is nearest alone. Over a flat mesh the same is left. */
    struct cs_facet_form form;
};

/* Three rims, three corners and the plane. */
enum { CS_FACETS = 7 };

/* A point and a triangle. */
struct cs_facets_pair {
    uint32_t at[4], triangle; /* the point and the corners */
    bool own;                 /* the triangle is of the point's own body */
    double range;             /* m */
};

/* Fills uses with what the point feels at x (3, n_points), and returns how many they are. */
uint32_t cs_facets_find(const struct cs_facets *facets, const struct cs_facets_pair *pair,
                        const double *x, struct cs_facet_use uses[CS_FACETS]);

#endif
