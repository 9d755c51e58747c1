/* body_geometry.h - cloths and meshes as triangles of a picture and of the light's. */
#ifndef CS_CPU_BODY_GEOMETRY_H
#define CS_CPU_BODY_GEOMETRY_H

#include "draw/cpu/shade.h"
#include "draw/mesh.h"
#include "draw/render.h"

struct cs_body_geometry {
    const struct cs_srgb *srgb; /* borrowed: set before init */
    struct cs_mesh mesh;
    struct cs_shading_material *material;
    float *uv;                            /* (n_vertices, 2), or NULL */
    struct cs_clip_vertex *clip_vertices; /* (n_vertices) work */
    bool hidden; /* something else is shown in its place; it still casts shadow */
};

/* Memory from the arena; coat is filled. texture of width 0: none. */
enum cs_status cs_body_geometry_init(struct cs_body_geometry *body,
                                     const struct cs_canvas_settings *settings, uint32_t b,
                                     struct cs_shading_material *coat, struct cs_arena *arena,
                                     struct cs_error *error);

/* Takes the frame's positions and values. */
void cs_body_geometry_update(struct cs_body_geometry *body, uint32_t n,
                             const struct cs_frame *frame);

/* Adds the triangles as a lens sees them; kind tells how many attributes are wanted. */
void cs_body_geometry_add(struct cs_body_geometry *body, const struct cs_clip_transform *clip,
                          const struct cs_triangle_kind *kind, struct cs_triangles *triangles);

#endif
