/* sphere_cap.h - the side of a sphere that is seen from somewhere, as triangles, without sines.
 */
#ifndef CS_DRAW_SPHERE_CAP_H
#define CS_DRAW_SPHERE_CAP_H

#include "draw/mesh.h"

enum {
    CS_SPHERE_CAP_STACKS = 16,
    CS_SPHERE_CAP_SECTORS = 64,
    CS_SPHERE_CAP_OUTLINE =
        256, /* corners of the outline: chords lie 0.008 % of the radius inside */
    // a fan in the middle, strips, and one between a ring and the finer outline
    CS_SPHERE_CAP_VERTICES =
        3 * CS_SPHERE_CAP_SECTORS *
        (1 + 2 * (CS_SPHERE_CAP_STACKS - 2) + CS_SPHERE_CAP_OUTLINE / CS_SPHERE_CAP_SECTORS + 1)
};

/* Fills the CS_SPHERE_CAP_VERTICES vertices of triangles, three each, counter-clockwise seen
 * from outside, that cover what is seen of a sphere (m) from eye: a place and 1, or the
 * direction to one far away and 0. From within the whole sphere is seen. */
void cs_sphere_cap_fill(const double centre[3], double radius, const float eye[4],
                        struct cs_vertex *out);

#endif
