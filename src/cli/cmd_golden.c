/* clothsim golden: recomputes golden hashes and images, and reports differences.
 *
 *   options -> cs_golden_check: per row a run, its hash or picture, a verdict -> counts */
#include "base/json_writer.h"
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "sim/install_paths.h"
#include "study/golden/golden.h"

#include <stdio.h>
#include <string.h>

struct options {
    struct cs_golden check;
    const char *json;
    bool quiet;
};
static const struct options defaults = {.check = {.threads = 1}};

static const struct cs_arg rows[] = {
    {"accept", 0, NULL, "replace the golden files with the new results: look at them first",
     CS_ARG_INTO(struct options, check.accept_all)},
    {"hashes", 0, NULL, "state hashes only", CS_ARG_INTO(struct options, check.hashes)},
    {"images", 0, NULL, "images only", CS_ARG_INTO(struct options, check.images)},
    {"only", 0, "TEXT", "only rows whose scene or integrator contains TEXT",
     CS_ARG_INTO(struct options, check.only_rows)},
    {"folder", 0, "DIR", "the golden folder (default: golden here, else the installed one)",
     CS_ARG_INTO(struct options, check.folder)},
    {"renderer", 0, "NAME", "cpu, osmesa, egl or auto (default: auto); may be repeated",
     CS_ARG_INTO(struct options, check.renderers), .names = cs_renderer_names,
     .repeatable = true},
    {"threads", 0, "N", "threads that step each scene, 1 to 64 (default: 1)",
     CS_ARG_INTO(struct options, check.threads), .min = 1, .max = CS_POOL_THREADS_MAX},
    {"json", 0, "FILE", "write the rows as JSON too; -: to standard output",
     CS_ARG_INTO(struct options, json)},
    {"quiet", 'q', NULL, "print only rows that differ, and the count",
     CS_ARG_INTO(struct options, quiet)},
};

/* Destination of the rows. */
struct sink {
    const struct options *options;
    struct cs_text json;
};

static void add_json(const struct cs_golden_row *row, const char *verdict,
                     struct cs_text *out) {
    cs_json_write(out,
                  ",\n    {'verdict': %s, 'image': %s, 'scene': %s, 'integrator': %s, "
                  "'overrides': %s, 'message': %s, 'frame': %u}",
                  verdict, row->image ? row->image : "", row->run.scene, row->run.integrator,
                  row->run.overrides, cs_text_get(&row->message), row->run.frames);
}

static void print_row(void *ctx, const struct cs_golden_row *row) {
    struct sink *sink = ctx;
    const struct options *options = sink->options;
    const bool differs = row->message.length > 0 && (row->added || !row->skipped);
    const char *verdict = row->skipped ? "skip" : !differs ? "ok" : "DIFFERS";
    if (differs && options->check.accept_all)
        verdict = "accepted";
    add_json(row, verdict, &sink->json);
    if ((!differs && options->quiet) || cs_print_is_stdout(options->json))
        return;
    printf("%-8s %s%s%s  %s", verdict, row->image ? "image " : "", row->image ? row->image : "",
           row->image ? " " : "", row->run.scene);
    if (strcmp(row->run.integrator, "-"))
        printf("  %s", row->run.integrator);
    if (strcmp(row->run.overrides, "-"))
        printf("  %s", row->run.overrides);
    printf("  frame %u%s%s\n", row->run.frames, row->message.length ? ": " : "",
           cs_text_get(&row->message));
    fflush(stdout);
}

static enum cs_status write_json(const struct cs_golden *check, struct sink *sink,
                                 struct cs_error *error) {
    const char *path = sink->options->json;
    struct cs_text out = {0};
    if (path) {
        cs_json_write(&out,
                      "{\n  'agree': %u, 'differ': %u, 'accepted': %u, 'skipped': %u,\n"
                      "  'rows': [",
                      check->passed, check->failed, check->accepted, check->skipped);
        cs_text_add(&out, "%s\n  ]\n}\n", cs_text_get(&sink->json));
        out.failed |= sink->json.failed;
        cs_print_file(path, &out, error);
    }
    return error->status;
}

static enum cs_status golden(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_golden *check = &options->check;
    char installed[CS_DATA_PATH_MAX];
    struct sink sink = {.options = options};
    /* installed tables are for comparison only and never written */
    if (!check->folder)
        check->folder =
            check->accept_all ? "golden" : cs_data_find("golden", installed, sizeof installed);
    /* without a flag both are checked, as with both flags */
    if (check->hashes == check->images)
        check->hashes = check->images = true;
    if (!check->renderers)
        check->renderers = 1u << CS_RENDERER_AUTO;
    check->stop = cs_interrupt_catch();
    check->report = print_row;
    check->ctx = &sink;
    if (!cs_golden_check(check, error))
        write_json(check, &sink, error);
    cs_text_finish(&sink.json);
    if (error->status)
        return error->status;
    if (!cs_print_is_stdout(options->json))
        printf("%u agree, %u differ, %u accepted, %u skipped\n", check->passed, check->failed,
               check->accepted, check->skipped);
    /* a misspelt --only must not look like success */
    if (check->passed + check->failed + check->accepted + check->skipped == 0)
        return cs_fail(error, CS_ERR_USAGE, "no golden row matches");
    if (check->failed > 0)
        return cs_fail(error, CS_ERR_CHECK,
                       "%u golden row%s differ%s; if the change is intended, look at it, then "
                       "use --accept",
                       check->failed, check->failed == 1 ? "" : "s",
                       check->failed == 1 ? "s" : "");
    return CS_OK;
}

const struct cs_command cs_command_golden = {
    .name = "golden",
    .operands = "",
    .summary = "recompute golden state hashes and images, and compare",
    .notes = "Images must match pixel for pixel if the same renderer made the golden image,\n"
             "else within a tolerance that is tight enough to reveal defects. A picture that\n"
             "differs is written next to its golden image as *.actual.png, with 16 times the\n"
             "difference as *.difference.png.\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 0,
    .main = golden,
};
