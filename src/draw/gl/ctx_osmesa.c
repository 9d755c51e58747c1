/* An OpenGL context through OSMesa. Its own buffer is never drawn into: frames go to
 * framebuffer objects. */
#include "draw/gl/context.h"

#include <GL/osmesa.h>
#include <stdlib.h>

/* The context, and the buffer that OSMesa requires. */
struct cs_context {
    OSMesaContext handle;
    unsigned char pixels[16 * 16 * 4]; // never drawn into
};

enum cs_status cs_context_create(struct cs_context **context, struct cs_error *error) {
    static const int attributes[] = {OSMESA_FORMAT,
                                     OSMESA_RGBA,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     3,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     3,
                                     0};
    *context = calloc(1, sizeof **context);
    if (!*context)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for an OpenGL context");
    (*context)->handle = OSMesaCreateContextAttribs(attributes, NULL);
    if (!(*context)->handle)
        cs_fail(error, CS_ERR_MODULE, "renderer osmesa: no OpenGL 3.3 core context");
    else
        /* current at once: the OpenGL calls are loaded next */
        cs_context_use(*context, error);
    if (error->status == CS_OK)
        return CS_OK;
    cs_context_destroy(*context);
    *context = NULL;
    return error->status;
}

enum cs_status cs_context_use(struct cs_context *context, struct cs_error *error) {
    if (!OSMesaMakeCurrent(context->handle, context->pixels, GL_UNSIGNED_BYTE, 16, 16))
        return cs_fail(error, CS_ERR_MODULE, "renderer osmesa: the context cannot be used");
    return CS_OK;
}

void (*cs_context_proc(const char *name))(void) {
    return OSMesaGetProcAddress(name);
}

void cs_context_destroy(struct cs_context *context) {
    if (!context)
        return;
    if (context->handle)
        OSMesaDestroyContext(context->handle);
    free(context);
}
