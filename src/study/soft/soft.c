/* Measures the cost of spring networks and shape matching over the size of a soft body. */
#include "study/soft/soft.h"

#include "base/clock.h"
#include "sim/install_paths.h"
#include "study/follow.h"
#include "study/frame_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const cs_soft_names[] = {"springs-small", "springs-large", "surface", "network",
                                     "implicit",      "matched",       NULL};

/* Details of the shape "limbs": 1586 and 6432 vertices, near the 1598 and 6308 of the thesis.
 */
enum { SMALL = 31, LARGE = 62, FRAMES_MAX = 60, PICTURES = 5 };
static const uint32_t densities[] = {0, 1, 2, 4, 8, 16, 32};
static const uint32_t details[] = {12, 16, 22, 31, 44, 62, 88, 124};

static const char *const methods[CS_SOFT_SERIES] = {[CS_SOFT_SMALL] = "symplectic-euler",
                                                    [CS_SOFT_LARGE] = "symplectic-euler",
                                                    [CS_SOFT_SURFACE] = "symplectic-euler",
                                                    [CS_SOFT_NETWORK] = "symplectic-euler",
                                                    /* longer than a frame: one step each */
                                                    [CS_SOFT_IMPLICIT] =
                                                        "implicit-linearised:dt=1",
                                                    [CS_SOFT_MATCHED] = "shape-matching:dt=1"};

enum {
    DENSITIES = sizeof densities / sizeof *densities,
    DETAILS = sizeof details / sizeof *details,
    ROWS = 2 * DENSITIES + 4 * DETAILS
};
_Static_assert((int)ROWS <= (int)CS_SOFT_ROWS_MAX, "room for every row");

double cs_soft_rate_one_step(const struct cs_soft_row *row) {
    return 1 / (row->step_seconds + row->draw_seconds);
}

double cs_soft_rate(const struct cs_soft_row *row) {
    return 1 / (row->steps * row->step_seconds + row->draw_seconds);
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of n samples, which are sorted in place. */
static double median(double *values, uint32_t n) {
    qsort(values, n, sizeof *values, ascending);
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/* Times frames until the time is used up; the first frame warms up and does not count. The cost
 * of an implicit step depends on the motion: that series runs all FRAMES_MAX frames, to cover
 * fall, impact and rest. */
static enum cs_status time_steps(const struct cs_soft *soft, struct cs_run *run,
                                 struct cs_soft_row *row, struct cs_error *error) {
    double samples[FRAMES_MAX];
    const uint32_t least = row->series == CS_SOFT_IMPLICIT ? FRAMES_MAX : 1;
    struct cs_follow follow = {.run = run, .last = 1};
    uint32_t n = 0;
    cs_follow_next(&follow, error);
    double cpu = follow.cpu;
    const uint64_t warm = run->counts.steps;
    uint64_t steps = warm;
    follow = (struct cs_follow){.run = run, .last = 1 + FRAMES_MAX, .every = 1, .cpu = cpu};
    while (!(n >= least && cpu > soft->seconds) && cs_follow_next(&follow, error)) {
        samples[n++] = (follow.cpu - cpu) / (double)(run->counts.steps - steps);
        steps = run->counts.steps;
        cpu = follow.cpu;
    }
    row->outcome = run->outcome;
    if (n) {
        row->steps = (double)(steps - warm) / n;
        row->step_seconds = median(samples, n);
    }
    return error->status;
}

/* Median wall time of PICTURES pictures of the last state, after one to warm up. */
static enum cs_status time_pictures(struct cs_session *session, struct cs_soft_row *row,
                                    struct cs_error *error) {
    struct cs_picture picture = {0};
    struct cs_image image = {(uint32_t)session->scene.render.size[0],
                             (uint32_t)session->scene.render.size[1], NULL, NULL};
    double samples[PICTURES];
    image.rgb = malloc(3 * (size_t)image.width * image.height);
    if (!image.rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
    if (!cs_picture_open(&picture, &session->system, CS_RENDERER_AUTO, false, false, error))
        /* the first picture warms up the renderer and does not count */
        for (int k = -1; k < PICTURES && !error->status; k++) {
            const double start = cs_clock_wall();
            cs_picture_begin(&picture, &session->run, &image);
            cs_picture_end(&picture, error);
            if (k >= 0)
                samples[k] = cs_clock_wall() - start;
        }
    cs_picture_close(&picture);
    free(image.rgb);
    if (!error->status)
        row->draw_seconds = median(samples, PICTURES);
    return error->status;
}

/* Runs the scene with the body of the row. Overrides of the user come last and win. */
static enum cs_status run_row(const struct cs_soft *soft, struct cs_soft_row *row,
                              uint32_t detail, uint32_t density, struct cs_error *error) {
    char number[2][16];
    struct cs_override changes[64] = {{"render.look", "lit"},
                                      {"bodies[0].mesh.detail", number[0]},
                                      {"bodies[0].network.springs", number[1]}};
    uint32_t n = density == UINT32_MAX ? 2 : 3;
    struct cs_session_settings settings = soft->session;
    struct cs_session session = {0};
    snprintf(number[0], sizeof number[0], "%u", detail);
    snprintf(number[1], sizeof number[1], "%u", density);
    if (row->series == CS_SOFT_MATCHED) {
        /* a network wants its springs, of which none are left */
        changes[n++] = (struct cs_override){"bodies[0].shape_matching.springs", "true"};
        changes[n++] = (struct cs_override){"bodies[0].springs.stretch", "0"};
        changes[n++] = (struct cs_override){"bodies[0].springs.bend", "0"};
    }
    if (settings.n_overrides > sizeof changes / sizeof *changes - n)
        return cs_fail(error, CS_ERR_USAGE, "--set: more than %zu changes",
                       sizeof changes / sizeof *changes - n);
    for (uint32_t k = 0; k < settings.n_overrides; k++)
        changes[n++] = settings.overrides[k];
    settings.overrides = changes;
    settings.n_overrides = n;
    settings.integrator = methods[row->series];
    settings.render = soft->draw;
    if (cs_session_open(&session, &settings, error))
        return error->status;
    row->vertices = session.system.bodies[0].count;
    row->springs = session.system.springs.n;
    if (!time_steps(soft, &session.run, row, error) && soft->draw &&
        row->outcome != CS_INTERRUPTED)
        time_pictures(&session, row, error);
    cs_session_close(&session);
    return error->status;
}

/* Measures one row and appends it. */
static enum cs_status add_row(struct cs_soft *soft, enum cs_soft_series series, uint32_t detail,
                              uint32_t density, struct cs_error *error) {
    struct cs_soft_row *row = soft->rows + soft->n;
    *row = (struct cs_soft_row){.series = series};
    if (run_row(soft, row, detail, density, error))
        return error->status;
    if (row->outcome == CS_INTERRUPTED)
        return cs_fail(error, CS_ERR_INTERRUPT, "interrupted after %u of %u bodies", soft->n,
                       ROWS);
    soft->n++;
    if (soft->progress)
        soft->progress(soft->ctx, soft->n, ROWS);
    return CS_OK;
}

enum cs_status cs_soft_check(const struct cs_soft *soft, struct cs_error *error) {
    struct cs_scene scene;
    char installed[CS_DATA_PATH_MAX];
    if (cs_scene_read(&scene, cs_data_find(soft->session.scene, installed, sizeof installed),
                      soft->session.overrides, soft->session.n_overrides, error))
        return error->status;
    const struct cs_body *body = cs_scene_bodies(&scene);
    if (!body->mesh.present || body->mesh.shape != CS_MESH_LIMBS || !body->network.present)
        cs_fail(error, CS_ERR_SCENE,
                "%s: bodies[0]: expected a mesh of the shape \"limbs\" with a network",
                soft->session.scene);
    cs_scene_finish(&scene);
    return error->status;
}

enum cs_status cs_soft_run(struct cs_soft *soft, struct cs_error *error) {
    soft->n = 0;
    for (uint32_t k = 0; k < DENSITIES && !error->status; k++)
        add_row(soft, CS_SOFT_SMALL, SMALL, densities[k], error);
    for (uint32_t k = 0; k < DENSITIES && !error->status; k++)
        add_row(soft, CS_SOFT_LARGE, LARGE, densities[k], error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        add_row(soft, CS_SOFT_SURFACE, details[k], 0, error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        add_row(soft, CS_SOFT_NETWORK, details[k], UINT32_MAX, error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        add_row(soft, CS_SOFT_IMPLICIT, details[k], UINT32_MAX, error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        add_row(soft, CS_SOFT_MATCHED, details[k], 0, error);
    return error->status;
}

double cs_soft_growth(const struct cs_soft *soft, enum cs_soft_series series) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (uint32_t k = 0; k < soft->n; k++) {
        const struct cs_soft_row *row = soft->rows + k;
        if (row->series != series || !(row->step_seconds > 0))
            continue;
        const double u = log(series == CS_SOFT_MATCHED ? row->vertices : row->springs);
        const double w = log(row->step_seconds);
        n++, x += u, y += w, xx += u * u, xy += u * w;
    }
    const double spread = n * xx - x * x;
    return spread > 1e-12 * n * xx ? (n * xy - x * y) / spread : (double)NAN;
}
