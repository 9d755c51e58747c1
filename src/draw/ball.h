/* ball.h - a unit sphere of triangles, without sines. */
#ifndef CS_DRAW_BALL_H
#define CS_DRAW_BALL_H

#include "draw/mesh.h"

/* The icosahedron with each triangle cut in four, four times: 5120 triangles, three vertices
 * each, whose middles lie 0.06 % of the radius too low. The arena owns them. */
enum cs_status cs_ball_make(struct cs_vertex **vertices, uint32_t *n, struct cs_arena *arena,
                            struct cs_error *error);

#endif
