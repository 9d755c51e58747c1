/* The benchmark: runs sections by name, prints their tables, and writes them as CSV. */
#include "bench.h"

#include "base/clock.h"
#include "base/pool.h"
#include "session/provenance_write.h"

#include <getopt.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const struct bench_section *const sections[] = {
    &bench_limits, &bench_kernels, &bench_steps,    &bench_plain,    &bench_thesis,
    &bench_pairs,  &bench_contact, &bench_pictures, &bench_pipeline, &bench_bdf};
enum { SECTIONS = sizeof sections / sizeof *sections };

static const char *running = "bench"; /* the section, for bench_tell */

void bench_report(const char *format, ...) {
    va_list args;
    va_start(args, format);
    fprintf(stderr, "%s: ", running);
    vfprintf(stderr, format, args);
    fprintf(stderr, "\n");
    va_end(args);
}

struct asked {
    struct bench_settings settings;
    const char *folder; /* for CSV, NULL: none */
    bool sections[SECTIONS];
};

static void print_help(void) {
    printf("usage: bench [SECTION ...] [options]\n\n"
           "measures clothsim; without a section all of them\n\n");
    for (int s = 0; s < SECTIONS; s++)
        printf("  %-12s%s\n", sections[s]->name, sections[s]->summary);
    printf("\n  --csv FOLDER  write each table as FOLDER/SECTION.csv too\n"
           "  --threads N   that the model may use (default: 1)\n"
           "  --quick       small sizes and few samples: all of it within seconds\n"
           "  --help        this text\n");
}

static enum cs_status choose(struct asked *asked, const char *name, struct cs_error *error) {
    for (int s = 0; s < SECTIONS; s++)
        if (!strcmp(sections[s]->name, name)) {
            asked->sections[s] = true;
            return CS_OK;
        }
    return cs_fail(error, CS_ERR_USAGE, "no section \"%s\" (see: bench --help)", name);
}

static enum cs_status read_threads(struct asked *asked, const char *text,
                                   struct cs_error *error) {
    double threads;
    if (!cs_parse_real(text, &threads) || !(threads >= 1 && threads <= CS_POOL_THREADS_MAX) ||
        threads != (uint32_t)threads)
        return cs_fail(error, CS_ERR_USAGE, "--threads: found \"%s\", expected 1 to %d", text,
                       CS_POOL_THREADS_MAX);
    asked->settings.threads = (uint32_t)threads;
    return CS_OK;
}

static enum cs_status read_arguments(struct asked *asked, int argc, char **argv,
                                     struct cs_error *error) {
    static const struct option options[] = {{"csv", required_argument, NULL, 'c'},
                                            {"threads", required_argument, NULL, 't'},
                                            {"quick", no_argument, NULL, 'q'},
                                            {"help", no_argument, NULL, 'h'},
                                            {0}};
    *asked = (struct asked){.settings = {.threads = 1}};
    for (int found; (found = getopt_long(argc, argv, "", options, NULL)) >= 0;) {
        if (found == 'h') {
            print_help();
            exit(EXIT_SUCCESS);
        }
        if (found == '?')
            return cs_fail(error, CS_ERR_USAGE, "see: bench --help");
        if (found == 't' && read_threads(asked, optarg, error))
            return error->status;
        asked->folder = found == 'c' ? optarg : asked->folder;
        asked->settings.quick |= found == 'q';
    }
    for (int k = optind; k < argc && !error->status; k++)
        choose(asked, argv[k], error);
    /* no section was named: all of them */
    for (int s = 0; s < SECTIONS && optind == argc; s++)
        asked->sections[s] = true;
    return error->status;
}

static void print_head(const struct bench_settings *settings) {
    struct cs_machine machine;
    cs_machine_detect(&machine);
    printf("%s, %ld processors, load %.2f; %s, %s; %u thread%s%s\n\n",
           *machine.processor ? machine.processor : "unknown processor", machine.processors,
           machine.load, machine.compiler, machine.flags, settings->threads,
           settings->threads > 1 ? "s" : "",
           settings->quick ? "; quick, so not to be trusted" : "");
    fflush(stdout);
}

/* Also of a section that failed: its first rows are there. */
static enum cs_status run_section(const struct asked *asked,
                                  const struct bench_section *section, struct cs_error *error) {
    struct bench_table table = {.section = section};
    struct cs_text text = {0};
    running = section->name;
    const double begin = cs_clock_wall();
    section->run(&asked->settings, &table, error);
    bench_report("%.1f s", cs_clock_wall() - begin);
    bench_table_print(&table, &text);
    printf("%s", cs_text_get(&text));
    fflush(stdout);
    if (asked->folder)
        bench_table_write(&table, &asked->settings, asked->folder, error);
    cs_text_finish(&text);
    bench_table_finish(&table);
    return error->status;
}

static char scratch[] = "/tmp/clothsim-bench-XXXXXX";

/* Safe in a signal handler too. */
static void remove_scratch(void) {
    const pid_t child = fork();
    if (child == 0) {
        execl("/bin/rm", "rm", "-rf", scratch, (char *)NULL);
        _exit(127);
    }
    if (child > 0)
        waitpid(child, NULL, 0);
}

static void interrupted(int signal) {
    (void)signal;
    remove_scratch();
    _exit(cs_status_exit_code(CS_ERR_INTERRUPT));
}

int main(int argc, char **argv) {
    struct asked asked;
    struct cs_error failure = {0};
    if (!read_arguments(&asked, argc, argv, &failure) &&
        !cs_pool_start(asked.settings.threads, &failure) && !mkdtemp(scratch))
        cs_fail(&failure, CS_ERR_FILE, "cannot make a folder in /tmp");
    if (failure.status) {
        fprintf(stderr, "bench: %s\n", failure.message);
        return cs_status_exit_code(failure.status);
    }
    asked.settings.scratch = scratch;
    signal(SIGINT, interrupted);
    signal(SIGTERM, interrupted);
    print_head(&asked.settings);
    /* one that fails does not keep the others from running */
    for (int s = 0; s < SECTIONS; s++) {
        struct cs_error error = {0};
        if (asked.sections[s] && run_section(&asked, sections[s], &error)) {
            fprintf(stderr, "bench: %s: %s\n", sections[s]->name, error.message);
            failure.status = error.status;
        }
    }
    remove_scratch();
    cs_pool_stop();
    return cs_status_exit_code(failure.status);
}
