/* clothsim sweep: runs a scene with every combination of values and methods.
 *
 *   -s PATH=V1,V2,... and -i METHOD -> axes -> cs_parameter_sweep_run: a row per cell */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "study/parameter_sweep.h"

#include <stdio.h>
#include <string.h>

struct options {
    struct cs_parameter_sweep product;
    const char *const *keys; /* (n_keys) as they were typed */
    uint32_t n_keys;
    bool quiet;
};
static const struct options defaults = {.product = {.frames = 60, .folder = "sweep"}};

static const struct cs_arg rows[] = {
    {"integrators", 'i', "LIST",
     "methods, NAME:KEY=VALUE,...,NAME...; may be repeated (default: the scene's own)",
     CS_ARG_LIST(struct options, product.methods, product.n_methods), .methods = true},
    {"set", 's', "PATH=VALUE,VALUE,...",
     "values of a key of the scene; repeated: every combination is run",
     CS_ARG_LIST(struct options, keys, n_keys)},
    {"frames", 'n', "N", "simulate frames 1 to N (default: 60)",
     CS_ARG_INTO(struct options, product.frames), .min = 1, .max = 10000000},
    CS_ARG_PLUGIN(struct options, product.session),
    {"out", 'o', "DIR", "folder of sweep.csv (default: sweep)",
     CS_ARG_INTO(struct options, product.folder)},
    {"overwrite", 'y', NULL, "replace an existing sweep.csv",
     CS_ARG_INTO(struct options, product.overwrite)},
    {"shard", 0, "K/N", "run shard K of N of the cells; see: clothsim merge",
     CS_ARG_INTO(struct options, product.shard)},
    {"quiet", 'q', NULL, "print nothing", CS_ARG_INTO(struct options, quiet)},
};

/* Cuts the next value off at a comma outside of brackets and quotes: values may be JSON lists.
 */
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

/* Reads "PATH=VALUE,VALUE". The text is a copy in the arena, and is cut into values. */
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

static enum cs_status read_keys(struct cs_args *args, const struct options *options,
                                struct cs_parameter_sweep *product, struct cs_error *error) {
    product->n_keys = options->n_keys;
    if (product->n_keys > CS_PARAMETER_AXES_MAX)
        return cs_fail(error, CS_ERR_USAGE, "--set: found %u keys, expected at most %d",
                       product->n_keys, CS_PARAMETER_AXES_MAX);
    for (uint32_t k = 0; k < product->n_keys && !error->status; k++) {
        char *copy = cs_arena_copy_text(&args->arena, options->keys[k], error);
        if (copy)
            read_key(args, copy, product->keys + k, error);
        for (uint32_t other = 0; other < k && !error->status; other++)
            if (!strcmp(product->keys[other].path, product->keys[k].path))
                cs_fail(error, CS_ERR_USAGE, "--set: %.60s is given twice",
                        product->keys[k].path);
    }
    return error->status;
}

static enum cs_status sweep(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    struct options *options = args->options;
    struct cs_parameter_sweep *product = &options->product;
    product->session.scene = args->operands[0];
    product->session.run.stop = cs_interrupt_catch();
    product->progress = cs_progress_show;
    product->ctx = &progress;
    if (read_keys(args, options, product, error))
        return error->status;
    cs_progress_begin(&progress, "cell", options->quiet);
    if (!cs_parameter_sweep_run(product, error))
        cs_manifest_write_study(product->folder, error);
    cs_progress_end(&progress);
    if (error->status || options->quiet)
        return error->status;
    printf("%u of %u cells are in %s/sweep.csv, %u of them from earlier runs\n",
           product->n_done, product->cells, product->folder, product->n_reused);
    if (product->n_refused)
        printf("warning: %u of them were refused or failed; the first message: %s\n",
               product->n_refused, product->first_refusal.message);
    return CS_OK;
}

const struct cs_command cs_command_sweep = {
    .name = "sweep",
    .operands = "SCENE",
    .summary = "run a scene with every combination of values and methods",
    .notes = "Each row is written as it finishes: the same command continues an interrupted\n"
             "sweep, and several processes can fill one folder.\n"
             "\n"
             "Example: clothsim sweep scenes/hang.json -s bodies[0].springs.stretch=50,100,200 "
             "\\\n             -i rk4 -i newmark:dt=0.005 -n 30 -o sweep\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = sweep,
};
