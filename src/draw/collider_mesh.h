/* collider_mesh.h - a collider as triangles, where it is. No OpenGL here. */
#ifndef CS_DRAW_COLLIDER_MESH_H
#define CS_DRAW_COLLIDER_MESH_H

#include "draw/mesh.h"
#include "model/contact/posed_collider.h"

/* Vertices of a collider's triangles, three each, none shared: two triangles of a plane or a
 * floor, those of a mesh, thousands of the others; 0 of one that is not visible. */
uint32_t cs_collider_mesh_count(const struct cs_posed_collider *collider);

/* Fills them in the world's coordinates, counter-clockwise seen from outside. A plane's square
 * lies a little below its place, or it would show through cloth of that cell (m) on it. Of a
 * sphere they cover what is seen from eye (sphere_cap.h). */
void cs_collider_mesh_fill(const struct cs_posed_collider *collider, double cell,
                           const float eye[4], struct cs_vertex *out);

#endif
