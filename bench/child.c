/* Runs other programs to their end, and collects their output, times and memory. */
#include "child.h"

#include "base/clock.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ARGUMENTS_MAX = 32 };

static _Noreturn void become(const char *const *arguments, const int out[2]) {
    dup2(out[1], STDOUT_FILENO);
    close(out[0]);
    close(out[1]);
    execvp(arguments[0], (char *const *)arguments);
    _exit(127);
}

static void collect(int descriptor, struct cs_text *output) {
    char bytes[4096];
    for (ssize_t n; (n = read(descriptor, bytes, sizeof bytes)) != 0;) {
        if (n < 0 && errno != EINTR)
            break;
        if (n > 0)
            cs_text_add(output, "%.*s", (int)n, bytes);
    }
    close(descriptor);
}

static double seconds(struct timeval time) {
    return (double)time.tv_sec + 1e-6 * (double)time.tv_usec;
}

enum cs_status bench_child_run(const char *const *arguments, struct cs_text *output,
                               struct bench_usage *usage, struct cs_error *error) {
    struct rusage used = {0};
    int out[2], state = 0;
    const double begin = cs_clock_wall();
    if (pipe(out))
        return cs_fail(error, CS_ERR_MODULE, "cannot make a pipe: %s", strerror(errno));
    const pid_t child = fork();
    if (child == 0)
        become(arguments, out);
    close(out[1]);
    /* before waiting: a child whose pipe is full would wait for a reader for ever */
    collect(out[0], output);
    if (child < 0 || wait4(child, &state, 0, &used) < 0)
        return cs_fail(error, CS_ERR_MODULE, "cannot run %s: %s", arguments[0],
                       strerror(errno));
    *usage = (struct bench_usage){.wall = cs_clock_wall() - begin,
                                  .cpu = seconds(used.ru_utime) + seconds(used.ru_stime),
                                  .peak_mib = (double)used.ru_maxrss / 1024};
    if (!WIFEXITED(state) || WEXITSTATUS(state))
        return cs_fail(error, CS_ERR_MODULE, "%s %s failed (%s %d)", arguments[0], arguments[1],
                       WIFEXITED(state) ? "exit code" : "signal",
                       WIFEXITED(state) ? WEXITSTATUS(state) : WTERMSIG(state));
    return output->failed ? cs_fail(error, CS_ERR_MEMORY, "out of memory for a report") : CS_OK;
}

enum cs_status bench_program_run(struct bench_run *run, const struct bench_settings *settings,
                                 const char *scene, const char *const *arguments,
                                 struct cs_error *error) {
    struct cs_text path = {0}, output = {0};
    char threads[16];
    snprintf(threads, sizeof threads, "%u", settings->threads);
    /* a bare name is a scene that was written here, any other one is of the source tree */
    cs_text_add(&path, "%s/%s", strchr(scene, '/') ? BENCH_ROOT : settings->scratch, scene);
    const char *all[ARGUMENTS_MAX] = {BENCH_PROGRAM, "run",       cs_text_get(&path),
                                      "--json",      "-",         "--timing",
                                      "--quiet",     "--threads", threads};
    uint32_t n = 9;
    for (; *arguments; arguments++) {
        CS_ASSERT(n + 1 < ARGUMENTS_MAX);
        all[n++] = *arguments;
    }
    *run = (struct bench_run){0};
    if (path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a path");
    if (!error->status && !bench_child_run(all, &output, &run->usage, error) &&
        !(run->report = cJSON_Parse(cs_text_get(&output))))
        cs_fail(error, CS_ERR_MODULE, "%s: the report of a run is no JSON", BENCH_PROGRAM);
    cs_text_finish(&path);
    cs_text_finish(&output);
    return error->status;
}

double bench_run_number(const struct bench_run *run, const char *group, const char *name) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(run->report, group);
    item = cJSON_GetObjectItemCaseSensitive(item, name);
    return cJSON_IsNumber(item) ? item->valuedouble : 0;
}

void bench_run_finish(struct bench_run *run) {
    cJSON_Delete(run->report);
    *run = (struct bench_run){0};
}
