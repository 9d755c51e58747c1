#include "draw/gl/backdrop.h"

#include "draw/colour.h"
#include "draw/gl/gl.h"
#include "draw/gl/shader.h"

// the power of ten at or below length
static double power_of_ten(double length) {
    double power = 1;
    while (power > length)
        power /= 10;
    while (power * 10 <= length)
        power *= 10;
    return power;
}

static bool has_floor(const struct cs_scene *scene) {
    for (uint32_t i = 0; i < scene->colliders.n; i++)
        if (cs_scene_colliders(scene)[i].visible && cs_scene_colliders(scene)[i].floor.present)
            return true;
    return false;
}

static enum cs_status init_ground(struct cs_backdrop *backdrop, const struct cs_scene *scene,
                                  const struct cs_ball *extent, struct cs_error *error) {
    float ink[3];
    if (cs_shader_make(&cs_shader_ground, &backdrop->ground, error) != CS_OK)
        return error->status;
    cs_colour_ink(scene->render.background, ink);
    gl.UseProgram(backdrop->ground);
    gl.Uniform4f(gl.GetUniformLocation(backdrop->ground, "span"), (float)extent->centre[0],
                 (float)scene->render.ground_height, (float)extent->centre[2],
                 (float)(6 * extent->radius));
    gl.Uniform1f(gl.GetUniformLocation(backdrop->ground, "pitch"),
                 (float)power_of_ten(0.3 * extent->radius));
    gl.Uniform3f(gl.GetUniformLocation(backdrop->ground, "ink"), ink[0], ink[1], ink[2]);
    // a floor shows the shadow itself
    gl.Uniform1f(gl.GetUniformLocation(backdrop->ground, "shadow_ink"),
                 has_floor(scene) ? 0.0f : 0.4f);
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
