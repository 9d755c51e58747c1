/* sphere_cap.h - the visible side of a sphere as triangles, computed without sines.
 */
#ifndef CS_DRAW_SPHERE_CAP_H
#define CS_DRAW_SPHERE_CAP_H

#include "draw/mesh.h"

enum {
    CS_SPHERE_CAP_STACKS = 16,  /* rings from the middle to the outline */
    CS_SPHERE_CAP_SECTORS = 64, /* corners of the inner rings */
    CS_SPHERE_CAP_OUTLINE =
        256, /* corners of the outline: chords lie 0.008 % of the radius inside */
    // a fan in the middle, strips, and one between a ring and the finer outline
    CS_SPHERE_CAP_VERTICES =
        3 * CS_SPHERE_CAP_SECTORS *
        (1 + 2 * (CS_SPHERE_CAP_STACKS - 2) + CS_SPHERE_CAP_OUTLINE / CS_SPHERE_CAP_SECTORS + 1)
};

/* Fills CS_SPHERE_CAP_VERTICES vertices, three per triangle, counter-clockwise seen from
 * outside. They cover the part of a sphere (m) that is visible from eye: a position and 1, or
 * the direction to an eye far away and 0. An eye inside gets the whole sphere. */
void cs_sphere_cap_fill(const double centre[3], double radius, const float eye[4],
                        struct cs_vertex *out);

#endif
