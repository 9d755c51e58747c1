/* Draws lines and the rectangle of the colour bar through OpenGL. */

#include "draw/gl/gl.h"

/* Draws the collected lines; the shader widens each into a quad. */
static void draw(struct cs_lines *base, const struct cs_line_style *style) {
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
    lines->lines.draw = draw;
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
