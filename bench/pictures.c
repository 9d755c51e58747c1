/* Pictures: the state of one frame drawn again and again, by each renderer in turns, and packed
 * into a file. */
#include "timing.h"

#include "base/clock.h"
#include "base/png.h"
#include "session/frame_picture.h"
#include "session/session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* `hang` is 64 x 64, as it is shipped */
static const struct shot {
    const char *scene, *look;
    uint32_t width, height;
} shots[] = {{"sphere_rest", "lit", 640, 480},
             {"sphere_rest", "wireframe", 640, 480},
             {"hang", "lit", 640, 480},
             {"sphere_rest", "lit", 1920, 1080}},
  shots_quick[] = {{"sphere_rest", "lit", 160, 120}, {"hang", "wireframe", 160, 120}};
enum { FRAME = 30, FRAME_QUICK = 1 };

/* what draws or packs, in the order of their columns */
enum { CPU, GL, PNG, WAYS };
static const char *const way_names[WAYS] = {"cpu", "osmesa", "png"};

struct drawing {
    struct cs_session *session;
    struct cs_picture picture;
    struct cs_image image; /* owned pixels */
    char path[64];         /* of the file */
    double first;          /* s, with all that is made ready */
    bool there;
    struct cs_error error;
};

static void draw(void *object) {
    struct drawing *drawing = object;
    cs_picture_begin(&drawing->picture, &drawing->session->run, &drawing->image);
    cs_picture_end(&drawing->picture, &drawing->error);
}

static void pack(void *object) {
    struct drawing *drawing = object;
    cs_png_write(drawing->path, &drawing->image, 1, NULL, 0, &drawing->error);
}

/* A renderer that is not in this build is left out. */
static void begin(struct drawing *drawing, enum cs_renderer_kind kind) {
    struct cs_error error = {0};
    const double start = cs_clock_cpu();
    drawing->there = !cs_picture_open(&drawing->picture, &drawing->session->system, kind, false,
                                      false, &error);
    if (drawing->there)
        draw(drawing);
    drawing->first = cs_clock_cpu() - start;
    if (kind == CS_RENDERER_CPU && error.status)
        cs_fail(&drawing->error, error.status, "%s", error.message);
}

static enum cs_status step(struct cs_session *session, const struct bench_settings *settings,
                           const struct shot *shot, struct cs_error *error) {
    char scene[1024], size[40];
    snprintf(scene, sizeof scene, "%.900s/scenes/%s.json", BENCH_ROOT, shot->scene);
    snprintf(size, sizeof size, "[%u,%u]", shot->width, shot->height);
    const struct cs_override overrides[] = {{"render.size", size}, {"render.look", shot->look}};
    const struct cs_session_settings asked = {
        .scene = scene, .overrides = overrides, .n_overrides = 2, .render = true};
    const uint32_t frames = settings->quick ? FRAME_QUICK : FRAME;
    if (cs_session_open(session, &asked, error))
        return error->status;
    while (session->run.frame < frames && session->run.outcome == CS_RUNNING && !error->status)
        cs_run_frame(&session->run, error);
    return error->status;
}

static void add_rows(struct bench_table *table, const struct shot *shot,
                     const struct drawing drawings[WAYS], const struct bench_task tasks[WAYS],
                     uint32_t n, const uint32_t ways[WAYS]) {
    for (uint32_t k = 0; k < n; k++) {
        const struct bench_spread *time = &tasks[k].time;
        char first[32] = "";
        if (ways[k] != PNG)
            snprintf(first, sizeof first, "%.2f", 1e3 * drawings[ways[k]].first);
        bench_table_add(table, "%s,%s,%ux%u,%s,%.3f,%.3f,%.3f,%s", shot->scene, shot->look,
                        shot->width, shot->height, way_names[ways[k]], 1e3 * time->median,
                        1e3 * time->min, 1e3 * time->max, first);
    }
}

static enum cs_status prepare(struct drawing drawings[WAYS], struct cs_session *session,
                              const struct bench_settings *settings, const struct shot *shot,
                              struct cs_error *error) {
    for (int way = 0; way < WAYS; way++) {
        struct drawing *drawing = drawings + way;
        drawing->session = session;
        drawing->image = (struct cs_image){shot->width, shot->height, NULL, NULL};
        drawing->image.rgb = calloc((size_t)shot->width * shot->height, 3);
        if (!drawing->image.rgb)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
        snprintf(drawing->path, sizeof drawing->path, "%s/picture.png", settings->scratch);
    }
    begin(drawings + CPU, CS_RENDERER_CPU);
    // within seconds there is no time for OpenGL
    if (!settings->quick)
        begin(drawings + GL, CS_RENDERER_OSMESA);
    if (!drawings[CPU].there)
        return cs_fail(error, drawings[CPU].error.status, "%s", drawings[CPU].error.message);
    drawings[PNG].there = true;
    memcpy(drawings[PNG].image.rgb, drawings[CPU].image.rgb,
           (size_t)3 * shot->width * shot->height);
    return CS_OK;
}

static enum cs_status measure(const struct bench_settings *settings, const struct shot *shot,
                              struct cs_session *session, struct bench_table *table,
                              struct cs_error *error) {
    struct drawing drawings[WAYS] = {{0}};
    struct bench_task tasks[WAYS];
    uint32_t ways[WAYS], n = 0;
    if (!prepare(drawings, session, settings, shot, error)) {
        for (uint32_t way = 0; way < WAYS; way++) {
            if (!drawings[way].there)
                continue;
            tasks[n] =
                (struct bench_task){.run = way == PNG ? pack : draw, .object = drawings + way};
            ways[n++] = way;
        }
        bench_measure(settings, tasks, n);
        add_rows(table, shot, drawings, tasks, n, ways);
    }
    for (int way = 0; way < WAYS; way++) {
        if (!error->status && drawings[way].error.status)
            cs_fail(error, drawings[way].error.status, "%s", drawings[way].error.message);
        cs_picture_close(&drawings[way].picture);
        free(drawings[way].image.rgb);
    }
    return error->status;
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    const struct shot *list = settings->quick ? shots_quick : shots;
    const size_t n = settings->quick ? sizeof shots_quick / sizeof *shots_quick
                                     : sizeof shots / sizeof *shots;
    for (size_t k = 0; k < n && !error->status; k++) {
        struct cs_session session = {0};
        bench_report("%s, %s, %u x %u", list[k].scene, list[k].look, list[k].width,
                     list[k].height);
        if (!step(&session, settings, list + k, error))
            measure(settings, list + k, &session, table, error);
        cs_session_close(&session);
    }
    return error->status;
}

static const char *const columns[] = {"scene",  "look",   "size",     "by", "median_ms",
                                      "min_ms", "max_ms", "first_ms", NULL};
const struct bench_section bench_pictures = {
    .name = "pictures",
    .summary = "ms of one picture by each renderer, of the first one, and of its PNG file",
    .columns = columns,
    .n_keys = 4,
    .measured = "median_ms",
    .run = run,
};
