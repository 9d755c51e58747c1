/* Draws the sky and the grid on the ground through OpenGL. */
#include "draw/gl/backdrop.h"

#include "draw/gl/gl.h"
#include "draw/gl/shader.h"
#include "draw/ground.h"

static enum cs_status init_ground(struct cs_backdrop *backdrop, const struct cs_scene *scene,
                                  const struct cs_ball *extent, struct cs_error *error) {
    struct cs_ground ground;
    if (cs_shader_make(&cs_shader_ground, &backdrop->ground, error) != CS_OK)
        return error->status;
    cs_ground_make(&ground, scene, extent);
    const GLuint program = backdrop->ground;
    gl.UseProgram(program);
    gl.Uniform4f(gl.GetUniformLocation(program, "span"), ground.span[0], ground.span[1],
                 ground.span[2], ground.span[3]);
    gl.Uniform1f(gl.GetUniformLocation(program, "pitch"), ground.pitch);
    gl.Uniform3f(gl.GetUniformLocation(program, "ink"), ground.ink[0], ground.ink[1],
                 ground.ink[2]);
    gl.Uniform1f(gl.GetUniformLocation(program, "shadow_ink"), ground.shadow);
    return CS_OK;
}

enum cs_status cs_backdrop_init(struct cs_backdrop *backdrop, const struct cs_scene *scene,
                                const struct cs_ball *extent, struct cs_error *error) {
    gl.GenVertexArrays(1, &backdrop->object);
    if (cs_shader_make(&cs_shader_sky, &backdrop->sky, error) != CS_OK)
        return error->status;
    return scene->render.ground ? init_ground(backdrop, scene, extent, error) : CS_OK;
}

void cs_backdrop_draw_sky(const struct cs_backdrop *backdrop) {
    gl.Disable(GL_DEPTH_TEST);
    gl.UseProgram(backdrop->sky);
    gl.BindVertexArray(backdrop->object);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.Enable(GL_DEPTH_TEST);
}

void cs_backdrop_draw_ground(const struct cs_backdrop *backdrop) {
    gl.UseProgram(backdrop->ground);
    gl.BindVertexArray(backdrop->object);
    gl.Enable(GL_BLEND);
    gl.DepthMask(GL_FALSE);
    gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    gl.DepthMask(GL_TRUE);
    gl.Disable(GL_BLEND);
}
