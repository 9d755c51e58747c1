/* place.h - a comparison on a small scene in a folder of its own. */
#ifndef COMPARE_PLACE_H
#define COMPARE_PLACE_H

#include "scene.h"

#include <signal.h>
#include <string.h>

static volatile sig_atomic_t stop;

struct watch {
    uint32_t rows, taken, stop_after;
};

static inline void count_row(void *ctx, const struct cs_cell *cell, bool taken) {
    struct watch *watch = ctx;
    ck_assert(*cell->outcome);
    watch->rows++;
    watch->taken += taken;
    stop = watch->rows == watch->stop_after;
}

struct place {
    char scene[64], folder[64];
};

static inline void place_make(struct place *place, const char *damping) {
    scene_write(place->scene, SMALL_SCENE, damping);
    snprintf(place->folder, sizeof place->folder, "compare-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(place->folder));
}

/* A run with a budget on a scene in units of so many metres. */
static inline enum cs_status run_in(struct cs_compare *compare,
                                    struct cs_compare_settings *settings,
                                    const struct place *place, const char *methods,
                                    struct watch *watch, double budget, double unit) {
    const bool large = unit > 1;
    struct cs_error error = {0};
    *settings = (struct cs_compare_settings){
        .run = {.session = {.scene = place->scene, .run = {.stop = &stop}}, .frames = 6},
        .methods = methods,
        .reference = {"rk4:dt=2e-4",
                      large ? "dopri5:rtol=1e-12,atol=1e-9" : "dopri5:rtol=1e-12,atol=1e-12"},
        .accuracy = 1e-6 * unit,
        .budget = budget,
        .runs = 1,
        .folder = place->folder,
        .cache = place->folder,
        .row = count_row,
        .ctx = watch};
    cs_compare_run(compare, settings, &error);
    ck_assert_msg(!error.status || error.status == CS_ERR_INTERRUPT ||
                      strstr(error.message, "another scene"),
                  "%s", error.message);
    return error.status;
}

static inline enum cs_status run_for(struct cs_compare *compare,
                                     struct cs_compare_settings *settings,
                                     const struct place *place, const char *methods,
                                     struct watch *watch, double budget) {
    return run_in(compare, settings, place, methods, watch, budget, 1);
}

static inline enum cs_status run(struct cs_compare *compare,
                                 struct cs_compare_settings *settings,
                                 const struct place *place, const char *methods,
                                 struct watch *watch) {
    return run_for(compare, settings, place, methods, watch, 0.5);
}

#endif
