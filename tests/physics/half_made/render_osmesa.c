/* A renderer that cannot paint. */
#include "draw/render.h"

static enum cs_status create(const struct cs_canvas_settings *settings,
                             struct cs_canvas **canvas, struct cs_error *error) {
    (void)settings, (void)canvas;
    return error->status;
}

static const char *description(const struct cs_canvas *canvas) {
    (void)canvas;
    return "none";
}

static void destroy(struct cs_canvas *canvas) {
    (void)canvas;
}

extern const struct cs_renderer clothsim_renderer;
__attribute__((visibility("default")))
const struct cs_renderer clothsim_renderer = {.abi = CS_RENDERER_ABI,
                                              .name = "osmesa",
                                              .create = create,
                                              .description = description,
                                              .destroy = destroy};
