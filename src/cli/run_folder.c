/* Writes state files; owns folders, and finds or removes the files of an earlier run there. */
#include "cli/run_folder.h"

#include "base/file.h"
#include "base/install_paths.h"
#include "cli/commands.h"
#include "cli/file_conflicts.h"
#include "cli/line/print.h"
#include "export/export.h"
#include "export/npy.h"
#include "session/process_pool.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 4096, NUMBER_DIGITS = 5 };

/* true for prefix, at least five digits, ending: what we wrote, and no one's other files */
static bool is_numbered(const char *name, const char *prefix, const char *ending) {
    const size_t start = strlen(prefix);
    if (strncmp(name, prefix, start))
        return false;
    const size_t digits = strspn(name + start, "0123456789");
    return digits >= NUMBER_DIGITS && !strcmp(name + start + digits, ending);
}

/* "bodies" or "colliders", and what follows; NULL: neither */
static const char *after_skin(const char *name) {
    return !strncmp(name, "bodies", 6)      ? name + 6
           : !strncmp(name, "colliders", 9) ? name + 9
                                            : NULL;
}

static bool is_exported(const struct cs_export_writer *writer, const char *name) {
    const char *rest = after_skin(name);
    char ending[16];
    for (size_t k = 0; k < sizeof writer->files / sizeof *writer->files; k++)
        if (writer->files[k] && !strcmp(name, writer->files[k]))
            return true;
    snprintf(ending, sizeof ending, ".%s", writer->ending ? writer->ending : "");
    if (writer->ending && rest && is_numbered(rest, "_", ending))
        return true;
    return writer->cache_ending && rest && *rest == '.' &&
           !strcmp(rest + 1, writer->cache_ending);
}

bool cs_output_is_result(const char *name) {
    static const char *const alone[] = {"run.json", "run.checkpoint", "run.frames",
                                        "run.frames.part", "manifest.txt"};
    bool is_ours = is_numbered(name, "frame_", ".png");
    for (size_t k = 0; k < sizeof alone / sizeof *alone; k++)
        is_ours = is_ours || !strcmp(name, alone[k]);
    for (size_t k = 0; k < CS_N_EXPORT_FORMATS; k++)
        is_ours = is_ours || is_exported(cs_export_writers[k], name);
    return is_ours;
}

bool cs_output_is_state(const char *name) {
    return is_numbered(name, "x_", ".npy") || is_numbered(name, "v_", ".npy") ||
           !strcmp(name, "manifest.txt");
}

static enum cs_status join(const char *folder, const char *name, char path[PATH_BYTES],
                           struct cs_error *error) {
    if (snprintf(path, PATH_BYTES, "%s/%s", folder, name) >= PATH_BYTES)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot use the folder \"%.60s...\": the path is too long", folder);
    return CS_OK;
}

static enum cs_status refuse_folder(const char *path, struct cs_error *error) {
    return cs_fail(error, CS_ERR_FILE, "\"%s\" already exists; -y overwrites it", path);
}

enum cs_status cs_output_check_file(const char *path, struct cs_error *error) {
    struct stat info;
    bool streams;
    return lstat(path, &info) || (!cs_file_target(path, &streams, error) && streams)
               ? error->status
               : refuse_folder(path, error);
}

/* An open folder, or NULL: with CS_OK where it is not there. */
static DIR *open_folder(const char *folder, struct cs_error *error) {
    DIR *entries = opendir(folder);
    if (!entries && errno != ENOENT)
        cs_fail(error, cs_file_status(errno), "cannot read the folder \"%s\": %s", folder,
                strerror(errno));
    return entries;
}

enum cs_status cs_output_check(const char *folder, cs_output_kind *is_ours,
                               struct cs_error *error) {
    char first[256] = "", path[PATH_BYTES];
    DIR *entries = folder ? open_folder(folder, error) : NULL;
    if (!entries)
        return error->status;
    /* the first by name, since folders have no order; a manifest alone is of no use */
    for (struct dirent *entry; (entry = readdir(entries));)
        if (is_ours(entry->d_name) && strcmp(entry->d_name, "manifest.txt") != 0 &&
            (!*first || strcmp(entry->d_name, first) < 0))
            snprintf(first, sizeof first, "%s", entry->d_name);
    closedir(entries);
    if (!*first || join(folder, first, path, error))
        return error->status;
    return refuse_folder(path, error);
}

/* whole: the files of an earlier run too, not only what was left half written */
static enum cs_status sweep(const char *folder, cs_output_kind *is_ours, bool whole,
                            struct cs_error *error) {
    char path[PATH_BYTES];
    DIR *entries = whole ? open_folder(folder, error) : NULL;
    cs_file_sweep(folder, is_ours);
    if (!entries)
        return error->status;
    for (struct dirent *entry; (entry = readdir(entries)) && !error->status;)
        if (is_ours(entry->d_name) && !join(folder, entry->d_name, path, error))
            cs_file_remove(path, error);
    closedir(entries);
    return error->status;
}

static bool is_same_folder(int lock, const struct cs_output *other) {
    struct stat mine, theirs;
    return other && other->folder_lock && !fstat(lock, &mine) &&
           !fstat(other->folder_lock - 1, &theirs) && mine.st_dev == theirs.st_dev &&
           mine.st_ino == theirs.st_ino;
}

/* Locks the folder itself: the lock leaves no file and ends with the process. */
static enum cs_status lock_folder(struct cs_output *output, const struct cs_output *other,
                                  const char *folder, struct cs_error *error) {
    const int lock = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock < 0)
        return cs_fail(error, CS_ERR_FILE, "cannot read the folder \"%s\": %s", folder,
                       strerror(errno));
    if (is_same_folder(lock, other)) {
        close(lock);
        return CS_OK;
    }
    /* a file system without locks has no owners either */
    if (flock(lock, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK) {
        close(lock);
        return cs_fail(error, CS_ERR_FILE, "another run is writing into \"%s\"", folder);
    }
    output->folder_lock = lock + 1;
    return CS_OK;
}

enum cs_status cs_output_lock_folders(struct cs_output *output, const struct cs_output *other,
                                      const char *folder, cs_output_kind *is_ours,
                                      enum cs_output_earlier earlier, struct cs_error *error) {
    *output = (struct cs_output){0};
    if ((earlier != CS_OUTPUT_RESUME && cs_folder_create(folder, error)) ||
        lock_folder(output, other, folder, error))
        return error->status;
    /* checked again under the lock: a run may have ended here since */
    if (earlier == CS_OUTPUT_REFUSE && cs_output_check(folder, is_ours, error))
        return error->status;
    return sweep(folder, is_ours, earlier == CS_OUTPUT_REMOVE, error);
}

void cs_output_unlock_folders(struct cs_output *output) {
    if (output->folder_lock)
        close(output->folder_lock - 1);
    *output = (struct cs_output){0};
}

enum cs_status cs_output_state(const char *folder, uint32_t number, const double *x,
                               const double *v, uint32_t n, struct cs_error *error) {
    char name[32], path[PATH_BYTES];
    snprintf(name, sizeof name, "x_%05u.npy", number);
    if (join(folder, name, path, error) || cs_npy_write(path, x, n, error))
        return error->status;
    *name = 'v';
    if (join(folder, name, path, error))
        return error->status;
    return cs_npy_write(path, v, n, error);
}

/* Compares the files that a study writes with those that it reads. */

enum cs_status cs_study_output_check(const struct cs_session_settings *session,
                                     const char *path, const char *option,
                                     struct cs_error *error) {
    struct cs_file_conflicts *conflicts = calloc(1, sizeof *conflicts);
    if (!conflicts)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of files");
    cs_file_conflicts_input(conflicts, session->scene, "the scene");
    for (uint32_t k = 0; k < session->n_plugins; k++)
        cs_file_conflicts_input(conflicts, session->plugins[k], "a module");
    if (path && strcmp(path, "-") != 0)
        cs_file_conflicts_output(conflicts, path, option, error);
    free(conflicts);
    return error->status;
}

enum cs_status cs_study_files_check(const struct cs_session_settings *session,
                                    const char *folder, const char *const *names,
                                    struct cs_error *error) {
    for (; *names && !error->status; names++) {
        char path[PATH_BYTES];
        if (!join(folder, *names, path, error))
            cs_study_output_check(session, path, "--out", error);
    }
    return error->status;
}

enum cs_status cs_study_folder_check(const struct cs_session_settings *session,
                                     const char *folder, struct cs_error *error) {
    char found[CS_DATA_PATH_MAX], home[PATH_BYTES];
    struct stat of_scene, of_results;
    const char *scene = cs_scene_find(session->scene, found, sizeof found);
    const char *slash = strrchr(scene, '/');
    snprintf(home, sizeof home, "%.*s/", slash ? (int)(slash - scene) : 1, slash ? scene : ".");
    if (stat(home, &of_scene) || stat(folder, &of_results) ||
        of_scene.st_dev != of_results.st_dev || of_scene.st_ino != of_results.st_ino)
        return CS_OK;
    return cs_fail(error, CS_ERR_USAGE,
                   "--out: \"%s\" is the folder of the scene, expected another one: results "
                   "would lie among scenes",
                   folder);
}

bool cs_external_modules_requested(const struct cs_args *args, const char *const *texts,
                                   uint32_t n) {
    const char *folders = getenv("CLOTHSIM_PLUGIN_PATH");
    bool named = cs_args_is_given(args, "plugin") || cs_args_is_given(args, "program") ||
                 (folders && *folders);
    for (uint32_t k = 0; k < n; k++)
        named |= texts[k] && (strchr(texts[k], '/') || strstr(texts[k], ".so") ||
                              strstr(texts[k], "program:") || strstr(texts[k], "tableau:"));
    return named;
}

enum cs_status
cs_external_modules_isolate(struct cs_args *args, double seconds, double stop_seconds,
                            enum cs_status (*task)(void *ctx, struct cs_error *error),
                            struct cs_error *error) {
    const struct cs_isolate isolate = {.seconds = seconds,
                                       .stop_seconds = stop_seconds,
                                       .task = task,
                                       .ctx = args,
                                       .stop = cs_interrupt_catch()};
    return cs_isolate_run(&isolate, error);
}

void cs_study_print_command(const struct cs_args *args, const char *name, struct cs_text *out) {
    cs_text_add(out, "clothsim %s", name);
    for (uint32_t k = 0; k < args->n_operands; k++)
        cs_print_shell_word(out, args->operands[k]);
    for (uint32_t k = 0; k < args->n_given; k++) {
        cs_text_add(out, " --%s", args->given[k].row->name);
        if (args->given[k].row->value)
            cs_print_shell_word(out, args->given[k].value);
    }
}
