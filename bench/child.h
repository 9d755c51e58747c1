/* child.h - other programs, run to their end: clothsim itself, and Python. */
#ifndef BENCH_CHILD_H
#define BENCH_CHILD_H

#include "bench.h"

struct cJSON;

struct bench_usage {
    double wall, cpu; /* s */
    double peak_mib;  /* largest memory in use at once, in MiB */
};

/* Runs arguments[0] with arguments (closed by NULL) and collects what it prints; its standard
 * error stays ours. A program that cannot be run or does not exit with 0 is CS_ERR_MODULE. */
enum cs_status bench_child_run(const char *const *arguments, struct cs_text *output,
                               struct bench_usage *usage, struct cs_error *error);

/* A run of clothsim and its report. */
struct bench_run {
    struct bench_usage usage;
    struct cJSON *report; /* owned */
};

/* clothsim run SCENE ARGUMENTS with --timing and the settings' threads; a SCENE without a slash
 * lies in the scratch folder. Not to be finished on failure. */
enum cs_status bench_program_run(struct bench_run *run, const struct bench_settings *settings,
                                 const char *scene, const char *const *arguments,
                                 struct cs_error *error);
/* report[group][name], such as "seconds", "draw"; 0 where it is not there */
double bench_run_number(const struct bench_run *run, const char *group, const char *name);
void bench_run_finish(struct bench_run *run);

#endif
