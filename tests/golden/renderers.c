/* Draws states of scenes with two renderers and holds the pictures to the gate of golden
 * images: each renderer checks the other. The one without OpenGL must also draw the same bytes
 * with one thread, two and three.
 *
 *   renderers osmesa SIZE LOOKS SCENE=FRAME...
 *
 * SIZE as 160x120, LOOKS names with commas between. A scene that
 * cannot be drawn with look goals is passed over. Prints a row a picture, and fails if any is
 * beyond the gate. */
#include "base/pool.h"
#include "session/frame_picture.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "shared/image_diff.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failed;

static void draw(struct cs_session *session, enum cs_renderer_kind kind, struct cs_image *image,
                 struct cs_error *error) {
    struct cs_picture picture;
    image->width = (uint32_t)session->scene->render->size[0];
    image->height = (uint32_t)session->scene->render->size[1];
    image->rgb = malloc(3 * (size_t)image->width * image->height);
    if (!image->rgb)
        abort();
    if (cs_picture_open(&picture, &session->system, kind, false, false, error))
        return;
    cs_picture_begin(&picture, &session->run, image);
    cs_picture_end(&picture, error);
    cs_picture_close(&picture);
}

static bool same_with_threads(struct cs_session *session, const struct cs_image *expected,
                              struct cs_error *error) {
    bool same = true;
    for (uint32_t threads = 2; threads <= 3 && !error->status; threads++) {
        struct cs_image image = {0};
        cs_pool_start(threads, error);
        draw(session, CS_RENDERER_CPU, &image, error);
        cs_pool_stop();
        same = same && !memcmp(image.rgb, expected->rgb,
                               3 * (size_t)expected->width * expected->height);
        free(image.rgb);
    }
    return same;
}

static void compare(struct cs_session *session, enum cs_renderer_kind kind, const char *name,
                    struct cs_error *error) {
    struct cs_image one = {0}, other = {0};
    draw(session, CS_RENDERER_CPU, &one, error);
    if (!error->status) {
        const bool same = same_with_threads(session, &one, error);
        draw(session, kind, &other, error);
        const struct cs_image_difference d =
            error->status ? (struct cs_image_difference){0} : cs_image_compare(&one, &other);
        const bool passes = cs_image_difference_passes(&d);
        if (!error->status)
            printf("%-8s %-44s RMSE %.3f, %.4f %% off by more than 2, largest %d%s\n",
                   passes ? "ok" : "FAILS", name, d.rmse, 100 * d.share, d.largest,
                   same ? "" : "; THREADS CHANGE IT");
        failed += !passes || !same;
        free(other.rgb);
    }
    free(one.rgb);
}

static void try(enum cs_renderer_kind kind, const char *size, const char *look,
                const char *scene, uint32_t frames) {
    struct cs_session session;
    struct cs_error error = {0};
    char name[200];
    const struct cs_override overrides[] = {{"render.size", size}, {"render.look", look}};
    const struct cs_session_settings settings = {
        .scene = scene, .overrides = overrides, .n_overrides = 2, .render = true};
    snprintf(name, sizeof name, "%s %s %u", scene, look, frames);
    if (cs_session_open(&session, &settings, &error)) {
        if (strcmp(look, "goals")) {
            printf("FAILS    %s: %s\n", name, error.message);
            failed++;
        }
        return;
    }
    while (session.run.frame < frames && session.run.outcome == CS_RUNNING)
        if (cs_run_frame(&session.run, &error))
            break;
    if (!error.status)
        compare(&session, kind, name, &error);
    if (error.status) {
        printf("FAILS    %s: %s\n", name, error.message);
        failed++;
    }
    cs_session_close(&session);
}

int main(int argc, char **argv) {
    unsigned width, height;
    char size[40], looks[200];
    if (argc < 5 || sscanf(argv[2], "%ux%u", &width, &height) != 2)
        return 2;
    const enum cs_renderer_kind kind = CS_RENDERER_OSMESA;
    snprintf(size, sizeof size, "[%u,%u]", width, height);
    for (int i = 4; i < argc; i++) {
        char *at = strchr(argv[i], '=');
        const uint32_t frames = at ? (uint32_t)strtoul(at + 1, NULL, 10) : 1;
        if (at)
            *at = '\0';
        snprintf(looks, sizeof looks, "%s", argv[3]);
        for (char *look = strtok(looks, ","); look; look = strtok(NULL, ","))
            try(kind, size, look, argv[i], frames);
    }
    return failed != 0;
}
