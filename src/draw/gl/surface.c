/* Uploads, shades and draws triangles through OpenGL. */
#include "draw/gl/gl.h"
#include "draw/mesh.h"
#include "draw/view.h"

void cs_view_upload(struct cs_view_state *view) {
    if (!view->buffer)
        gl.GenBuffers(1, &view->buffer);
    gl.BindBuffer(GL_UNIFORM_BUFFER, view->buffer);
    gl.BufferData(GL_UNIFORM_BUFFER, sizeof view->block, &view->block, GL_DYNAMIC_DRAW);
    gl.BindBufferBase(GL_UNIFORM_BUFFER, CS_VIEW_BINDING, view->buffer);
}

/* Describes an attribute of the bound vertex array: `size` floats at an offset of each vertex.
 * Locations: 0 position, 1 normal, 2 texture coordinates, 3 value. */
static void attribute(GLuint index, GLint size, size_t stride, size_t offset) {
    gl.EnableVertexAttribArray(index);
    gl.VertexAttribPointer(index, size, GL_FLOAT, GL_FALSE, (GLsizei)stride,
                           (const void *)(uintptr_t)offset);
}

void cs_surface_init(struct cs_surface *surface, const uint32_t *indices, uint32_t n_indices) {
    const size_t stride = sizeof(struct cs_vertex);
    gl.GenVertexArrays(1, &surface->object);
    gl.BindVertexArray(surface->object);
    gl.GenBuffers(1, &surface->vertices);
    gl.BindBuffer(GL_ARRAY_BUFFER, surface->vertices);
    attribute(0, 3, stride, offsetof(struct cs_vertex, position));
    attribute(1, 3, stride, offsetof(struct cs_vertex, normal));
    attribute(3, 1, stride, offsetof(struct cs_vertex, value));
    surface->has_indices = indices != NULL;
    surface->n_drawn = n_indices;
    if (indices) {
        GLuint buffer;
        gl.GenBuffers(1, &buffer);
        gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
        gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(n_indices * sizeof *indices),
                      indices, GL_STATIC_DRAW);
    }
}

void cs_surface_upload(struct cs_surface *surface, const struct cs_vertex *vertices,
                       uint32_t n) {
    gl.BindBuffer(GL_ARRAY_BUFFER, surface->vertices);
    gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(n * sizeof *vertices), vertices,
                  GL_STREAM_DRAW);
    if (!surface->has_indices)
        surface->n_drawn = n;
}

void cs_surface_set_uv(struct cs_surface *surface, const float *uv, uint32_t n) {
    GLuint buffer;
    gl.BindVertexArray(surface->object);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(2 * n * sizeof *uv), uv, GL_STATIC_DRAW);
    attribute(2, 2, 2 * sizeof *uv, 0);
}

void cs_surface_draw(const struct cs_surface *surface) {
    gl.BindVertexArray(surface->object);
    if (surface->has_indices)
        gl.DrawElements(GL_TRIANGLES, (GLsizei)surface->n_drawn, GL_UNSIGNED_INT, NULL);
    else
        gl.DrawArrays(GL_TRIANGLES, 0, (GLsizei)surface->n_drawn);
}

enum cs_status cs_surface_program_init(struct cs_surface_program *program,
                                       struct cs_error *error) {
    if (cs_shader_make(&cs_shader_surface, &program->name, error) != CS_OK)
        return error->status;
    program->mode = gl.GetUniformLocation(program->name, "mode");
    program->front_location = gl.GetUniformLocation(program->name, "front");
    program->back_location = gl.GetUniformLocation(program->name, "back");
    program->coefficients = gl.GetUniformLocation(program->name, "coefficients");
    program->fade_location = gl.GetUniformLocation(program->name, "fade");
    program->depth_bias_location = gl.GetUniformLocation(program->name, "sink");
    return CS_OK;
}

void cs_surface_program_use(const struct cs_surface_program *program,
                            const struct cs_surface_style *style) {
    gl.UseProgram(program->name);
    gl.Uniform1i(program->mode, (GLint)style->mode);
    gl.Uniform3f(program->front_location, (float)style->front_colour[0],
                 (float)style->front_colour[1], (float)style->front_colour[2]);
    gl.Uniform3f(program->back_location, (float)style->back_colour[0],
                 (float)style->back_colour[1], (float)style->back_colour[2]);
    gl.Uniform4f(program->coefficients, (float)style->ambient, (float)style->diffuse,
                 (float)style->specular, (float)style->shininess);
    gl.Uniform1f(program->fade_location, (float)style->fade_radius);
    gl.Uniform1f(program->depth_bias_location, (float)style->depth_bias);
    if (style->mode == CS_SURFACE_TEXTURED) {
        gl.ActiveTexture(GL_TEXTURE0);
        gl.BindTexture(GL_TEXTURE_2D, style->texture);
    }
}

/* 16 bits per channel hold linear light: 8 would show steps in the dark. */
unsigned cs_texture_make(const struct cs_mipmap *mips) {
    GLuint name;
    gl.GenTextures(1, &name);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, name);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (int level = 0; level < mips->n; level++)
        gl.TexImage2D(GL_TEXTURE_2D, level, GL_RGB16, mips->levels[level].width,
                      mips->levels[level].height, 0, GL_RGB, GL_UNSIGNED_SHORT,
                      mips->levels[level].light);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, mips->n - 1);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return name;
}
