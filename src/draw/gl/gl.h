/* gl.h - the OpenGL 3.3 calls that drawing needs, loaded by name from whatever context there
 * is. */
#ifndef CS_DRAW_GL_H
#define CS_DRAW_GL_H

#include "base/arena.h"
#include "base/status.h"
#include "draw/glyph.h"
#include "draw/ground.h"
#include "draw/look.h"
#include "draw/mesh.h"
#include "draw/mipmap.h"
#include "draw/srgb.h"
#include "scene/picture_keys.h"

#include <GL/glcorearb.h>

/* clang-format off */
#define CS_GL_CALLS(X)                                                                             \
    X(ACTIVETEXTURE, ActiveTexture) X(ATTACHSHADER, AttachShader) X(BINDBUFFER, BindBuffer)        \
    X(BINDBUFFERBASE, BindBufferBase) X(BINDFRAMEBUFFER, BindFramebuffer)                          \
    X(BINDRENDERBUFFER, BindRenderbuffer) X(BINDTEXTURE, BindTexture)                              \
    X(BINDVERTEXARRAY, BindVertexArray) X(BLENDFUNCSEPARATE, BlendFuncSeparate)                                 \
    X(BUFFERDATA, BufferData)                                                                     \
    X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) X(CLEAR, Clear)                              \
    X(COMPILESHADER, CompileShader) X(CREATEPROGRAM, CreateProgram) X(CREATESHADER, CreateShader)  \
    X(DELETESHADER, DeleteShader) X(DEPTHFUNC, DepthFunc) X(DEPTHMASK, DepthMask)                  \
    X(DISABLE, Disable) X(DRAWARRAYS, DrawArrays) X(DRAWARRAYSINSTANCED, DrawArraysInstanced)      \
    X(DRAWBUFFER, DrawBuffer) X(DRAWELEMENTS, DrawElements) X(ENABLE, Enable)                      \
    X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)                                            \
    X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)                                            \
    X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) X(GENBUFFERS, GenBuffers)                        \
    X(GENFRAMEBUFFERS, GenFramebuffers)                          \
    X(GENRENDERBUFFERS, GenRenderbuffers) X(GENTEXTURES, GenTextures)                              \
    X(GENVERTEXARRAYS, GenVertexArrays) X(GETERROR, GetError) X(GETINTEGERV, GetIntegerv)          \
    X(GETPROGRAMINFOLOG, GetProgramInfoLog) X(GETPROGRAMIV, GetProgramiv)                          \
    X(GETSHADERINFOLOG, GetShaderInfoLog) X(GETSHADERIV, GetShaderiv) X(GETSTRING, GetString)      \
    X(GETUNIFORMBLOCKINDEX, GetUniformBlockIndex) X(GETUNIFORMLOCATION, GetUniformLocation)        \
    X(LINKPROGRAM, LinkProgram) X(PIXELSTOREI, PixelStorei) X(READBUFFER, ReadBuffer)              \
    X(READPIXELS, ReadPixels) X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample)    \
    X(SHADERSOURCE, ShaderSource) X(TEXIMAGE2D, TexImage2D)                                        \
    X(TEXIMAGE2DMULTISAMPLE, TexImage2DMultisample) X(TEXPARAMETERI, TexParameteri)                \
    X(UNIFORM1F, Uniform1f) X(UNIFORM1I, Uniform1i) X(UNIFORM3F, Uniform3f)                        \
    X(UNIFORM4F, Uniform4f) X(UNIFORMBLOCKBINDING, UniformBlockBinding)                            \
    X(USEPROGRAM, UseProgram) X(VERTEXATTRIBDIVISOR, VertexAttribDivisor)                          \
    X(VERTEXATTRIBPOINTER, VertexAttribPointer) X(VIEWPORT, Viewport)

/* clang-format on */

struct cs_gl_calls {
#define X(upper, name) PFNGL##upper##PROC name;
    CS_GL_CALLS(X)
#undef X
};

extern struct cs_gl_calls gl;

/* Loads all calls from the current context. CS_ERR_MODULE if it offers less than OpenGL 3.3. */
enum cs_status cs_gl_load(struct cs_error *error);

/* CS_ERR_MODULE if a call has failed since the last check; `during` names the task. */
enum cs_status cs_gl_check(const char *during, struct cs_error *error);

/* The frame buffer of a picture, and reading its pixels back. */

/* OpenGL names and copies of the samples. */
struct cs_framebuffer {
    unsigned draw_framebuffer,
        read_framebuffer; /* frame buffers; the same where a pixel has one sample */
    int width, height;
    uint32_t n_samples; /* per pixel and pass: 1 or 4 */
    uint32_t passes;    /* 2: eight samples, four at a time */
    bool clear;         /* transparent background */
    unsigned samples, program,
        object; /* texture of the samples; the program that copies one of each pixel */
    int number; /* location of the uniform: which sample */
    uint32_t *rgba[CS_SAMPLES]; /* (height, width) per sample, bottom row first, of the arena */
    const struct cs_srgb *srgb; /* owned by the arena */
};

/* Makes the buffers of the scene's size and samples. CS_ERR_MODULE if the driver cannot,
 * CS_ERR_MEMORY. */
enum cs_status cs_framebuffer_init(struct cs_framebuffer *target,
                                   const struct cs_render *render, struct cs_arena *arena,
                                   struct cs_error *error);

/* Clears the depth; what is drawn until the next frame buffer goes here. */
void cs_framebuffer_begin(const struct cs_framebuffer *target);

/* Copies the samples of a pass. */
void cs_framebuffer_copy(const struct cs_framebuffer *target, uint32_t pass);

/* Makes the picture of all samples, top row first. Each pixel is the mean of its samples in
 * linear light (cs_srgb_mean); the resolve of drivers averages bytes. */
void cs_framebuffer_resolve(const struct cs_framebuffer *target, struct cs_image *image);

/* Shadow maps through OpenGL: depth seen from each light. */

/* OpenGL names: program without colour and its uniform, frame buffers, depth textures. */
struct cs_shadow {
    unsigned program, frames[CS_LIGHTS], textures[CS_LIGHTS];
    int number;
};

/* Makes the maps of n lights. CS_ERR_MODULE if the driver cannot. */
enum cs_status cs_shadow_init(struct cs_shadow *shadow, uint32_t n, struct cs_error *error);

/* Starts the map of light l: everything drawn until the next frame buffer casts shadow. */
void cs_shadow_begin(const struct cs_shadow *shadow, uint32_t l);

/* Binds the maps to texture units from 1 on, as the surface program samples them. */
void cs_shadow_bind(const struct cs_shadow *shadow);

/* Lines and the colour bar's rectangle through OpenGL. */

/* OpenGL names and uniform locations; a renderer's cs_lines. */
struct cs_gl_lines {
    struct cs_lines lines; /* first: its calls cast a pointer to it back to this struct */
    unsigned program, object, buffer;
    int colour_location, half_width, depth_offset, flat;
    unsigned ramp, ramp_object;
    int box;
};

/* Builds the programs and sets the calls of `lines`. CS_ERR_MODULE. */
enum cs_status cs_gl_lines_init(struct cs_gl_lines *lines, struct cs_error *error);

/* GLSL programs: their text, and how they are built. */

/* The text of one program; common text (the view block, sRGB, colour map) is put before both.
 */
struct cs_shader_text {
    const char *name, *vertex, *fragment;
};

extern const struct cs_shader_text cs_shader_sky;     /* background with a vertical gradient */
extern const struct cs_shader_text cs_shader_surface; /* cloth and colliders */
extern const struct cs_shader_text cs_shader_shadow;  /* depth seen from the light */
extern const struct cs_shader_text cs_shader_line;    /* lines and dots of any width */
extern const struct cs_shader_text cs_shader_bar;     /* rectangle in colours of the map */
extern const struct cs_shader_text cs_shader_sample;  /* one sample of every pixel */

/* Compiles and links. The view block is bound to CS_VIEW_BINDING, the samplers `picture` and
 * `depth` to texture units 0 and 1. On failure CS_ERR_MODULE with the compiler's log in one
 * line. */
enum cs_status cs_shader_make(const struct cs_shader_text *text, unsigned *program,
                              struct cs_error *error);

/* Background through OpenGL. */

/* OpenGL names. */
struct cs_sky {
    unsigned object, program;
};

/* Builds the program. CS_ERR_MODULE. */
enum cs_status cs_sky_init(struct cs_sky *sky, struct cs_error *error);

/* Draws the sky over every pixel; leaves the depth alone. */
void cs_sky_draw(const struct cs_sky *sky);

/* Triangles on the graphics side, and the program that shades them. */

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
    int mode, front_location, back_location, coefficients, depth_bias_location;
    int span, ink, has_lines; /* of the ground */
};

/* Builds the program. CS_ERR_MODULE with the compiler's log. */
enum cs_status cs_surface_program_init(struct cs_surface_program *program,
                                       struct cs_error *error);

/* Uses the program with the uniforms of a style. */
void cs_surface_program_use(const struct cs_surface_program *program,
                            const struct cs_surface_style *style);

#endif
