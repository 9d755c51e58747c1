/* overhead.c - how much of a measured run is the harness: calls through the host's table, the
 * watch for a blow-up, and the clocks, against the force of the springs itself. Prints shares
 * in percent. */
#include "base/clock.h"
#include "session/recorded_run.h"

#include <stdio.h>
#include <stdlib.h>

enum { CALLS = 4000, ROUNDS = 21 };

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct bench {
    struct cs_session *session;
    double *f;
};

static void call_force(const struct bench *bench) {
    const struct cs_run *run = &bench->session->run;
    cs_system_elastic_force(run->system, run->x, run->v, bench->f);
}

static void call_table(const struct bench *bench) {
    const struct cs_run *run = &bench->session->run;
    const struct cs_host *host = cs_run_calls(run);
    host->force(host->ctx, 0, run->x, run->v, CS_PART_SPRINGS | CS_PART_ELASTIC, bench->f);
}

static void call_commit(const struct bench *bench) {
    const struct cs_run *run = &bench->session->run;
    bool changed;
    const struct cs_host *host = cs_run_calls(run);
    host->commit(host->ctx, 0, 1e-4, run->x, run->v, &changed);
}

/* s of one call, median of rounds */
static double measure(const struct bench *bench, void (*call)(const struct bench *)) {
    double seconds[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        const double begin = cs_clock_cpu();
        for (int k = 0; k < CALLS; k++)
            call(bench);
        seconds[round] = (cs_clock_cpu() - begin) / CALLS;
    }
    qsort(seconds, ROUNDS, sizeof *seconds, by_size);
    return seconds[ROUNDS / 2];
}

int main(int argc, char **argv) {
    struct cs_error error = {0};
    struct cs_recorded_run recording;
    const struct cs_recorded_run_settings settings = {
        .session = {.scene = argc > 1 ? argv[1] : "scenes/drum.json"}, .frames = 1};
    struct cs_session *session = &recording.session;
    if (!cs_recorded_run_open(&recording, &settings, "velocity-verlet", &error))
        session->settings.run.budget = 1e6;
    if (error.status || cs_session_begin(session, NULL, &error)) {
        fprintf(stderr, "%s\n", error.message);
        return EXIT_FAILURE;
    }
    const struct bench bench = {session,
                                calloc(3 * (size_t)session->system.view.n, sizeof(double))};
    const double force = measure(&bench, call_force), table = measure(&bench, call_table),
                 commit = measure(&bench, call_commit);
    const double begin = cs_clock_cpu();
    for (int k = 0; k < CALLS; k++)
        cs_clock_cpu();
    const double clock = (cs_clock_cpu() - begin) / CALLS;
    printf("force %.3g us; through the table %+.2f %%; commit with its watch %.2f %%; "
           "two clocks a run of 240 steps %.3f %%\n",
           1e6 * force, 100 * (table / force - 1), 100 * commit / force,
           100 * 2 * clock / (240 * force));
    free(bench.f);
    cs_recorded_run_close(&recording);
    return EXIT_SUCCESS;
}
