/* Runs whose time is that of contact: a heap, a fold, sheets in layers, a knot, a fall. */
#include "child.h"
#include "timing.h"

#include <stdio.h>

static const struct fall {
    const char *scene, *set; /* NULL: as it is shipped */
    uint32_t frames;
} falls[] = {{"jelly_drop", NULL, 40}, {"sphere_rest", "contact.law=force", 40},
             {"fold", NULL, 40},       {"layers", NULL, 30},
             {"bear_heap", NULL, 34},  {"reef_knot", NULL, 45},
             {"trampoline", NULL, 40}};
enum { FRAMES_QUICK = 4, RUNS = 5, RUNS_QUICK = 1 };

static enum cs_status sample(const struct bench_settings *settings, const struct fall *fall,
                             uint32_t frames, double *seconds, double *steps,
                             struct cs_error *error) {
    struct bench_run run;
    struct cs_text folder = {0};
    char number[16], scene[64];
    snprintf(scene, sizeof scene, "scenes/%s.json", fall->scene);
    snprintf(number, sizeof number, "%u", frames);
    cs_text_add(&folder, "%s/contact", settings->scratch);
    const char *const arguments[] = {"--frames",
                                     number,
                                     "--overwrite",
                                     "--no-render",
                                     "--out",
                                     cs_text_get(&folder),
                                     fall->set ? "--set" : NULL,
                                     fall->set,
                                     NULL};
    if (!bench_program_run(&run, settings, scene, arguments, error)) {
        *seconds = run.usage.cpu;
        *steps = bench_run_number(&run, "counts", "steps");
        bench_run_finish(&run);
    }
    cs_text_finish(&folder);
    return error->status;
}

/* Scenes take turns, so that a clock that wanders does so for all of them. */
static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    enum { FALLS = sizeof falls / sizeof *falls };
    const uint32_t runs = settings->quick ? RUNS_QUICK : RUNS;
    double seconds[FALLS][RUNS], steps[FALLS];
    for (uint32_t k = 0; k < runs && !error->status; k++) {
        bench_report("%d scenes, run %u of %u", FALLS, k + 1, runs);
        for (uint32_t s = 0; s < FALLS && !error->status; s++)
            sample(settings, falls + s, settings->quick ? FRAMES_QUICK : falls[s].frames,
                   &seconds[s][k], &steps[s], error);
    }
    for (uint32_t s = 0; s < FALLS && !error->status; s++) {
        const uint32_t frames = settings->quick ? FRAMES_QUICK : falls[s].frames;
        const struct bench_spread time = bench_spread_of(seconds[s], runs);
        bench_table_add(table, "%s,%s,%u,%.0f,%.3f,%.3f,%.3f,%.3f", falls[s].scene,
                        falls[s].set ? falls[s].set : "", frames, steps[s], time.median,
                        time.min, time.max, 1e3 * time.median / steps[s]);
    }
    return error->status;
}

static const char *const columns[] = {"scene", "set",   "frames",    "steps", "median_s",
                                      "min_s", "max_s", "ms_a_step", NULL};
const struct bench_section bench_contact = {
    .name = "contact",
    .summary = "s of the processor for runs with contact, start and end included",
    .columns = columns,
    .n_keys = 3,
    .measured = "median_s",
    .run = run,
};
