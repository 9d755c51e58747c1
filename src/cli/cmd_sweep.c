/* clothsim sweep: runs a scene with every combination of values and methods. */
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/progress.h"
#include "study/parameter_sweep.h"

#include <stdio.h>
#include <string.h>

enum {
    SWEEP_INTEGRATORS,
    SWEEP_SET,
    SWEEP_FRAMES,
    SWEEP_PLUGIN,
    SWEEP_OUT,
    SWEEP_SHARD,
    SWEEP_QUIET,
    SWEEP_ROWS
};

static const struct cs_arg rows[SWEEP_ROWS] = {
    [SWEEP_INTEGRATORS] = {"integrators", 'i', "LIST",
                           "methods, NAME:KEY=VALUE,...,NAME...; may be repeated (default: the "
                           "scene's own)",
                           true},
    [SWEEP_SET] = {"set", 's', "PATH=VALUE,VALUE,...",
                   "the values of a key of the scene, each with each of the others; may be "
                   "repeated",
                   true},
    [SWEEP_FRAMES] = {"frames", 'n', "N", "simulate frames 1 to N (default: 60)", false},
    [SWEEP_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
                      true},
    [SWEEP_OUT] = {"out", 'o', "DIR", "folder of sweep.csv (default: sweep)", false},
    [SWEEP_SHARD] = {"shard", 0, "K/N",
                     "run the K-th of N shares of the cells; see: clothsim merge", false},
    [SWEEP_QUIET] = {"quiet", 'q', NULL, "print nothing", false},
};

static void show_progress(void *ctx, uint32_t done, uint32_t total) {
    cs_progress_show(ctx, done, total);
}

/* Cuts the next value off at a comma that stands in no brackets and no quotes. */
static char *cut_value(char **rest) {
    char *value = *rest, *c = value;
    int depth = 0;
    bool quoted = false;
    for (; *c && (*c != ',' || depth > 0 || quoted); c++) {
        quoted ^= *c == '"';
        depth += quoted ? 0 : (*c == '[' || *c == '{') - (*c == ']' || *c == '}');
    }
    *rest = *c ? c + 1 : NULL;
    *c = 0;
    return value;
}

/* "PATH=VALUE,VALUE": the text is the arena's, and is cut. */
static enum cs_status read_key(struct cs_args *args, char *text, struct cs_parameter_axis *key,
                               struct cs_error *error) {
    char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return cs_fail(error, CS_ERR_USAGE,
                       "--set: expected PATH=VALUE,VALUE,..., found \"%.60s\"", text);
    *equals = 0;
    uint32_t commas = 1;
    for (const char *c = equals + 1; *c; c++)
        commas += *c == ',';
    *key = (struct cs_parameter_axis){.path = text};
    key->values = cs_arena_alloc_array(&args->arena, commas, sizeof *key->values, error);
    for (char *rest = equals + 1; key->values && rest;)
        key->values[key->n++] = cut_value(&rest);
    return error->status;
}

static enum cs_status read_keys(struct cs_args *args, struct cs_parameter_sweep *product,
                                struct cs_error *error) {
    const char *const *texts;
    if (cs_args_get_all(args, SWEEP_SET, &texts, &product->n_keys, error))
        return error->status;
    if (product->n_keys > CS_PARAMETER_AXES_MAX)
        return cs_fail(error, CS_ERR_USAGE, "--set: found %u keys, expected at most %d",
                       product->n_keys, CS_PARAMETER_AXES_MAX);
    for (uint32_t k = 0; k < product->n_keys && !error->status; k++) {
        const size_t bytes = strlen(texts[k]) + 1;
        char *copy = cs_arena_alloc_array(&args->arena, bytes, 1, error);
        if (copy)
            read_key(args, memcpy(copy, texts[k], bytes), product->keys + k, error);
        for (uint32_t other = 0; other < k && !error->status; other++)
            if (!strcmp(product->keys[other].path, product->keys[k].path))
                cs_fail(error, CS_ERR_USAGE, "--set: %.60s is there twice",
                        product->keys[k].path);
    }
    return error->status;
}

static enum cs_status sweep(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    const char *folder = cs_args_get(args, SWEEP_OUT);
    struct cs_parameter_sweep product = {.session = {.scene = args->operands[0]},
                                         .frames = 60,
                                         .folder = folder ? folder : "sweep",
                                         .progress = show_progress,
                                         .ctx = &progress};
    const bool quiet = cs_args_get(args, SWEEP_QUIET);
    product.session.run.stop = cs_interrupt_catch();
    if (read_keys(args, &product, error) ||
        cs_args_integer(args, SWEEP_FRAMES, 1, 10000000, &product.frames, error) ||
        cs_args_shard(args, SWEEP_SHARD, &product.shard, error) ||
        cs_args_methods(args, SWEEP_INTEGRATORS, &product.methods, &product.n_methods, error) ||
        cs_args_get_all(args, SWEEP_PLUGIN, &product.session.plugins,
                        &product.session.n_plugins, error))
        return error->status;
    cs_progress_begin(&progress, quiet);
    progress.label = "cell";
    cs_parameter_sweep_run(&product, error);
    cs_progress_end(&progress);
    if (!error->status && !quiet)
        printf("%u of %u cells are in %s/sweep.csv, %u of them from before\n", product.n_done,
               product.cells, product.folder, product.n_reused);
    if (!error->status && !quiet && product.n_refused)
        printf("warning: %u of them refused or failed, the first by: %s\n", product.n_refused,
               product.first_refusal.message);
    return error->status;
}

const struct cs_command cs_command_sweep = {
    .name = "sweep",
    .operands = "SCENE",
    .summary = "run a scene with every combination of values and methods",
    .notes = "Rows are kept as they finish: a sweep that was stopped goes on when it is run\n"
             "again, and several processes can fill one folder.\n\n"
             "Example: clothsim sweep scenes/hang.json -s bodies[0].springs.stretch=50,100,200 "
             "\\\n             -i rk4 -i newmark:dt=0.005 -n 30 -o sweep\n",
    .rows = rows,
    .n_rows = SWEEP_ROWS,
    .operands_min = 1,
    .operands_max = 1,
    .main = sweep,
};
