/* Draws the sky and the grid on the ground through OpenGL. */

#include "draw/gl/gl.h"

static enum cs_status init_ground(struct cs_sky_and_ground *backdrop, struct cs_error *error) {
    const struct cs_ground *ground = &backdrop->ground;
    if (cs_shader_make(&cs_shader_ground, &backdrop->program, error) != CS_OK)
        return error->status;
    const GLuint program = backdrop->program;
    backdrop->fade_disc = gl.GetUniformLocation(program, "span");
    backdrop->box = gl.GetUniformLocation(program, "box");
    gl.UseProgram(program);
    gl.Uniform1f(gl.GetUniformLocation(program, "pitch"), ground->line_spacing);
    gl.Uniform3f(gl.GetUniformLocation(program, "ink"), ground->line_colour[0],
                 ground->line_colour[1], ground->line_colour[2]);
    gl.Uniform1f(gl.GetUniformLocation(program, "shadow_ink"), ground->shadow);
    return CS_OK;
}

enum cs_status cs_sky_and_ground_init(struct cs_sky_and_ground *backdrop,
                                      const struct cs_ground *ground, struct cs_error *error) {
    backdrop->ground = *ground;
    gl.GenVertexArrays(1, &backdrop->object);
    if (cs_shader_make(&cs_shader_sky, &backdrop->sky, error) != CS_OK)
        return error->status;
    return ground->present ? init_ground(backdrop, error) : CS_OK;
}

void cs_sky_and_ground_draw_sky(const struct cs_sky_and_ground *backdrop) {
    gl.Disable(GL_DEPTH_TEST);
    gl.UseProgram(backdrop->sky);
    gl.BindVertexArray(backdrop->object);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.Enable(GL_DEPTH_TEST);
}

void cs_sky_and_ground_draw_ground(const struct cs_sky_and_ground *backdrop) {
    const float *span = backdrop->ground.fade_disc, *box = backdrop->ground.box;
    if (!(box[0] < box[2] && box[1] < box[3]))
        return;
    gl.UseProgram(backdrop->program);
    gl.Uniform4f(backdrop->fade_disc, span[0], span[1], span[2], span[3]);
    gl.Uniform4f(backdrop->box, box[0], box[1], box[2], box[3]);
    gl.BindVertexArray(backdrop->object);
    gl.Enable(GL_BLEND);
    gl.DepthMask(GL_FALSE);
    gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl.DepthMask(GL_TRUE);
    gl.Disable(GL_BLEND);
}
