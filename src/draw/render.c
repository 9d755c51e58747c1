/* Finds and loads modules that draw; part of the program, and free of OpenGL. */
#include "draw/render.h"

#include "base/install_paths.h"

#include <stdio.h>

const char *const cs_renderer_names[] = {"auto", "cpu", "osmesa", NULL};

/* Debian packages that a module is built with; NULL: none. */
static const char *const packages[] = {
    [CS_RENDERER_CPU] = NULL, [CS_RENDERER_OSMESA] = "libosmesa6-dev"};

static enum cs_status open_one(const char *folder, enum cs_renderer_kind kind,
                               const struct cs_renderer **renderer, struct cs_error *error) {
    char name[64];
    snprintf(name, sizeof name, "render-%s", cs_renderer_names[kind]);
    const struct cs_renderer *found = cs_table_open(folder, name, "clothsim_renderer",
                                                    CS_RENDERER_ABI, packages[kind], error);
    if (found && (!found->create || !found->paint || !found->description || !found->destroy))
        return cs_fail(error, CS_ERR_MODULE, "%s lacks a call: install clothsim again", name);
    *renderer = found;
    return error->status;
}

enum cs_status cs_renderer_open(const char *folder, enum cs_renderer_kind kind,
                                const struct cs_renderer **renderer, struct cs_error *error) {
    struct cs_error later = {0};
    *renderer = NULL;
    if (kind != CS_RENDERER_AUTO)
        return open_one(folder, kind, renderer, error);
    // the first one needs no library: why it cannot be had is what helps
    if (open_one(folder, CS_RENDERER_CPU, renderer, error) &&
        open_one(folder, CS_RENDERER_OSMESA, renderer, &later) == CS_OK)
        *error = later;
    return error->status;
}
