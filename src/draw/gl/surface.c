/* Draws triangles, sky and lines through OpenGL, each with its shader. */
#include "draw/gl/gl.h"
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
    program->span = gl.GetUniformLocation(program->name, "span");
    program->ink = gl.GetUniformLocation(program->name, "ink");
    program->has_lines = gl.GetUniformLocation(program->name, "has_lines");
    program->depth_bias_location = gl.GetUniformLocation(program->name, "sink");
    return CS_OK;
}

void cs_surface_program_use(const struct cs_surface_program *program,
                            const struct cs_surface_style *style) {
    const struct cs_ground_style *ground = &style->ground;
    gl.UseProgram(program->name);
    gl.Uniform1i(program->mode, (GLint)style->mode);
    gl.Uniform3f(program->front_location, (float)style->front_colour[0],
                 (float)style->front_colour[1], (float)style->front_colour[2]);
    gl.Uniform3f(program->back_location, (float)style->back_colour[0],
                 (float)style->back_colour[1], (float)style->back_colour[2]);
    gl.Uniform4f(program->coefficients, (float)style->ambient, (float)style->diffuse,
                 (float)style->specular, (float)style->shininess);
    gl.Uniform4f(program->span, ground->centre[0], ground->centre[1], ground->radius,
                 ground->tile);
    gl.Uniform4f(program->ink, ground->ink[0], ground->ink[1], ground->ink[2], ground->shadow);
    gl.Uniform1i(program->has_lines, ground->lines);
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

enum cs_status cs_sky_init(struct cs_sky *sky, struct cs_error *error) {
    gl.GenVertexArrays(1, &sky->object);
    return cs_shader_make(&cs_shader_sky, &sky->program, error);
}

void cs_sky_draw(const struct cs_sky *sky) {
    gl.Disable(GL_DEPTH_TEST);
    gl.UseProgram(sky->program);
    gl.BindVertexArray(sky->object);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.Enable(GL_DEPTH_TEST);
}

/* Draws the collected lines; the shader widens each into a quad. */
static void draw_lines(struct cs_lines *base, const struct cs_line_style *style) {
    const struct cs_gl_lines *lines = (const struct cs_gl_lines *)base;
    gl.UseProgram(lines->program);
    gl.Uniform4f(lines->colour_location, style->colour[0], style->colour[1], style->colour[2],
                 (float)style->alpha);
    gl.Uniform1f(lines->half_width, (float)style->half_width);
    gl.Uniform1f(lines->depth_offset, (float)style->depth_offset);
    gl.Uniform1i(lines->flat, style->flat);
    gl.BindVertexArray(lines->object);
    gl.BindBuffer(GL_ARRAY_BUFFER, lines->buffer);
    gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(base->n * sizeof *base->ends), base->ends,
                  GL_STREAM_DRAW);
    if (style->on_top || style->flat)
        gl.Disable(GL_DEPTH_TEST);
    /* no depth is written: soft edges would cut holes into later lines */
    gl.Enable(GL_BLEND);
    gl.DepthMask(GL_FALSE);
    gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)base->n);
    gl.DepthMask(GL_TRUE);
    gl.Disable(GL_BLEND);
    gl.Enable(GL_DEPTH_TEST);
}

static void draw_ramp(struct cs_lines *base, const double box[4]) {
    const struct cs_gl_lines *lines = (const struct cs_gl_lines *)base;
    gl.UseProgram(lines->ramp);
    gl.Uniform4f(lines->box, (float)box[0], (float)box[1], (float)box[2], (float)box[3]);
    gl.BindVertexArray(lines->ramp_object);
    gl.Disable(GL_DEPTH_TEST);
    gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl.Enable(GL_DEPTH_TEST);
}

enum cs_status cs_gl_lines_init(struct cs_gl_lines *lines, struct cs_error *error) {
    lines->lines.draw = draw_lines;
    lines->lines.ramp = draw_ramp;
    if (cs_shader_make(&cs_shader_line, &lines->program, error) != CS_OK ||
        cs_shader_make(&cs_shader_bar, &lines->ramp, error) != CS_OK)
        return error->status;
    lines->box = gl.GetUniformLocation(lines->ramp, "box");
    /* the bar has no vertex data, but a core context draws nothing without an array object */
    gl.GenVertexArrays(1, &lines->ramp_object);
    lines->colour_location = gl.GetUniformLocation(lines->program, "paint");
    lines->half_width = gl.GetUniformLocation(lines->program, "half_width");
    lines->depth_offset = gl.GetUniformLocation(lines->program, "lift");
    lines->flat = gl.GetUniformLocation(lines->program, "flat_");
    gl.GenVertexArrays(1, &lines->object);
    gl.BindVertexArray(lines->object);
    gl.GenBuffers(1, &lines->buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, lines->buffer);
    /* one instance a line: both ends advance by instance, not by vertex */
    for (GLuint end = 0; end < 2; end++) {
        gl.EnableVertexAttribArray(end);
        gl.VertexAttribPointer(end, 3, GL_FLOAT, GL_FALSE, 6 * sizeof(float),
                               (const void *)(end * 3 * sizeof(float)));
        gl.VertexAttribDivisor(end, 1);
    }
    return CS_OK;
}
