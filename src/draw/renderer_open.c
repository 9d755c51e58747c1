/* Finds and loads a renderer module; part of the program, and free of OpenGL. */
#include "base/text.h"
#include "draw/render.h"

#include <dlfcn.h>
#include <unistd.h>

const char *const cs_gl_names[] = {"auto", "osmesa", "egl", NULL};

/* Debian packages of the libraries that a module is linked to, and needs when it runs. */
static const char *const packages[] = {NULL, "libosmesa6", "libegl1 (and libgl1-mesa-dri)"};

static enum cs_status open_path(const char *path, enum cs_gl gl,
                                const struct cs_renderer **renderer, struct cs_error *error) {
    const char *name = cs_gl_names[gl];
    if (access(path, R_OK) != 0)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer %s: no module %s: build clothsim with the renderer (Debian "
                       "packages libosmesa6-dev and libegl-dev), or install it again",
                       name, path);
    // never closed: the driver leaves threads and exit handlers behind
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!module)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer %s cannot be loaded: %s; install the Debian package %s", name,
                       dlerror(), packages[gl]);
    const struct cs_renderer *found = dlsym(module, "clothsim_renderer");
    if (!found)
        return cs_fail(error, CS_ERR_MODULE, "renderer %s: %s is no renderer module", name,
                       path);
    if (found->abi != CS_RENDERER_ABI)
        return cs_fail(
            error, CS_ERR_MODULE,
            "renderer %s: %s has interface version %u, %u expected: install clothsim "
            "again",
            name, path, found->abi, CS_RENDERER_ABI);
    *renderer = found;
    return CS_OK;
}

static enum cs_status open_one(const char *folder, enum cs_gl gl,
                               const struct cs_renderer **renderer, struct cs_error *error) {
    struct cs_text path = {0};
    cs_text_add(&path, "%s/render-%s.so", folder, cs_gl_names[gl]);
    if (path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the path of a module");
    else
        open_path(cs_text_get(&path), gl, renderer, error);
    cs_text_finish(&path);
    return error->status;
}

enum cs_status cs_renderer_open(const char *folder, enum cs_gl gl,
                                const struct cs_renderer **renderer, struct cs_error *error) {
    struct cs_error first = {0}, second = {0};
    *renderer = NULL;
    if (gl != CS_GL_AUTO)
        return open_one(folder, gl, renderer, error);
    if (open_one(folder, CS_GL_OSMESA, renderer, &first) == CS_OK ||
        open_one(folder, CS_GL_EGL, renderer, &second) == CS_OK)
        return CS_OK;
    // each message is cut, so that both fit into one
    return cs_fail(error, CS_ERR_MODULE, "%.480s; %.480s", first.message, second.message);
}
