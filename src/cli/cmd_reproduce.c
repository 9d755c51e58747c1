/* clothsim reproduce: makes a result again from what it carries, and says what differs. */
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "cli/line/progress.h"
#include "study/again.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum { REPRODUCE_FOLDER, REPRODUCE_PLUGIN, REPRODUCE_THREADS, REPRODUCE_QUIET, REPRODUCE_ROWS };
enum { PATH_BYTES = 4096, VALUE_COLUMN = 16 };

static const struct cs_arg rows[REPRODUCE_ROWS] = {
    [REPRODUCE_FOLDER] = {"folder", 'f', "DIR",
                          "where the meshes and textures of the scene are (default: where they "
                          "were)",
                          false},
    [REPRODUCE_PLUGIN] = {"plugin", 'p', "FILE",
                          "load this module instead of the one that was loaded from a file; "
                          "may be repeated",
                          true},
    [REPRODUCE_THREADS] = {"threads", 0, "N",
                           "threads that step the scene, 1 to 64 (default: as run)", false},
    [REPRODUCE_QUIET] = {"quiet", 'q', NULL, "print only what differs", false},
};

typedef enum cs_status again_call(struct cs_again *again,
                                  const struct cs_again_settings *settings,
                                  struct cs_error *error);

static bool ends_in(const char *text, const char *ending) {
    const size_t length = strlen(text), end = strlen(ending);
    return length > end && !strcmp(text + length - end, ending);
}

/* what a file is, by its name; a folder stands for the report in it */
static again_call *choose(const char *operand, char path[PATH_BYTES]) {
    struct stat info;
    const bool folder = !stat(operand, &info) && S_ISDIR(info.st_mode);
    snprintf(path, PATH_BYTES, "%s%s", operand, folder ? "/run.json" : "");
    return ends_in(path, ".png") ? cs_again_picture : cs_again_run;
}

static void show(void *ctx, uint32_t done, uint32_t total) {
    cs_progress_show(ctx, done, total);
}

static void print_notes(char *notes, struct cs_text *out) {
    const char *left = "changed since";
    for (char *line; (line = strsep(&notes, "\n")) && *line; left = "")
        cs_print_hanging(left, line, VALUE_COLUMN, out);
}

static enum cs_status print(struct cs_again *again, struct cs_error *error) {
    struct cs_text out = {0};
    cs_print_hanging("again", cs_text_get(&again->what), VALUE_COLUMN, &out);
    if (again->notes.length)
        print_notes(again->notes.bytes, &out);
    cs_print_hanging("equal", again->equal.length ? cs_text_get(&again->equal) : "nothing",
                     VALUE_COLUMN, &out);
    return cs_print_out(stdout, &out, error);
}

static enum cs_status reproduce(struct cs_args *args, struct cs_error *error) {
    char path[PATH_BYTES];
    struct cs_again again = {0};
    struct cs_progress progress;
    const bool quiet = cs_args_get(args, REPRODUCE_QUIET);
    again_call *const call = choose(args->operands[0], path);
    struct cs_again_settings settings = {.file = path,
                                         .folder = cs_args_get(args, REPRODUCE_FOLDER),
                                         .session = {.threads = CS_THREADS_AUTO},
                                         .progress = show,
                                         .ctx = &progress};
    settings.session.run.stop = cs_interrupt_catch();
    if (cs_args_whole(args, REPRODUCE_THREADS, 1, CS_POOL_MOST, &settings.session.threads,
                      error) ||
        cs_args_all(args, REPRODUCE_PLUGIN, &settings.session.plugins,
                    &settings.session.n_plugins, error))
        return error->status;
    cs_progress_begin(&progress, quiet);
    call(&again, &settings, error);
    cs_progress_end(&progress);
    if (!error->status && (quiet || !print(&again, error)) && again.difference.length)
        cs_fail(error, CS_ERR_CHECK, "%s: %s", path, cs_text_get(&again.difference));
    cs_again_finish(&again);
    return error->status;
}

const struct cs_command cs_command_reproduce = {
    .name = "reproduce",
    .operands = "FILE",
    .summary = "make a result again from what it carries, and say what differs",
    .notes = "FILE is the run.json or a picture of a run, or the folder of one.\n\n"
             "Example: clothsim reproduce out/frame_00060.png\n",
    .rows = rows,
    .n_rows = REPRODUCE_ROWS,
    .least = 1,
    .most = 1,
    .main = reproduce,
};
