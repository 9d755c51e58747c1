/* clothsim verify: checks that the files of a run or a study are unchanged. */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"

#include <stdio.h>

struct options {
    bool quiet;
};
static const struct options defaults = {false};

static const struct cs_arg rows[] = {
    CS_ARG_QUIET(struct options, quiet),
};

static enum cs_status check(const char *folder, bool quiet, uint32_t *bad,
                            struct cs_error *error) {
    struct cs_text out = {0};
    uint32_t n, differing;
    if (cs_manifest_check(folder, &out, &n, &differing, error))
        cs_text_finish(&out);
    else {
        *bad += differing;
        if (!quiet || differing)
            cs_text_add(&out, "%s: %u of %u files differ\n", folder, differing, n);
        cs_print_out(stdout, &out, error);
    }
    return error->status;
}

static enum cs_status verify(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    uint32_t bad = 0;
    for (uint32_t k = 0; k < args->n_operands && !error->status; k++)
        check(args->operands[k], options->quiet, &bad, error);
    return error->status || !bad ? error->status
                                 : cs_fail(error, CS_ERR_CHECK, "%u file%s not as written", bad,
                                           bad == 1 ? " is" : "s are");
}

const struct cs_command cs_command_verify = {
    .name = "verify",
    .operands = "DIR...",
    .summary = "check that the files of a run or a study are unchanged",
    .notes = "Example: clothsim verify out\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 10000,
    .main = verify,
};
