/* triangle.h - triangles made ready to be filled, in the order in which they are drawn. */
#ifndef CS_DRAW_TRIANGLE_H
#define CS_DRAW_TRIANGLE_H

#include "base/status.h"
#include "draw/cpu/clip_project.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A quantity that is linear over the picture: slopes a pixel, and its value at the middle of
 * the box's first pixel; of depth, of the picture's lowest left one, with y up. */
struct cs_plane_equation {
    float value, d_dx, d_dy;
};

struct cs_triangle {
    int32_t x[3], y[3]; /* corners in 1/256 pixel, y down, turned clockwise as seen */
    int32_t left, right, top, bottom; /* pixels that it may touch, inside the picture */
    int32_t bottom_row;               /* of the picture: its height less 1 */
    struct cs_plane_equation depth;   /* of the window, perhaps sunk */
    float depth_min, depth_max;       /* nearness of the corners */
    struct cs_plane_equation inverse; /* 1/w */
    struct cs_plane_equation attributes[CS_ATTRIBUTES]; /* over w */
    uint16_t surface;
    bool is_back_facing; /* seen from behind: normals are turned */
    bool fits_32_bits;   /* edges fit into 32 bits */
};

/* Grows as needed; zeroed: empty. */
struct cs_triangles {
    struct cs_triangle *items; /* owned */
    size_t n, capacity;
    bool failed; /* out of memory: some are missing */
};

/* How triangles are added: what they belong to, and what of them is wanted. */
struct cs_triangle_kind {
    uint16_t surface;
    uint8_t attributes; /* how many are wanted */
    bool front_only;    /* leave out those seen from behind */
};

/* Adds what is seen of a triangle, front counter-clockwise. Corners on the same pixels give no
 * triangle: two neighbours neither leave a gap nor share a sample. */
void cs_triangles_add(struct cs_triangles *triangles, const struct cs_clip_transform *clip,
                      const struct cs_clip_vertex *const corners[3],
                      const struct cs_triangle_kind *kind);

/* The plane of depth of three corners, with the roundings of Mesa's software renderer: from the
 * first one on in single precision. There that is the second corner of a front, the first of a
 * back. */
struct cs_plane_equation cs_depth_of(const struct cs_clip_vertex *a,
                                     const struct cs_clip_vertex *b,
                                     const struct cs_clip_vertex *c);

void cs_triangles_finish(struct cs_triangles *triangles);

#endif
