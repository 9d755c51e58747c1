/* collider_geometry.h - colliders, the ground and bodies as triangles. */
#ifndef CS_CPU_COLLIDER_GEOMETRY_H
#define CS_CPU_COLLIDER_GEOMETRY_H

#include "draw/collider_mesh.h"
#include "draw/cpu/shade.h"
#include "draw/mesh.h"
#include "draw/render.h"

/* Fills the materials of all colliders and the ground, and adds them as the camera sees them;
 * surface number = collider. */
void cs_collider_geometry_add(const struct cs_collider_geometry *geometries,
                              const struct cs_clip_transform *clip, const float eye[4],
                              struct cs_shading_material *materials,
                              struct cs_triangles *triangles);

/* Adds the casters, all visible colliders but planes, as the light sees them. light: a position
 * and 1, or a direction and 0. */
void cs_collider_geometry_add_shadow(const struct cs_collider_geometry *geometries,
                                     const struct cs_clip_transform *clip, const float light[4],
                                     struct cs_triangles *triangles);

/* Cloths and meshes as triangles for the camera and for the light. */

/* One body of the scene; memory of the arena. */
struct cs_body_geometry {
    const struct cs_srgb *srgb; /* borrowed: set before init */
    struct cs_mesh mesh;
    struct cs_shading_material *material;
    float *uv;                            /* (n_vertices, 2); NULL without a texture */
    struct cs_clip_vertex *clip_vertices; /* (n_vertices) of the last projection */
    bool hidden;                          /* drawn as lines instead; it still casts shadow */
    bool textured;
};

/* Allocates from the arena and fills *material. CS_ERR_MEMORY. */
enum cs_status cs_body_geometry_init(struct cs_body_geometry *body,
                                     const struct cs_canvas_settings *settings, uint32_t b,
                                     struct cs_shading_material *material,
                                     struct cs_arena *arena, struct cs_error *error);

/* Takes the colours of the material from the scene. */
void cs_body_geometry_restyle(struct cs_body_geometry *body, const struct cs_scene *scene,
                              uint32_t b);

/* Projects the vertices and adds the triangles; kind says how many attributes are needed. */
void cs_body_geometry_add(struct cs_body_geometry *body, const struct cs_clip_transform *clip,
                          const struct cs_triangle_kind *kind, struct cs_triangles *triangles);

#endif
