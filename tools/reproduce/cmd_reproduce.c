/* clothsim reproduce: reproduces a result from its provenance, and reports the differences. */
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "reproduce/compare_reproduce.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_BYTES = 4096, VALUE_COLUMN = 16 };

struct options {
    struct cs_reproduction_settings again;
    bool quiet;
};
static const struct options defaults = {.again = {.session = {.threads = CS_THREADS_AUTO}}};

static const struct cs_arg rows[] = {
    {"folder", 0, "DIR",
     "folder of the scene's meshes and textures (default: the folder they were in)",
     CS_ARG_INTO(struct options, again.folder)},
    {"plugin", 'p', "FILE",
     "module file with the method, if a module provided it; may be repeated",
     CS_ARG_LIST(struct options, again.session.plugins, again.session.n_plugins)},
    CS_ARG_PROGRAM(struct options, again.session.plugins, again.session.n_plugins),
    {"threads", 0, "N", "threads that step the scene, 1 to 64 (default: as run)",
     CS_ARG_INTO(struct options, again.session.threads), .min = 1, .max = CS_POOL_THREADS_MAX},
    CS_ARG_QUIET(struct options, quiet),
};

static bool ends_in(const char *text, const char *ending) {
    const size_t length = strlen(text), end = strlen(ending);
    return length > end && !strcmp(text + length - end, ending);
}

/* Splits FILE.csv:ROW; returns the row, 0 if there is none. */
static uint32_t split_row(char *path) {
    char *colon = strrchr(path, ':');
    const size_t digits = colon ? strspn(colon + 1, "0123456789") : 0;
    if (!digits || digits > 9 || colon[1 + digits])
        return 0;
    *colon = 0;
    if (ends_in(path, ".csv"))
        return (uint32_t)strtoul(colon + 1, NULL, 10);
    *colon = ':';
    return 0;
}

/* Notes the files of the folder that have changed since the run. */
static enum cs_status print_manifest(const char *folder, struct cs_text *notes,
                                     struct cs_error *error) {
    struct cs_error unread = {0};
    uint32_t n, differing;
    if (cs_manifest_check(folder, notes, &n, &differing, &unread) == CS_ERR_MEMORY)
        return cs_fail(error, CS_ERR_MEMORY, "%s", unread.message);
    if (unread.status)
        cs_text_add(notes, "%s\n", unread.message);
    return CS_OK;
}

/* Chooses the reproduction by the file's name; a folder stands for the report in it. */
static enum cs_status reproduce_file(struct cs_reproduction *reproduction,
                                     struct cs_reproduction_settings *settings,
                                     char path[PATH_BYTES], struct cs_error *error) {
    struct stat info;
    const uint32_t row = split_row(path);
    if (!stat(path, &info) && S_ISDIR(info.st_mode)) {
        if (print_manifest(path, &reproduction->notes, error))
            return error->status;
        strncat(path, "/run.json", PATH_BYTES - strlen(path) - 1);
    }
    settings->file = path;
    return row ? cs_compare_reproduce_row(reproduction, settings, row, error)
           : ends_in(path, ".csv")
               ? cs_fail(error, CS_ERR_USAGE, "%s: expected a row, as in %s:1", path, path)
           : ends_in(path, ".png") ? cs_reproduction_of_picture(reproduction, settings, error)
                                   : cs_reproduction_of_run(reproduction, settings, error);
}

static void print_notes(char *notes, struct cs_text *out) {
    const char *left = "changed since";
    for (char *line; (line = strsep(&notes, "\n")) && *line; left = "")
        cs_print_hanging(left, line, VALUE_COLUMN, out);
}

/* Prints what was run, what has changed, and what is equal. */
static enum cs_status print(struct cs_reproduction *reproduction, struct cs_error *error) {
    struct cs_text out = {0};
    cs_print_hanging("again", cs_text_get(&reproduction->description), VALUE_COLUMN, &out);
    if (reproduction->notes.length)
        print_notes(reproduction->notes.bytes, &out);
    cs_print_hanging("equal",
                     reproduction->equal_items.length ? cs_text_get(&reproduction->equal_items)
                                                      : "nothing",
                     VALUE_COLUMN, &out);
    return cs_print_out(stdout, &out, error);
}

/* A difference must not be lost with the text that says it. */
static enum cs_status check_texts(const struct cs_reproduction *reproduction,
                                  struct cs_error *error) {
    return reproduction->description.failed || reproduction->notes.failed ||
                   reproduction->equal_items.failed || reproduction->first_difference.failed
               ? cs_fail(error, CS_ERR_MEMORY, "out of memory for what was found")
               : CS_OK;
}

static enum cs_status reproduce(struct cs_args *args, struct cs_error *error) {
    char path[PATH_BYTES];
    struct cs_reproduction reproduction = {0};
    struct cs_progress progress;
    struct options *options = args->options;
    struct cs_reproduction_settings *settings = &options->again;
    snprintf(path, sizeof path, "%s", args->operands[0]);
    settings->session.run.stop = cs_interrupt_catch();
    settings->progress = cs_progress_show;
    settings->ctx = &progress;
    cs_progress_begin(&progress, "frame", options->quiet);
    reproduce_file(&reproduction, settings, path, error);
    cs_progress_end(&progress);
    if (!error->status && !check_texts(&reproduction, error) &&
        (options->quiet || !print(&reproduction, error)) &&
        reproduction.first_difference.length)
        cs_fail(error, CS_ERR_CHECK, "%s: %s", args->operands[0],
                cs_text_get(&reproduction.first_difference));
    cs_reproduction_finish(&reproduction);
    return error->status;
}

const struct cs_command cs_command_reproduce = {
    .name = "reproduce",
    .operands = "FILE",
    .summary = "reproduce a result and report what differs",
    .notes =
        "FILE is the run.json or a picture of a run, the folder of one, or compare.csv:ROW of\n"
        "a comparison, where row 1 is the first below the header.\n\n"
        "Example: clothsim reproduce out/frame_00060.png\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = reproduce,
};
