/* surface.h - triangles on the graphics side, and the program that shades them. */
#ifndef CS_DRAW_SURFACE_H
#define CS_DRAW_SURFACE_H

#include "draw/mipmap.h"
#include "draw/surface_style.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* OpenGL buffers of one mesh. */
struct cs_surface {
    unsigned object, vertices;
    uint32_t n_drawn;
    bool has_indices;
};

/* Makes the buffers; n_indices 0: vertices are drawn in their order. Indices are copied. */
void cs_surface_init(struct cs_surface *surface, const uint32_t *indices, uint32_t n_indices);
/* Replaces the vertices by n others; without indices all of them are drawn. */
void cs_surface_upload(struct cs_surface *surface, const struct cs_vertex *vertices,
                       uint32_t n);
/* Uploads texture coordinates (n,2), once. */
void cs_surface_set_uv(struct cs_surface *surface, const float *uv, uint32_t n);
/* Makes a texture with trilinear filtering from all levels; returns its OpenGL name. */
unsigned cs_texture_make(const struct cs_mipmap *mips);
/* Draws with the program and its uniforms in use. */
void cs_surface_draw(const struct cs_surface *surface);

/* The shading program and the locations of its uniforms. */
struct cs_surface_program {
    unsigned name;
    int mode, front_location, back_location, coefficients, depth_bias_location, fade_location;
};

/* Builds the program. CS_ERR_MODULE with the compiler's log. */
enum cs_status cs_surface_program_init(struct cs_surface_program *program,
                                       struct cs_error *error);
/* Uses the program with the uniforms of a style. */
void cs_surface_program_use(const struct cs_surface_program *program,
                            const struct cs_surface_style *style);

#endif
