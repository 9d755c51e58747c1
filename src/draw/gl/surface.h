/* surface.h - triangles on the graphics side, and the program that shades them. */
#ifndef CS_DRAW_SURFACE_H
#define CS_DRAW_SURFACE_H

#include "draw/mipmap.h"
#include "draw/surface_style.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Buffers of one mesh. */
struct cs_surface {
    unsigned object, vertices;
    uint32_t n_drawn;
    bool has_indices;
};

void cs_surface_init(struct cs_surface *surface, const uint32_t *indices, uint32_t n_indices);
/* Replaces the vertices; n_drawn of them without indices. */
void cs_surface_upload(struct cs_surface *surface, const struct cs_vertex *vertices,
                       uint32_t n);
/* Gives texture coordinates (n,2) once. */
void cs_surface_set_uv(struct cs_surface *surface, const float *uv, uint32_t n);
/* Returns the name of a texture with trilinear filtering. */
unsigned cs_texture_make(const struct cs_mipmap *mips);
/* Draws with the program in use. */
void cs_surface_draw(const struct cs_surface *surface);

struct cs_surface_program {
    unsigned name;
    int mode, front_location, back_location, coefficients, depth_bias_location, fade_location;
};

enum cs_status cs_surface_program_init(struct cs_surface_program *program,
                                       struct cs_error *error);
void cs_surface_program_use(const struct cs_surface_program *program,
                            const struct cs_surface_style *style);

#endif
