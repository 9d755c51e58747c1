/* An OpenGL context through EGL on Mesa's surfaceless platform: no display, no window. */
#include "draw/gl/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdlib.h>

struct cs_context {
    EGLDisplay display; // shared by all contexts of the process, hence never terminated
    EGLContext handle;
};

const char cs_context_name[] = "egl";

static enum cs_status fail(struct cs_error *error, const char *what) {
    return cs_fail(error, CS_ERR_MODULE,
                   "renderer egl: %s (EGL error 0x%04x); is the Debian package libgl1-mesa-dri "
                   "installed?",
                   what, (unsigned)eglGetError());
}

/* Opens the display and makes a core context of version 3.3 or later. */
static enum cs_status open(struct cs_context *context, struct cs_error *error) {
    static const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                        3,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        3,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_NONE};
    context->display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (context->display == EGL_NO_DISPLAY || !eglInitialize(context->display, NULL, NULL))
        return fail(error, "the surfaceless platform is not available");
    if (!eglBindAPI(EGL_OPENGL_API))
        return fail(error, "no OpenGL");
    /* no config, since there is no surface to match: frames go to framebuffer objects */
    context->handle =
        eglCreateContext(context->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context->handle == EGL_NO_CONTEXT)
        return fail(error, "no OpenGL 3.3 core context");
    return cs_context_use(context, error);
}

enum cs_status cs_context_create(struct cs_context **context, struct cs_error *error) {
    *context = calloc(1, sizeof **context);
    if (!*context)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for an OpenGL context");
    if (open(*context, error) == CS_OK)
        return CS_OK;
    cs_context_destroy(*context);
    *context = NULL;
    return error->status;
}

enum cs_status cs_context_use(struct cs_context *context, struct cs_error *error) {
    // the API is chosen by thread, and painting may happen in another one
    if (!eglBindAPI(EGL_OPENGL_API) ||
        !eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->handle))
        return fail(error, "the context cannot be used");
    return CS_OK;
}

void (*cs_context_proc(const char *name))(void) {
    return eglGetProcAddress(name);
}

void cs_context_destroy(struct cs_context *context) {
    if (!context)
        return;
    if (context->handle != EGL_NO_CONTEXT) {
        eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(context->display, context->handle);
    }
    free(context);
}
