/* ball.h - the side of a sphere that is seen from somewhere, as triangles, without sines. */
#ifndef CS_DRAW_BALL_H
#define CS_DRAW_BALL_H

#include "draw/mesh.h"

enum {
    CS_BALL_RINGS = 16,
    CS_BALL_SPOKES = 64,
    CS_BALL_OUTLINE = 256, /* corners of the outline: chords lie 0.008 % of the radius inside */
    // a fan in the middle, strips, and one between a ring and the finer outline
    CS_BALL_VERTICES = 3 * CS_BALL_SPOKES *
                       (1 + 2 * (CS_BALL_RINGS - 2) + CS_BALL_OUTLINE / CS_BALL_SPOKES + 1)
};

/* Fills the CS_BALL_VERTICES vertices of triangles, three each, counter-clockwise seen from
 * outside, that cover what is seen of a sphere (m) from eye: a place and 1, or the direction to
 * one far away and 0. From within the whole sphere is seen. */
void cs_ball_fill(const double centre[3], double radius, const float eye[4],
                  struct cs_vertex *out);

#endif
