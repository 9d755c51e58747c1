/* Stages of a frame beside those of the cloth thesis, table 6.1.
 *
 * The thesis: m = 1, springs of 75, 22 and 8 N/m, drag 0.25, its shortcut of a block a
 * particle, eight threads of an AMD Ryzen 9 7950X, a display of 165 Hz. It does not say how
 * many steps a frame takes, so one and ten (as in its sec. 5.2) are measured, and the whole
 * linear system too. */
#include "timing.h"

#include "base/file.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>

/* columns of the table, in ms a frame; "integration" is what no other column holds */
enum { TOTAL, FORCES, INTEGRATION, CONTACT, LIMIT, NORMALS, STAGES };
static const struct {
    uint32_t r;
    double ms[STAGES];
} published[] = {
    {8, {0.215, 0.094, 0.102, 0.003, 0.010, 0.006}},
    {16, {0.422, 0.202, 0.148, 0.008, 0.038, 0.025}},
    {32, {1.014, 0.477, 0.268, 0.026, 0.157, 0.086}},
    {64, {2.939, 1.169, 0.691, 0.109, 0.636, 0.333}},
};
enum { SIZES = sizeof published / sizeof *published };

static const struct {
    const char *method;
    uint32_t steps; /* a frame */
} methods[] = {{"implicit-block", 1}, {"implicit-block", 10}, {"implicit-linearised", 1}};
enum { METHODS = sizeof methods / sizeof *methods, FPS = 165 };

/* frames of a replay: 0.36 s of motion */
enum { FRAMES = 60, FRAMES_QUICK = 2 };

static const char scene_format[] =
    "{\"bodies\": [{\"cloth\": {\"grid\": [%u, %u], \"start\": \"flat\",\n"
    "  \"place\": {\"translate\": [0, 0.62, 0]}},\n"
    " \"mass\": {\"particle\": 1},\n"
    " \"springs\": {\"stretch\": 75, \"shear\": 22, \"bend\": 8, \"damping\": 0.2,\n"
    "  \"damping_model\": \"relative\"},\n"
    " \"pins\": [\"top-left\", \"top-right\"], \"strain_limit\": 1.1}],\n"
    "\"colliders\": [{\"sphere\": {\"centre\": [0.12, 0.22, 0.05], \"radius\": 0.3}},\n"
    " {\"plane\": {\"point\": [-0.25, 0.1, 0.2], \"normal\": [0.45, 1, 0.1]}}],\n"
    "\"forces\": {\"drag\": 0.25, \"wind\": {\"direction\": [0.2, 0, 1], \"strength\": 4}},\n"
    "\"time\": {\"fps\": %d}, \"integrator\": \"implicit-block\"}\n";

static enum cs_status open_scene(struct cs_session *session,
                                 const struct bench_settings *settings, uint32_t r, uint32_t m,
                                 struct cs_error *error) {
    struct cs_text json = {0}, path = {0};
    char method[64];
    cs_text_add(&json, scene_format, r, r, FPS);
    cs_text_add(&path, "%s/thesis.json", settings->scratch);
    snprintf(method, sizeof method, "%s:dt=%.17g", methods[m].method,
             1.0 / (FPS * methods[m].steps));
    const struct cs_session_settings asked = {
        .scene = cs_text_get(&path), .integrator = method, .run = {.timed = true}};
    *session = (struct cs_session){0};
    if (json.failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a scene");
    if (!error->status && !cs_file_write(path.bytes, json.bytes, json.length, error))
        cs_session_open(session, &asked, error);
    cs_text_finish(&json);
    cs_text_finish(&path);
    return error->status;
}

/* the clocks of a run in the thesis's columns, in s; solving is part of the integration */
static void look(const struct cs_run *run, double seconds[STAGES]) {
    const double *stage = run->stage_seconds;
    seconds[TOTAL] = run->advance_seconds;
    seconds[FORCES] = stage[CS_STAGE_FORCE];
    seconds[CONTACT] = stage[CS_STAGE_CONTACT];
    seconds[LIMIT] = stage[CS_STAGE_LIMIT];
    seconds[NORMALS] = stage[CS_STAGE_NORMALS];
    seconds[INTEGRATION] =
        seconds[TOTAL] - seconds[FORCES] - seconds[CONTACT] - seconds[LIMIT] - seconds[NORMALS];
}

/* Clocks of the run's frames, the very first left out, and the least of each over all replays:
 * every replay does the same work, and these are wall times, so the least is the truest. */
static enum cs_status replay(const struct bench_settings *settings, uint32_t size, uint32_t m,
                             double least[FRAMES][STAGES], double *total,
                             struct cs_error *error) {
    const uint32_t frames = settings->quick ? FRAMES_QUICK : FRAMES;
    double before[STAGES], after[STAGES];
    struct cs_session session;
    if (open_scene(&session, settings, published[size].r, m, error))
        return error->status;
    struct cs_run *run = &session.run;
    *total = 0;
    /* the first frame warms up and is not counted */
    cs_run_frame(run, error);
    for (uint32_t k = 0; k < frames && !error->status; k++) {
        look(run, before);
        if (!cs_run_frame(run, error) && run->outcome != CS_RUNNING)
            cs_fail(error, CS_ERR_MODULE, "%s: %s", run->integrator->name,
                    cs_outcome_text(run->outcome));
        look(run, after);
        for (int s = 0; s < STAGES; s++)
            least[k][s] = fmin(least[k][s], after[s] - before[s]);
        *total += 1e3 * (after[TOTAL] - before[TOTAL]) / frames;
    }
    cs_session_close(&session);
    return error->status;
}

static void add_row(struct bench_table *table, const char *method, uint32_t steps,
                    uint32_t size, const double ms[STAGES], const struct bench_spread *whole) {
    bench_table_add(table, "%s,%u,%u,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.2f", method,
                    steps, published[size].r, ms[TOTAL], whole->median, whole->max, ms[FORCES],
                    ms[INTEGRATION], ms[CONTACT], ms[LIMIT], ms[NORMALS],
                    published[size].ms[TOTAL] / ms[TOTAL]);
}

static enum cs_status measure(const struct bench_settings *settings, uint32_t size, uint32_t m,
                              struct bench_table *table, struct cs_error *error) {
    double totals[BENCH_SAMPLES_MAX], least[FRAMES][STAGES], ms[STAGES] = {0};
    const uint32_t frames = settings->quick ? FRAMES_QUICK : FRAMES;
    const uint32_t n = bench_samples(settings, 1);
    for (int k = 0; k < FRAMES * STAGES; k++)
        least[k / STAGES][k % STAGES] = HUGE_VAL;
    for (uint32_t k = 0; k < n; k++)
        if (replay(settings, size, m, least, totals + k, error))
            return error->status;
    for (uint32_t k = 0; k < frames; k++)
        for (int s = FORCES; s < STAGES; s++) {
            ms[s] += 1e3 * least[k][s] / frames;
            ms[TOTAL] += 1e3 * least[k][s] / frames;
        }
    const struct bench_spread spread = bench_spread_of(totals, n);
    add_row(table, methods[m].method, methods[m].steps, size, ms, &spread);
    return CS_OK;
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    for (uint32_t size = 0; size < SIZES; size++) {
        /* their spread is not published, nor their steps a frame */
        const double whole = published[size].ms[TOTAL];
        const struct bench_spread spread = {whole, whole, whole};
        add_row(table, "thesis; 8 threads", 0, size, published[size].ms, &spread);
    }
    for (uint32_t m = 0; m < METHODS; m++)
        for (uint32_t size = 0; size < SIZES && !error->status; size++) {
            bench_report("%s, %u a frame, r = %u", methods[m].method, methods[m].steps,
                         published[size].r);
            measure(settings, size, m, table, error);
        }
    return error->status;
}

static const char *const columns[] = {"method",     "steps",    "r",          "total_ms",
                                      "median_ms",  "max_ms",   "forces_ms",  "integration_ms",
                                      "contact_ms", "limit_ms", "normals_ms", "times_thesis",
                                      NULL};
const struct bench_section bench_thesis = {
    .name = "thesis",
    .summary = "ms a frame by stage, least of each frame, beside the cloth thesis's table 6.1",
    .columns = columns,
    .n_keys = 3,
    .measured = "total_ms",
    .run = run,
};
