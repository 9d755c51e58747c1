/* bodies.h - cloths and meshes as triangles of a picture and of the light's. */
#ifndef CS_DRAW_BODIES_H
#define CS_DRAW_BODIES_H

#include "draw/cpu/shade.h"
#include "draw/mesh.h"
#include "draw/render.h"

struct cs_body_picture {
    const struct cs_tone *tone; /* borrowed: set before init */
    struct cs_mesh mesh;
    struct cs_coat *coat;
    float *uv;                 /* (n_vertices, 2), or NULL */
    struct cs_corner *corners; /* (n_vertices) work */
    bool hidden;               /* something else is shown in its place; it still casts shadow */
};

/* Memory from the arena; coat is filled. texture of width 0: none. */
enum cs_status cs_body_picture_init(struct cs_body_picture *body,
                                    const struct cs_canvas_settings *settings, uint32_t b,
                                    struct cs_coat *coat, struct cs_arena *arena,
                                    struct cs_error *error);

/* Takes the frame's positions and values. */
void cs_body_picture_update(struct cs_body_picture *body, uint32_t n,
                            const struct cs_frame *frame);

/* Adds the triangles as a lens sees them; kind tells how many attributes are wanted. */
void cs_body_picture_add(struct cs_body_picture *body, const struct cs_lens *lens,
                         const struct cs_triangle_kind *kind, struct cs_triangles *triangles);

#endif
