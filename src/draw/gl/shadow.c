#include "draw/gl/shadow.h"

#include "draw/gl/gl.h"
#include "draw/gl/shader.h"
#include "draw/matrix.h"

enum { SIDE = 512 }; // pixels: coarse enough to blur the edges

static void make_texture(struct cs_shadow *shadow) {
    gl.GenTextures(1, &shadow->texture);
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, shadow->texture);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, SIDE, SIDE, 0, GL_DEPTH_COMPONENT,
                  GL_UNSIGNED_INT, NULL);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
}

enum cs_status cs_shadow_init(struct cs_shadow *shadow, struct cs_error *error) {
    if (cs_shader_make(&cs_shader_shadow, &shadow->program, error) != CS_OK)
        return error->status;
    shadow->model = gl.GetUniformLocation(shadow->program, "model");
    make_texture(shadow);
    gl.GenFramebuffers(1, &shadow->frame);
    gl.BindFramebuffer(GL_FRAMEBUFFER, shadow->frame);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow->texture,
                            0);
    gl.DrawBuffer(GL_NONE);
    gl.ReadBuffer(GL_NONE);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return cs_fail(error, CS_ERR_MODULE, "the driver cannot draw a shadow");
    return CS_OK;
}

/* A ball around `solid` whose size and place change by steps: edges of the shadow keep still
 * from frame to frame, and yet a frame does not depend on those before it. */
static struct cs_ball coarse(const struct cs_ball *solid) {
    struct cs_ball ball = {{0}, 1};
    while (ball.radius > 1.1 * solid->radius)
        ball.radius /= 1.25;
    while (ball.radius < 1.1 * solid->radius)
        ball.radius *= 1.25;
    // at most 0.087 of the radius away from the middle: inside the margin of 1.1
    const double step = 0.1 * ball.radius;
    for (int i = 0; i < 3; i++)
        ball.centre[i] = step * floor(solid->centre[i] / step + 0.5);
    return ball;
}

bool cs_shadow_aim(const struct cs_ball *solid, struct cs_view_block *block) {
    static const double up[3] = {0, 1, 0};
    double eye[3], from[3], look[16], lens[16], both[16];
    const struct cs_ball ball = coarse(solid), *lit = &ball;
    const bool is_lamp = block->light[3] > 0;
    for (int i = 0; i < 3; i++) {
        const double light = (double)block->light[i];
        eye[i] = is_lamp ? light : lit->centre[i] + 2 * lit->radius * light;
    }
    cs_subtract(eye, lit->centre, from);
    const double distance = cs_length(from), r = lit->radius;
    block->shade[2] = distance > 1.05 * r;
    if (block->shade[2] == 0)
        return false;

    // the cone from a lamp that touches the ball
    const double slope = r / sqrt(distance * distance - r * r);
    cs_matrix_look(eye, lit->centre, up, look);
    if (is_lamp)
        cs_matrix_perspective(slope, 1, distance - r, distance + r, lens);
    else
        cs_matrix_parallel(r, distance - r, distance + r, lens);
    cs_matrix_multiply(lens, look, both);
    cs_matrix_to_float(both, block->world_to_light);
    block->shade[0] = 1.0f / SIDE;
    block->shade[1] = (float)(2 * (is_lamp ? slope * distance : r) / SIDE);
    return true;
}

void cs_shadow_begin(const struct cs_shadow *shadow) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, shadow->frame);
    gl.Viewport(0, 0, SIDE, SIDE);
    gl.DepthMask(GL_TRUE);
    gl.Enable(GL_DEPTH_TEST);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.UseProgram(shadow->program);
}

void cs_shadow_bind(const struct cs_shadow *shadow) {
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, shadow->texture);
}
