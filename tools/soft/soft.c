/* Measures the cost of spring networks and shape matching over the size of a soft body. */
#include "soft/soft.h"

#include "base/clock.h"
#include "base/install_paths.h"
#include "scene/mesh_keys.h"
#include "session/frame_picture.h"
#include "session/session.h"
#include "study/compare/timing_rounds.h"

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

/* Median of n samples, which are sorted in place. */
static double median(double *samples, uint32_t n) {
    cs_sort(samples, n);
    return cs_quantile(samples, n, 0.5);
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
    struct cs_image image = {(uint32_t)session->scene->render->size[0],
                             (uint32_t)session->scene->render->size[1], NULL, NULL};
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
static enum cs_status append_soft_row(struct cs_soft *soft, enum cs_soft_series series,
                                      uint32_t detail, uint32_t density,
                                      struct cs_error *error) {
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

/* True if the body is a mesh of limbs with a network of springs: its detail can be varied. */
static bool has_limbs(const struct cs_body *body) {
    return body->mesh && body->mesh->shape == CS_MESH_LIMBS && body->network.present;
}

enum cs_status cs_soft_check(const struct cs_soft *soft, struct cs_error *error) {
    struct cs_scene scene;
    char installed[CS_DATA_PATH_MAX];
    if (cs_scene_read(&scene, cs_scene_find(soft->session.scene, installed, sizeof installed),
                      soft->session.overrides, soft->session.n_overrides, error))
        return error->status;
    if (!has_limbs(cs_scene_bodies(&scene)))
        cs_fail(error, CS_ERR_SCENE,
                "%s: bodies[0]: expected a mesh of the shape \"limbs\" with a network",
                soft->session.scene);
    cs_scene_finish(&scene);
    return error->status;
}

enum cs_status cs_soft_run(struct cs_soft *soft, struct cs_error *error) {
    soft->n = 0;
    for (uint32_t k = 0; k < DENSITIES && !error->status; k++)
        append_soft_row(soft, CS_SOFT_SMALL, SMALL, densities[k], error);
    for (uint32_t k = 0; k < DENSITIES && !error->status; k++)
        append_soft_row(soft, CS_SOFT_LARGE, LARGE, densities[k], error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        append_soft_row(soft, CS_SOFT_SURFACE, details[k], 0, error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        append_soft_row(soft, CS_SOFT_NETWORK, details[k], UINT32_MAX, error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        append_soft_row(soft, CS_SOFT_IMPLICIT, details[k], UINT32_MAX, error);
    for (uint32_t k = 0; k < DETAILS && !error->status; k++)
        append_soft_row(soft, CS_SOFT_MATCHED, details[k], 0, error);
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

/* Prints what soft bodies cost as tables with their meaning, as CSV, and as the soft-body
 * thesis's two graphs side by side. */

static const char *const titles[CS_SOFT_SERIES] = {
    [CS_SOFT_SMALL] = "Spring network, smaller body, more and more inner springs",
    [CS_SOFT_LARGE] = "Spring network, larger body, more and more inner springs",
    [CS_SOFT_SURFACE] = "Springs on the surface only, more and more vertices",
    [CS_SOFT_NETWORK] = "Spring network of the scene, more and more vertices",
    [CS_SOFT_IMPLICIT] = "The same by implicit-linearised, one step per frame",
    [CS_SOFT_MATCHED] = "Shape matching, more and more vertices",
};

static void add_head(enum cs_soft_series series, bool drawn, struct cs_text *out) {
    cs_text_add(out, "%s%s\n%9s %9s %12s %12s %12s", series ? "\n" : "", titles[series],
                "vertices", "springs", "step", "steps", "frame");
    cs_text_add(out, drawn ? " %12s %14s %12s\n" : "%.0s %14s %12s\n", "picture", "one step/s",
                "frames/s");
    cs_text_add(out, "%9s %9s %12s %12s %12s", "", "", "[ms]", "a frame", "[ms]");
    cs_text_add(out, drawn ? " %12s\n" : "\n", "[ms]");
}

static void report_add_row(const struct cs_soft_row *row, bool drawn, struct cs_text *out) {
    cs_text_add(out, "%9u %9u", row->vertices, row->springs);
    if (!(row->step_seconds > 0)) {
        cs_text_add(out, "  %s\n", cs_outcome_text(row->outcome));
        return;
    }
    cs_text_add(out, " %12.4f %12.4g %12.4g", 1e3 * row->step_seconds, row->steps,
                1e3 * row->step_seconds * row->steps);
    if (drawn)
        cs_text_add(out, " %12.4g", 1e3 * row->draw_seconds);
    cs_text_add(out, " %14.4g %12.4g%s%s\n", cs_soft_rate_one_step(row), cs_soft_rate(row),
                row->outcome == CS_RUNNING ? "" : "  ",
                row->outcome == CS_RUNNING ? "" : cs_outcome_text(row->outcome));
}

/* The row of a series with that number of vertices, or NULL. */
static const struct cs_soft_row *find_row(const struct cs_soft *soft,
                                          enum cs_soft_series series, uint32_t vertices) {
    for (uint32_t k = 0; k < soft->n; k++)
        if (soft->rows[k].series == series && soft->rows[k].vertices == vertices &&
            soft->rows[k].step_seconds > 0)
            return soft->rows + k;
    return NULL;
}

/* Exponents of the cost per step. */
static void add_growth(const struct cs_soft *soft, struct cs_text *out) {
    for (int s = 0; s < CS_SOFT_SERIES; s++) {
        const double growth = cs_soft_growth(soft, (enum cs_soft_series)s);
        if (isfinite(growth))
            cs_text_add(out, "%-14s time per step grows like %s^%.2f\n", cs_soft_names[s],
                        s == CS_SOFT_MATCHED ? "vertices" : "springs", growth);
    }
}

/* The largest body that all series over vertices have, or NULL. */
static const struct cs_soft_row *largest(const struct cs_soft *soft) {
    for (uint32_t k = soft->n; k-- > 0;) {
        const struct cs_soft_row *row = soft->rows + k;
        bool all = row->series == CS_SOFT_MATCHED;
        for (int s = CS_SOFT_SURFACE; s <= CS_SOFT_MATCHED; s++)
            all &= find_row(soft, (enum cs_soft_series)s, row->vertices) != NULL;
        if (all)
            return row;
    }
    return NULL;
}

/* Cost of shape matching relative to springs. */
static void add_ratios(const struct cs_soft *soft, struct cs_text *out) {
    const struct cs_soft_row *matched = largest(soft);
    if (!matched)
        return;
    const struct cs_soft_row *surface = find_row(soft, CS_SOFT_SURFACE, matched->vertices);
    const struct cs_soft_row *network = find_row(soft, CS_SOFT_NETWORK, matched->vertices);
    const struct cs_soft_row *implicit = find_row(soft, CS_SOFT_IMPLICIT, matched->vertices);
    const double frame = matched->step_seconds * matched->steps;
    cs_text_add(out,
                "%u vertices: one step of shape matching takes %.2f times one with springs on "
                "the surface\nonly, and %.2f times one with the network.\n",
                matched->vertices, matched->step_seconds / surface->step_seconds,
                matched->step_seconds / network->step_seconds);
    cs_text_add(out,
                "A frame of the network takes %.0f explicit steps, %.0f times the time of "
                "shape matching, or\n"
                "one implicit step, %.0f times the time of shape matching.\n",
                network->steps, network->step_seconds * network->steps / frame,
                implicit->step_seconds * implicit->steps / frame);
}

void cs_soft_print(const struct cs_soft *soft, struct cs_text *out) {
    for (uint32_t k = 0; k < soft->n; k++) {
        if (k == 0 || soft->rows[k].series != soft->rows[k - 1].series)
            add_head(soft->rows[k].series, soft->draw, out);
        report_add_row(soft->rows + k, soft->draw, out);
    }
    cs_text_add(out, "\n");
    add_growth(soft, out);
    add_ratios(soft, out);
}

void cs_soft_print_csv(const struct cs_soft *soft, struct cs_text *out) {
    cs_text_add(out, "series,vertices,springs,step_ms,steps,frame_ms,picture_ms,one_step_per_s,"
                     "frames_per_s,outcome\n");
    for (uint32_t k = 0; k < soft->n; k++) {
        const struct cs_soft_row *row = soft->rows + k;
        cs_text_add(out, "%s,%u,%u", cs_soft_names[row->series], row->vertices, row->springs);
        /* a body whose run failed has no times: its fields stay empty */
        const bool timed = row->step_seconds > 0;
        const double values[] = {1e3 * row->step_seconds,
                                 row->steps,
                                 1e3 * row->step_seconds * row->steps,
                                 soft->draw ? 1e3 * row->draw_seconds : HUGE_VAL,
                                 cs_soft_rate_one_step(row),
                                 cs_soft_rate(row)};
        for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
            cs_text_add(out, ",");
            if (timed && isfinite(values[v]))
                cs_text_add(out, "%.6g", values[v]);
        }
        cs_text_add(out, ",%s\n", cs_outcome_text(row->outcome));
    }
}
