/* collider_geometry.h - colliders and the ground's rectangle as triangles. */
#ifndef CS_CPU_COLLIDER_GEOMETRY_H
#define CS_CPU_COLLIDER_GEOMETRY_H

#include "draw/collider_mesh.h"
#include "draw/cpu/shade.h"
#include "draw/ground.h"

/* Fills the materials of all colliders, and adds the squares of planes, then all others, as the
 * camera sees them; surface number = collider. *n_squares: triangles of squares. */
void cs_collider_geometry_add(const struct cs_collider_geometry *solids,
                              const struct cs_clip_transform *clip, const float eye[4],
                              struct cs_shading_material *coats, struct cs_triangles *triangles,
                              size_t *n_squares);

/* Adds the casters, all visible colliders but planes, as the light sees them. light: a position
 * and 1, or a direction and 0. */
void cs_collider_geometry_add_shadow(const struct cs_collider_geometry *solids,
                                     const struct cs_clip_transform *clip, const float light[4],
                                     struct cs_triangles *triangles);

/* Adds the ground's rectangle of this frame, if it is not empty. */
void cs_ground_add(const struct cs_ground *ground, const struct cs_clip_transform *clip,
                   struct cs_triangles *triangles);

#endif
