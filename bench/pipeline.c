/* A whole run of the program: simulating, drawing and encoding lie side by side where there are
 * processors for it, and the slowest of them is the least that the run can take. */
#include "child.h"
#include "timing.h"

#include <stdio.h>

static const struct shot {
    const char *scene, *size;
    uint32_t frames;
} shots[] = {{"sphere_rest", "640x480", 120},
             {"hang", "640x480", 120},
             {"sphere_rest", "1920x1080", 40}};
enum { FRAMES_QUICK = 12, RUNS = 3, RUNS_QUICK = 1 };
enum { SIMULATE, DRAW, ENCODE, WALL, PROCESSOR, STAGES };
static const char *const stage_names[STAGES] = {"simulate", "draw", "encode", "whole run",
                                                "processor"};

static enum cs_status sample(const struct bench_settings *settings, const struct shot *shot,
                             uint32_t frames, double seconds[STAGES], struct cs_error *error) {
    struct bench_run run;
    struct cs_text folder = {0};
    unsigned width = 0, height = 0;
    char number[16], size[40], scene[64];
    sscanf(shot->size, "%ux%u", &width, &height);
    snprintf(size, sizeof size, "render.size=[%u,%u]", width, height);
    snprintf(scene, sizeof scene, "scenes/%s.json", shot->scene);
    snprintf(number, sizeof number, "%u", frames);
    cs_text_add(&folder, "%s/frames", settings->scratch);
    const char *const arguments[] = {"--frames",           number,  "--overwrite", "--out",
                                     cs_text_get(&folder), "--set", size,          NULL};
    if (!bench_program_run(&run, settings, scene, arguments, error)) {
        /* stages by the program's own clocks; the whole as the system saw it */
        seconds[SIMULATE] = bench_run_number(&run, "seconds", "method");
        seconds[DRAW] = bench_run_number(&run, "seconds", "draw");
        seconds[ENCODE] = bench_run_number(&run, "seconds", "encode");
        seconds[WALL] = run.usage.wall;
        seconds[PROCESSOR] = run.usage.cpu;
        bench_run_finish(&run);
    }
    cs_text_finish(&folder);
    return error->status;
}

static enum cs_status measure(const struct bench_settings *settings, const struct shot *shot,
                              struct bench_table *table, struct cs_error *error) {
    const uint32_t frames = settings->quick ? FRAMES_QUICK : shot->frames;
    const uint32_t runs = settings->quick ? RUNS_QUICK : RUNS;
    double samples[STAGES][RUNS], seconds[STAGES] = {0}, slowest = 0;
    for (uint32_t k = 0; k < runs && !error->status; k++) {
        bench_report("%s, %s, %u frames, run %u of %u", shot->scene, shot->size, frames, k + 1,
                     runs);
        if (sample(settings, shot, frames, seconds, error))
            return error->status;
        for (int s = 0; s < STAGES; s++)
            samples[s][k] = seconds[s];
    }
    for (int s = 0; s < STAGES; s++) {
        const struct bench_spread time = bench_spread_of(samples[s], runs);
        /* stages come first: the whole run is then held against the slowest of them */
        slowest = s < WALL && time.median > slowest ? time.median : slowest;
        bench_table_add(table, "%s,%s,%s,%u,%.3f,%.3f,%.3f,%.2f,%.2f", shot->scene, shot->size,
                        stage_names[s], frames, time.median, time.min, time.max,
                        1e3 * time.median / frames, time.median / slowest);
    }
    return error->status;
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    for (size_t k = 0; k < sizeof shots / sizeof *shots && !error->status; k++)
        measure(settings, shots + k, table, error);
    return error->status;
}

static const char *const columns[] = {"scene", "size",  "stage",      "frames",     "median_s",
                                      "min_s", "max_s", "ms_a_frame", "to_slowest", NULL};
const struct bench_section bench_pipeline = {
    .name = "pipeline",
    .summary = "s of runs with pictures, by stage and as a whole",
    .columns = columns,
    .n_keys = 4,
    .measured = "median_s",
    .run = run,
};
