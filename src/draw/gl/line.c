#include "draw/gl/line.h"

#include "draw/gl/gl.h"
#include "draw/gl/shader.h"

enum cs_status cs_lines_init(struct cs_lines *lines, uint32_t capacity, struct cs_arena *arena,
                             struct cs_error *error) {
    lines->capacity = capacity;
    lines->ends = cs_arena_take_n(arena, capacity, sizeof *lines->ends, error);
    if (!lines->ends || cs_shader_make(&cs_shader_line, &lines->program, error) != CS_OK)
        return error->status;
    lines->paint = gl.GetUniformLocation(lines->program, "paint");
    lines->half_width = gl.GetUniformLocation(lines->program, "half_width");
    lines->lift = gl.GetUniformLocation(lines->program, "lift");
    lines->flat = gl.GetUniformLocation(lines->program, "flat_");
    gl.GenVertexArrays(1, &lines->object);
    gl.BindVertexArray(lines->object);
    gl.GenBuffers(1, &lines->buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, lines->buffer);
    for (GLuint end = 0; end < 2; end++) {
        gl.EnableVertexAttribArray(end);
        gl.VertexAttribPointer(end, 3, GL_FLOAT, GL_FALSE, sizeof *lines->ends,
                               (const void *)(end * 3 * sizeof(float)));
        gl.VertexAttribDivisor(end, 1);
    }
    return CS_OK;
}

void cs_lines_add(struct cs_lines *lines, const double from[3], const double to[3]) {
    CS_ASSERT(lines->n < lines->capacity);
    float *ends = lines->ends[lines->n++];
    for (int i = 0; i < 3; i++) {
        ends[i] = (float)from[i];
        ends[3 + i] = (float)to[i];
    }
}

void cs_lines_draw(struct cs_lines *lines, const struct cs_line_style *style) {
    gl.UseProgram(lines->program);
    gl.Uniform4f(lines->paint, style->colour[0], style->colour[1], style->colour[2],
                 (float)style->alpha);
    gl.Uniform1f(lines->half_width, (float)style->half_width);
    gl.Uniform1f(lines->lift, (float)style->lift);
    gl.Uniform1i(lines->flat, style->flat);
    gl.BindVertexArray(lines->object);
    gl.BindBuffer(GL_ARRAY_BUFFER, lines->buffer);
    gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(lines->n * sizeof *lines->ends), lines->ends,
                  GL_STREAM_DRAW);
    gl.Enable(GL_BLEND);
    gl.DepthMask(GL_FALSE);
    gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)lines->n);
    gl.DepthMask(GL_TRUE);
    gl.Disable(GL_BLEND);
    lines->n = 0;
}
