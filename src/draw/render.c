/* Finds and loads a renderer module; part of the program, and free of OpenGL. */
#include "draw/render.h"
#include "base/text.h"

#include <dlfcn.h>
#include <unistd.h>

const char *const cs_renderer_names[] = {"auto", "cpu", "osmesa", "egl", NULL};

/* Debian packages of the libraries that a module is built with, and needs when it runs. */
static const struct {
    const char *build, *run;
} packages[] = {[CS_RENDERER_CPU] = {NULL, NULL},
                [CS_RENDERER_OSMESA] = {"libosmesa6-dev", "libosmesa6"},
                [CS_RENDERER_EGL] = {"libegl-dev", "libegl1 (and libgl1-mesa-dri)"}};

static enum cs_status fail_missing(const char *path, enum cs_renderer_kind kind,
                                   struct cs_error *error) {
    const char *name = cs_renderer_names[kind], *package = packages[kind].build;
    if (!package)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer %s: no module %s: install clothsim again", name, path);
    return cs_fail(error, CS_ERR_MODULE,
                   "renderer %s: no module %s: build clothsim with the Debian package %s, or "
                   "draw with --renderer cpu",
                   name, path, package);
}

static enum cs_status open_path(const char *path, enum cs_renderer_kind kind,
                                const struct cs_renderer **renderer, struct cs_error *error) {
    const char *name = cs_renderer_names[kind];
    if (access(path, R_OK) != 0)
        return fail_missing(path, kind, error);
    // never closed: the driver leaves threads and exit handlers behind
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!module)
        return cs_fail(error, CS_ERR_MODULE, "renderer %s cannot be loaded: %s; install %s%s",
                       name, dlerror(),
                       packages[kind].run ? "the Debian package " : "clothsim again",
                       packages[kind].run ? packages[kind].run : "");
    const struct cs_renderer *found = dlsym(module, "clothsim_renderer");
    if (!found)
        return cs_fail(error, CS_ERR_MODULE, "renderer %s: %s is not a renderer module", name,
                       path);
    if (found->abi != CS_RENDERER_ABI)
        return cs_fail(
            error, CS_ERR_MODULE,
            "renderer %s: %s has interface version %u, %u expected: install clothsim "
            "again",
            name, path, found->abi, CS_RENDERER_ABI);
    if (!found->create || !found->paint || !found->description || !found->destroy)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer %s: %s lacks a call: install clothsim again", name, path);
    *renderer = found;
    return CS_OK;
}

static enum cs_status open_one(const char *folder, enum cs_renderer_kind kind,
                               const struct cs_renderer **renderer, struct cs_error *error) {
    struct cs_text path = {0};
    cs_text_add(&path, "%s/render-%s.so", folder, cs_renderer_names[kind]);
    if (path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the path of a module");
    else
        open_path(cs_text_get(&path), kind, renderer, error);
    cs_text_finish(&path);
    return error->status;
}

enum cs_status cs_renderer_open(const char *folder, enum cs_renderer_kind kind,
                                const struct cs_renderer **renderer, struct cs_error *error) {
    static const enum cs_renderer_kind order[] = {CS_RENDERER_CPU, CS_RENDERER_OSMESA,
                                                  CS_RENDERER_EGL};
    *renderer = NULL;
    if (kind != CS_RENDERER_AUTO)
        return open_one(folder, kind, renderer, error);
    struct cs_error first = {0};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
        struct cs_error later = {0};
        if (open_one(folder, order[i], renderer, i ? &later : &first) == CS_OK)
            return CS_OK;
    }
    // the first one needs no library: why it cannot be had is what helps
    return cs_fail(error, CS_ERR_MODULE, "%s", first.message);
}
