/* clothsim golden: recomputes golden hashes and images, and reports what differs. */
#include "base/json_writer.h"
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "sim/folders.h"
#include "study/golden/golden.h"

#include <stdio.h>
#include <string.h>

enum {
    GOLDEN_ACCEPT,
    GOLDEN_HASHES,
    GOLDEN_IMAGES,
    GOLDEN_ONLY,
    GOLDEN_FOLDER,
    GOLDEN_RENDERER,
    GOLDEN_THREADS,
    GOLDEN_JSON,
    GOLDEN_QUIET,
    GOLDEN_ROWS
};

static const struct cs_arg rows[GOLDEN_ROWS] = {
    [GOLDEN_ACCEPT] = {"accept", 0, NULL,
                       "write what was found into the golden files: look at it first", false},
    [GOLDEN_HASHES] = {"hashes", 0, NULL, "state hashes only", false},
    [GOLDEN_IMAGES] = {"images", 0, NULL, "images only", false},
    [GOLDEN_ONLY] = {"only", 0, "TEXT", "rows whose scene or integrator holds TEXT", false},
    [GOLDEN_FOLDER] = {"folder", 0, "DIR",
                       "the golden folder (default: golden here, else the installed one)",
                       false},
    [GOLDEN_RENDERER] = {"renderer", 0, "NAME",
                         "cpu, osmesa, egl or auto (default: auto); may be repeated", true},
    [GOLDEN_THREADS] = {"threads", 0, "N", "threads that step each scene, 1 to 64 (default: 1)",
                        false},
    [GOLDEN_JSON] = {"json", 0, "FILE", "write the rows as JSON too; -: to standard output",
                     false},
    [GOLDEN_QUIET] = {"quiet", 'q', NULL, "print only rows that differ, and the count", false},
};

/* Where rows go. */
struct sink {
    const struct cs_args *args;
    struct cs_text json;
};

static bool takes_stdout(const char *json) {
    return json && !strcmp(json, "-");
}

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
    const struct cs_args *args = sink->args;
    const bool differs = row->message.length > 0 && (row->added || !row->skipped);
    const char *verdict = row->skipped ? "skip" : !differs ? "ok" : "DIFFERS";
    if (differs && cs_args_get(args, GOLDEN_ACCEPT))
        verdict = "accepted";
    add_json(row, verdict, &sink->json);
    if ((!differs && cs_args_get(args, GOLDEN_QUIET)) ||
        takes_stdout(cs_args_get(args, GOLDEN_JSON)))
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
    const char *path = cs_args_get(sink->args, GOLDEN_JSON);
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
    uint32_t renderers = 1u << CS_RENDERER_AUTO;
    const char *folder = cs_args_get(args, GOLDEN_FOLDER);
    const bool hashes = cs_args_get(args, GOLDEN_HASHES),
               images = cs_args_get(args, GOLDEN_IMAGES);
    const bool accept = cs_args_get(args, GOLDEN_ACCEPT);
    char installed[CS_DATA_PATH_MAX];
    uint32_t threads = 1;
    struct sink sink = {.args = args};
    if (cs_args_choices(args, GOLDEN_RENDERER, cs_renderer_names, &renderers, error) ||
        cs_args_whole(args, GOLDEN_THREADS, 1, CS_POOL_MOST, &threads, error))
        return error->status;
    struct cs_golden check = {
        /* the installed tables are there to be compared with, and never written to */
        .folder = folder   ? folder
                  : accept ? "golden"
                           : cs_data_find("golden", installed, sizeof installed),
        .only = cs_args_get(args, GOLDEN_ONLY),
        /* without a flag both are checked, as with both flags */
        .hashes = hashes || !images,
        .images = images || !hashes,
        .accept = accept,
        .renderers = renderers,
        .threads = threads,
        .stop = cs_interrupt_catch(),
        .report = print_row,
        .ctx = &sink,
    };
    if (!cs_golden_check(&check, error))
        write_json(&check, &sink, error);
    cs_text_finish(&sink.json);
    if (error->status)
        return error->status;
    if (!takes_stdout(cs_args_get(args, GOLDEN_JSON)))
        printf("%u agree, %u differ, %u accepted, %u skipped\n", check.passed, check.failed,
               check.accepted, check.skipped);
    /* a misspelt --only must not look like success */
    if (check.passed + check.failed + check.accepted + check.skipped == 0)
        return cs_fail(error, CS_ERR_USAGE, "no golden row matches");
    if (check.failed > 0)
        return cs_fail(
            error, CS_ERR_CHECK,
            "%u golden row%s differ%s; if the change is meant, look and then --accept",
            check.failed, check.failed == 1 ? "" : "s", check.failed == 1 ? "s" : "");
    return CS_OK;
}

const struct cs_command cs_command_golden = {
    .name = "golden",
    .operands = "",
    .summary = "recompute golden state hashes and images, and compare",
    .notes = "Images are compared pixel for pixel where the renderer is the one that made the\n"
             "golden image, else within a tolerance that defects do not pass. A picture that\n"
             "differs is written beside its golden image as *.actual.png, with 16 times the\n"
             "difference as *.difference.png.\n",
    .rows = rows,
    .n_rows = GOLDEN_ROWS,
    .least = 0,
    .most = 0,
    .main = golden,
};
