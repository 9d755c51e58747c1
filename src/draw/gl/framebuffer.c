/* Draws into a multisampled texture, and reads it back sample by sample. */

#include "draw/gl/gl.h"

/* Attaches a renderbuffer to the bound frame buffer. */
static void attach_buffer(GLenum attachment, GLenum format, const struct cs_framebuffer *target,
                          int samples) {
    GLuint buffer;
    gl.GenRenderbuffers(1, &buffer);
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, target->width,
                                      target->height);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
}

/* Attaches a multisampled texture for the colour: unlike a renderbuffer, a shader can read
 * it. */
static void attach_samples(struct cs_framebuffer *target) {
    gl.GenTextures(1, &target->samples);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, target->samples);
    gl.TexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, (GLsizei)target->n_samples, GL_RGBA8,
                             target->width, target->height, GL_TRUE);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D_MULTISAMPLE,
                            target->samples, 0);
}

static enum cs_status check_frame(const struct cs_framebuffer *target, struct cs_error *error) {
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return cs_fail(error, CS_ERR_MODULE,
                       "the driver cannot draw into %d x %d pixels with %u samples",
                       target->width, target->height, target->n_samples);
    return CS_OK;
}

// the buffer that is drawn into: colour and depth
static enum cs_status make_drawn(struct cs_framebuffer *target, struct cs_error *error) {
    const bool many = target->n_samples > 1;
    gl.GenFramebuffers(1, &target->draw_framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target->draw_framebuffer);
    if (many)
        attach_samples(target);
    else
        attach_buffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, target, 0);
    attach_buffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, target,
                  many ? (int)target->n_samples : 0);
    return check_frame(target, error);
}

// OpenGL reads no multisampled pixels: one sample at a time is copied into a plain buffer
static enum cs_status make_read(struct cs_framebuffer *target, struct cs_error *error) {
    if (cs_shader_make(&cs_shader_sample, &target->program, error))
        return error->status;
    target->number = gl.GetUniformLocation(target->program, "number");
    gl.GenVertexArrays(1, &target->object);
    gl.GenFramebuffers(1, &target->read_framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target->read_framebuffer);
    attach_buffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, target, 0);
    return check_frame(target, error);
}

/* Allocates the copies of the samples and the sRGB tables. */
static enum cs_status allocate_pixels(struct cs_framebuffer *target, struct cs_arena *arena,
                                      struct cs_error *error) {
    const size_t n = (size_t)target->width * (size_t)target->height;
    struct cs_srgb *srgb = cs_arena_alloc(arena, sizeof *srgb, error);
    if (srgb)
        cs_srgb_make(srgb);
    target->srgb = srgb;
    for (uint32_t s = 0; s < target->passes * target->n_samples && !error->status; s++)
        target->rgba[s] = cs_arena_alloc_array(arena, n, sizeof *target->rgba[s], error);
    return error->status;
}

enum cs_status cs_framebuffer_init(struct cs_framebuffer *target,
                                   const struct cs_render *render, struct cs_arena *arena,
                                   struct cs_error *error) {
    const int width = (int)render->size[0], height = (int)render->size[1];
    GLint limit = 0;
    gl.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
    if (width > limit || height > limit)
        return cs_fail(error, CS_ERR_MODULE,
                       "the driver draws at most %d x %d pixels, not %d x %d", limit, limit,
                       width, height);
    target->width = width;
    target->height = height;
    target->n_samples = render->samples > 1 ? 4 : 1;
    target->passes = render->samples > 4 ? 2 : 1;
    target->clear = render->background.kind == CS_BACKGROUND_NONE;
    if (allocate_pixels(target, arena, error) || make_drawn(target, error))
        return error->status;
    target->read_framebuffer = target->draw_framebuffer;
    return target->n_samples > 1 ? make_read(target, error) : CS_OK;
}

void cs_framebuffer_begin(const struct cs_framebuffer *target) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, target->draw_framebuffer);
    gl.Viewport(0, 0, target->width, target->height);
    gl.DepthMask(GL_TRUE);
    gl.Clear(GL_DEPTH_BUFFER_BIT); // the sky covers every pixel
}

static void copy_sample(const struct cs_framebuffer *target, uint32_t sample) {
    gl.Disable(GL_DEPTH_TEST);
    gl.UseProgram(target->program);
    gl.Uniform1i(target->number, (GLint)sample);
    gl.BindVertexArray(target->object);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, target->samples);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.Enable(GL_DEPTH_TEST);
}

/* Converts a premultiplied colour, the result of blending on nothing, to a packed one: divides
 * by the opacity, and stores 255 - opacity in the highest byte. */
static uint32_t apart(uint32_t rgba) {
    const uint32_t cover = rgba >> 24;
    uint32_t out = (255 - cover) << 24;
    for (int k = 0; k < 24 && cover; k += 8) {
        const uint32_t byte = (255 * (rgba >> k & 255) + cover / 2) / cover;
        out |= (byte < 255 ? byte : 255) << k;
    }
    return out;
}

static uint32_t sample_of(const struct cs_framebuffer *target, uint32_t s, size_t i) {
    const uint32_t rgba = target->rgba[s][i];
    return target->clear ? apart(rgba) : rgba & 0xffffff;
}

// packed colour of pixel i, rows from the bottom
static uint32_t colour_of(const struct cs_framebuffer *target, size_t i) {
    const uint32_t n = target->passes * target->n_samples;
    uint32_t samples[CS_SAMPLES] = {sample_of(target, 0, i)}, differ = 0;
    for (uint32_t s = 1; s < CS_SAMPLES; s++) {
        samples[s] = s < n ? sample_of(target, s, i) : samples[s % n];
        differ |= samples[s] ^ samples[0];
    }
    return differ ? cs_srgb_mean(target->srgb, samples) : samples[0];
}

void cs_framebuffer_copy(const struct cs_framebuffer *target, uint32_t pass) {
    uint32_t *const *rgba = target->rgba + pass * target->n_samples;
    gl.BindFramebuffer(GL_FRAMEBUFFER, target->read_framebuffer);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    for (uint32_t s = 0; s < target->n_samples; s++) {
        if (target->read_framebuffer != target->draw_framebuffer)
            copy_sample(target, s);
        gl.ReadPixels(0, 0, target->width, target->height, GL_RGBA, GL_UNSIGNED_INT_8_8_8_8_REV,
                      rgba[s]);
    }
}

void cs_framebuffer_resolve(const struct cs_framebuffer *target, struct cs_image *image) {
    const int w = target->width, h = target->height;
    image->width = (uint32_t)w;
    image->height = (uint32_t)h;
    size_t out = 0;
    // OpenGL counts rows from the bottom, a picture from the top
    for (int row = h - 1; row >= 0; row--)
        for (int x = 0; x < w; x++)
            cs_srgb_store(target->srgb, colour_of(target, (size_t)row * (size_t)w + (size_t)x),
                          image, out++);
}

/* Shadow maps. */

/* The texture compares: a sample returns the lit fraction of four texels, blended (Reeves
 * 1987). */
static void make_texture(unsigned *texture) {
    gl.GenTextures(1, texture);
    gl.ActiveTexture(GL_TEXTURE1);
    gl.BindTexture(GL_TEXTURE_2D, *texture);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, CS_SHADOW_SIDE, CS_SHADOW_SIDE, 0,
                  GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, NULL);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
}

enum cs_status cs_shadow_init(struct cs_shadow *shadow, uint32_t n, struct cs_error *error) {
    if (cs_shader_make(&cs_shader_shadow, &shadow->program, error) != CS_OK)
        return error->status;
    shadow->number = gl.GetUniformLocation(shadow->program, "number");
    for (uint32_t l = 0; l < n; l++) {
        make_texture(shadow->textures + l);
        gl.GenFramebuffers(1, shadow->frames + l);
        gl.BindFramebuffer(GL_FRAMEBUFFER, shadow->frames[l]);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
                                shadow->textures[l], 0);
        gl.DrawBuffer(GL_NONE);
        gl.ReadBuffer(GL_NONE);
        if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            return cs_fail(error, CS_ERR_MODULE, "the driver cannot draw a shadow");
    }
    return CS_OK;
}

void cs_shadow_begin(const struct cs_shadow *shadow, uint32_t l) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, shadow->frames[l]);
    gl.Viewport(0, 0, CS_SHADOW_SIDE, CS_SHADOW_SIDE);
    gl.DepthMask(GL_TRUE);
    gl.Enable(GL_DEPTH_TEST);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.UseProgram(shadow->program);
    gl.Uniform1i(shadow->number, (GLint)l);
}

void cs_shadow_bind(const struct cs_shadow *shadow) {
    for (unsigned l = 0; l < CS_LIGHTS; l++) {
        gl.ActiveTexture(GL_TEXTURE1 + l);
        gl.BindTexture(GL_TEXTURE_2D, shadow->textures[l]);
    }
}
