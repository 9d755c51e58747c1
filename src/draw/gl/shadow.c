/* Renders the depth map that is seen from the light. */
#include "draw/gl/shadow.h"

#include "draw/gl/gl.h"
#include "draw/gl/shader.h"
#include "draw/light_frustum.h"

/* The texture compares: a sample returns the lit fraction of four texels, blended (Reeves
 * 1987). */
static void make_texture(struct cs_shadow *shadow) {
    gl.GenTextures(1, &shadow->texture);
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, shadow->texture);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, CS_SHADOW_SIDE, CS_SHADOW_SIDE, 0,
                  GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, NULL);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
}

enum cs_status cs_shadow_init(struct cs_shadow *shadow, struct cs_error *error) {
    if (cs_shader_make(&cs_shader_shadow, &shadow->program, error) != CS_OK)
        return error->status;
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

void cs_shadow_begin(const struct cs_shadow *shadow) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, shadow->frame);
    gl.Viewport(0, 0, CS_SHADOW_SIDE, CS_SHADOW_SIDE);
    gl.DepthMask(GL_TRUE);
    gl.Enable(GL_DEPTH_TEST);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.UseProgram(shadow->program);
}

void cs_shadow_bind(const struct cs_shadow *shadow) {
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, shadow->texture);
}
