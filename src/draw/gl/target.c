/* Holds the frame buffer that is drawn into, and reads its pixels back. */
#include "draw/gl/target.h"

#include "draw/gl/gl.h"

#include <stdbool.h>

static GLuint make_buffer(GLenum attachment, GLenum format, int samples,
                          const struct cs_target *target) {
    GLuint buffer;
    gl.GenRenderbuffers(1, &buffer);
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, target->width,
                                      target->height);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
    return buffer;
}

// colour (and depth) with so many samples; 0: a plain one
static enum cs_status make_frame(unsigned *frame, int samples, bool depth,
                                 const struct cs_target *target, struct cs_error *error) {
    gl.GenFramebuffers(1, frame);
    gl.BindFramebuffer(GL_FRAMEBUFFER, *frame);
    make_buffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, samples, target);
    if (depth)
        make_buffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, samples, target);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return cs_fail(error, CS_ERR_MODULE,
                       "the driver cannot draw into %d x %d pixels with %d samples",
                       target->width, target->height, samples > 1 ? samples : 1);
    return CS_OK;
}

enum cs_status cs_target_init(struct cs_target *target, int width, int height, int samples,
                              struct cs_arena *arena, struct cs_error *error) {
    GLint limit = 0;
    gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
    if (width > limit || height > limit)
        return cs_fail(error, CS_ERR_MODULE,
                       "the driver draws at most %d x %d pixels, not %d x %d", limit, limit,
                       width, height);
    target->width = width;
    target->height = height;
    target->rgba = cs_arena_take_n(arena, (size_t)width * (size_t)height, 4, error);
    if (!target->rgba)
        return error->status;
    if (make_frame(&target->many, samples > 1 ? samples : 0, true, target, error) != CS_OK)
        return error->status;
    target->single = target->many;
    if (samples > 1)
        return make_frame(&target->single, 0, false, target, error);
    return CS_OK;
}

void cs_target_begin(const struct cs_target *target) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, target->many);
    gl.Viewport(0, 0, target->width, target->height);
    gl.DepthMask(GL_TRUE);
    gl.Clear(GL_DEPTH_BUFFER_BIT); // the sky covers every pixel
}

void cs_target_read(const struct cs_target *target, struct cs_image *image) {
    const int w = target->width, h = target->height;
    /* OpenGL reads no multisampled pixels: they are averaged into the plain buffer first */
    if (target->single != target->many) {
        gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target->many);
        gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target->single);
        gl.BlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, target->single);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    gl.ReadPixels(0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, target->rgba);
    image->width = (uint32_t)w;
    image->height = (uint32_t)h;
    uint8_t *out = image->rgb;
    /* OpenGL counts rows from the bottom, a picture from the top */
    for (int row = h - 1; row >= 0; row--) {
        const uint8_t *in = target->rgba + (size_t)row * (size_t)w * 4;
        for (int i = 0; i < w; i++, in += 4, out += 3) {
            out[0] = in[0];
            out[1] = in[1];
            out[2] = in[2];
        }
    }
}
