/* clothsim bisect: finds the first difference of two runs of a scene. */
#include "base/install_paths.h"
#include "bisect/bisect.h"
#include "cli/commands.h"
#include "cli/line/print.h"

#include <stdio.h>
#include <string.h>

enum { VALUE_COLUMN = 16 };

/* Settings of one side only. */
struct own {
    const char *const *items; /* (n), "KEY=VALUE" */
    uint32_t n;
};

struct options {
    struct own own[2];
    const char *frames, *time, *integrator, *threads; /* of both sides, as run reads them */
    const char *const *sets, *const *plugins;         /* (n_sets), (n_plugins), likewise */
    uint32_t n_sets, n_plugins;
    double tolerance;
    bool quiet;
};
static const struct options defaults = {.tolerance = 0};

static const struct cs_arg rows[] = {
    {"a", 'a', "KEY=VALUE",
     "setting of run A only: program=FILE or an option of run, such as threads=4; may be "
     "repeated",
     CS_ARG_LIST(struct options, own[0].items, own[0].n)},
    {"b", 'b', "KEY=VALUE", "setting of run B only; may be repeated",
     CS_ARG_LIST(struct options, own[1].items, own[1].n)},
    {"frames", 'n', "N", "compare frames 1 to N (default: one second of frames)",
     CS_ARG_INTO(struct options, frames)},
    {"time", 't', "SECONDS", "compare the frames of this simulated time",
     CS_ARG_INTO(struct options, time)},
    {"integrator", 'i', "NAME[:KEY=VALUE,...]",
     "method and options of both runs, instead of the scene's",
     CS_ARG_INTO(struct options, integrator)},
    {"set", 's', "PATH=VALUE", "override a scene value, in both runs; may be repeated",
     CS_ARG_LIST(struct options, sets, n_sets)},
    {"plugin", 'p', "FILE", "load an integrator module in both runs; may be repeated",
     CS_ARG_LIST(struct options, plugins, n_plugins)},
    CS_ARG_PROGRAM(struct options, plugins, n_plugins),
    {"threads", 0, "N", "threads of both runs, 1 to 64", CS_ARG_INTO(struct options, threads)},
    {"tolerance", 0, "NUMBER",
     "maximum difference of two numbers, in their own unit (default: 0, equal bits)",
     CS_ARG_INTO(struct options, tolerance)},
    CS_ARG_QUIET(struct options, quiet),
};

/* A growing command line; its words live as long as the arguments. */
struct line {
    struct cs_args *args;
    const char **words; /* (n), then NULL */
    uint32_t n;
};

static void add_word(struct line *line, const char *word) {
    line->words[line->n++] = word;
}

static enum cs_status add_named(struct line *line, const char *key, size_t length,
                                const char *value, struct cs_error *error) {
    char option[32];
    snprintf(option, sizeof option, "--%.*s", (int)length, key);
    add_word(line, cs_arena_copy_text(&line->args->arena, option, error));
    add_word(line, value);
    return error->status;
}

/* Adds "program=FILE", which replaces the program, or "threads=4" as an option of run. */
static enum cs_status add_own(struct line *line, const char *own, struct cs_error *error) {
    static const char *const keys[] = {"program", "integrator", "set",
                                       "plugin",  "threads",    NULL};
    const size_t length = strcspn(own, "=");
    for (int k = 0; own[length] && keys[k]; k++)
        if (strlen(keys[k]) == length && !strncmp(own, keys[k], length)) {
            if (k > 0)
                return add_named(line, own, length, own + length + 1, error);
            line->words[0] = own + length + 1;
            return CS_OK;
        }
    return cs_fail(error, CS_ERR_USAGE,
                   "found \"%.60s\", expected program=, integrator=, set=, plugin= or threads= "
                   "and a value",
                   own);
}

/* True if one side has its own value for the option. */
static bool has_own(const struct own *own, const char *key) {
    const size_t length = strlen(key);
    for (uint32_t k = 0; k < own->n; k++)
        if (!strncmp(own->items[k], key, length) && own->items[k][length] == '=')
            return true;
    return false;
}

static void add_each(struct line *line, const char *name, const char *const *values, uint32_t n,
                     struct cs_error *error) {
    for (uint32_t k = 0; k < n; k++)
        add_named(line, name, strlen(name), values[k], error);
}

/* Adds the common options; a method or thread count of one side replaces the common one. */
static void add_common(struct line *line, const struct own *own, struct cs_error *error) {
    const struct options *both = line->args->options;
    const bool method = both->integrator && !has_own(own, "integrator");
    const bool threads = both->threads && !has_own(own, "threads");
    add_each(line, "frames", &both->frames, both->frames != NULL, error);
    add_each(line, "time", &both->time, both->time != NULL, error);
    add_each(line, "integrator", &both->integrator, method, error);
    add_each(line, "set", both->sets, both->n_sets, error);
    add_each(line, "plugin", both->plugins, both->n_plugins, error);
    add_each(line, "threads", &both->threads, threads, error);
}

/* The command of one side: this program's run without pictures, then common and own options. */
static enum cs_status make_line(struct line *line, const struct own *own,
                                struct cs_error *error) {
    line->words = cs_arena_alloc_array(&line->args->arena, 8 + 2 * (size_t)line->args->n_given,
                                       sizeof *line->words, error);
    if (!line->words)
        return error->status;
    add_word(line, cs_program_path());
    add_word(line, "run");
    add_word(line, line->args->operands[0]);
    add_word(line, "--no-render");
    add_word(line, "--quiet");
    add_common(line, own, error);
    for (uint32_t k = 0; k < own->n && !error->status; k++)
        add_own(line, own->items[k], error);
    return error->status;
}

static void add_lines(const char *left, const struct cs_bisect_difference *found,
                      struct cs_text *out) {
    struct cs_text text = {0};
    cs_bisect_print(found, &text);
    char *rest = text.bytes;
    for (char *line; rest && (line = strsep(&rest, "\n")) && *line; left = "")
        cs_print_hanging(left, line, VALUE_COLUMN, out);
    cs_text_finish(&text);
}

/* Prints the traced difference; without one, the difference of the states. */
static void print(const struct cs_bisect *bisect, struct cs_text *out) {
    const struct cs_bisect_difference *states = &bisect->state_difference,
                                      *within = &bisect->first_difference;
    char left[24];
    cs_text_add(out, "%-*s%u frame%s\n", VALUE_COLUMN, "equal", bisect->n_equal_frames,
                bisect->n_equal_frames == 1 ? "" : "s");
    if (!states->exists)
        return;
    snprintf(left, sizeof left, states->frame ? "frame %u" : "start", states->frame);
    add_lines(left, states, out);
    if (!states->frame)
        return;
    if (!within->exists) {
        cs_print_hanging(
            "again",
            "both runs agreed when this frame was repeated: one of them is not reproducible",
            VALUE_COLUMN, out);
        return;
    }
    cs_text_add(out, "%-*s%s, in step %llu, t = %.9g s\n", VALUE_COLUMN, "first in",
                within->phase, (unsigned long long)within->step, within->t);
    add_lines("", within, out);
}

/* Prints the result; a difference is CS_ERR_CHECK. */
static enum cs_status report(const struct cs_bisect *bisect, bool quiet,
                             struct cs_error *error) {
    const struct cs_bisect_difference *states = &bisect->state_difference;
    struct cs_text out = {0};
    if (quiet && !states->exists)
        return CS_OK;
    print(bisect, &out);
    if (cs_print_out(stdout, &out, error) || !states->exists)
        return error->status;
    return states->frame
               ? cs_fail(error, CS_ERR_CHECK, "A and B differ from frame %u on", states->frame)
               : cs_fail(error, CS_ERR_CHECK, "A and B differ at the start");
}

static enum cs_status bisect(struct cs_args *args, struct cs_error *error) {
    struct line lines[2] = {{.args = args}, {.args = args}};
    const struct options *options = args->options;
    struct cs_bisect found;
    if (!strcmp(args->operands[0], "-"))
        return cs_fail(error, CS_ERR_USAGE,
                       "SCENE is read several times and cannot be standard input (-)");
    if (cs_args_refuse_both(args, "frames", "time", error) ||
        make_line(&lines[0], &options->own[0], error) ||
        make_line(&lines[1], &options->own[1], error))
        return error->status;
    const struct cs_bisect_settings settings = {
        .sides = {{"A", lines[0].words, lines[0].n}, {"B", lines[1].words, lines[1].n}},
        .tolerance = options->tolerance,
        .stop = cs_interrupt_catch()};
    return cs_bisect_run(&found, &settings, error) ? error->status
                                                   : report(&found, options->quiet, error);
}

const struct cs_command cs_command_bisect = {
    .name = "bisect",
    .operands = "SCENE",
    .summary = "find the first number that differs between two runs of a scene",
    .notes = "A and B run this program on SCENE, with the settings of --a and --b.\n\n"
             "Example: clothsim bisect scenes/hang.json --b program=../old/build/clothsim\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = bisect,
};
