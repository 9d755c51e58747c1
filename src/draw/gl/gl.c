/* Loads the OpenGL 3.3 calls by name, and turns OpenGL errors into messages. */
#include "draw/gl/gl.h"

#include "draw/gl/context.h"

struct cs_gl_calls gl;

enum cs_status cs_gl_load(struct cs_error *error) {
#define X(upper, name) gl.name = (PFNGL##upper##PROC)cs_context_proc("gl" #name);
    CS_GL_CALLS(X)
#undef X

    // a loader gives an address for any name, so that only the version tells what is there
    GLint major = 0, minor = 0;
    if (gl.GetIntegerv && gl.GetString) {
        gl.GetIntegerv(GL_MAJOR_VERSION, &major);
        gl.GetIntegerv(GL_MINOR_VERSION, &minor);
    }
    if (major * 10 + minor < 33)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer osmesa: OpenGL %d.%d found, 3.3 expected", major, minor);
    return CS_OK;
}

enum cs_status cs_gl_check(const char *during, struct cs_error *error) {
    const GLenum code = gl.GetError();
    if (code == GL_NO_ERROR)
        return CS_OK;
    if (code == GL_OUT_OF_MEMORY)
        return cs_fail(error, CS_ERR_MEMORY, "renderer osmesa: out of memory while %s", during);
    return cs_fail(error, CS_ERR_MODULE, "renderer osmesa: OpenGL error 0x%04x while %s", code,
                   during);
}
