/* body_geometry.h - cloths and meshes as triangles for the camera and for the light. */
#ifndef CS_CPU_BODY_GEOMETRY_H
#define CS_CPU_BODY_GEOMETRY_H

#include "draw/cpu/shade.h"
#include "draw/mesh.h"
#include "draw/render.h"

/* One body of the scene; memory of the arena. */
struct cs_body_geometry {
    const struct cs_srgb *srgb; /* borrowed: set before init */
    struct cs_mesh mesh;
    struct cs_shading_material *material;
    float *uv;                            /* (n_vertices, 2); NULL without a texture */
    struct cs_clip_vertex *clip_vertices; /* (n_vertices) of the last projection */
    bool hidden;                          /* drawn as lines instead; it still casts shadow */
};

/* Allocates from the arena and fills the material `coat`. CS_ERR_MEMORY. */
enum cs_status cs_body_geometry_init(struct cs_body_geometry *body,
                                     const struct cs_canvas_settings *settings, uint32_t b,
                                     struct cs_shading_material *coat, struct cs_arena *arena,
                                     struct cs_error *error);

/* Takes positions and values of a frame of n particles. */
void cs_body_geometry_update(struct cs_body_geometry *body, uint32_t n,
                             const struct cs_frame *frame);

/* Projects the vertices and adds the triangles; kind says how many attributes are needed. */
void cs_body_geometry_add(struct cs_body_geometry *body, const struct cs_clip_transform *clip,
                          const struct cs_triangle_kind *kind, struct cs_triangles *triangles);

#endif
