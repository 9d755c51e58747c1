/* Writes state files, and finds or removes the files of an earlier run. */
#include "cli/run_output.h"

#include "base/file.h"
#include "io/npy.h"

#include <dirent.h>
#include <errno.h>
#include <string.h>
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

static bool is_ours(const char *name, bool states) {
    if (states)
        return is_numbered(name, "x_", ".npy") || is_numbered(name, "v_", ".npy");
    return is_numbered(name, "frame_", ".png") || !strcmp(name, "run.json") ||
           !strcmp(name, "run.checkpoint");
}

static enum cs_status join(const char *folder, const char *name, char path[PATH_BYTES],
                           struct cs_error *error) {
    if (snprintf(path, PATH_BYTES, "%s/%s", folder, name) >= PATH_BYTES)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot use the folder \"%.60s...\": the path is too long", folder);
    return CS_OK;
}

static enum cs_status refuse(const char *path, struct cs_error *error) {
    return cs_fail(error, CS_ERR_FILE, "\"%s\" is there already; -y overwrites it", path);
}

enum cs_status cs_output_check_file(const char *path, struct cs_error *error) {
    struct stat info;
    return lstat(path, &info) ? CS_OK : refuse(path, error);
}

/* An open folder, or NULL: with CS_OK where it is not there. */
static DIR *open_folder(const char *folder, struct cs_error *error) {
    DIR *entries = opendir(folder);
    if (!entries && errno != ENOENT)
        cs_fail(error, CS_ERR_FILE, "cannot read the folder \"%s\": %s", folder,
                strerror(errno));
    return entries;
}

enum cs_status cs_output_check(const char *folder, bool states, struct cs_error *error) {
    char first[256] = "", path[PATH_BYTES];
    DIR *entries = folder ? open_folder(folder, error) : NULL;
    if (!entries)
        return error->status;
    /* the first by name, since folders have no order */
    for (struct dirent *entry; (entry = readdir(entries));)
        if (is_ours(entry->d_name, states) && (!*first || strcmp(entry->d_name, first) < 0))
            snprintf(first, sizeof first, "%s", entry->d_name);
    closedir(entries);
    if (!*first || join(folder, first, path, error))
        return error->status;
    return refuse(path, error);
}

enum cs_status cs_output_prepare(const char *folder, bool states, bool empty,
                                 struct cs_error *error) {
    char path[PATH_BYTES];
    if (cs_folder_make(folder, error) || !empty)
        return error->status;
    DIR *entries = open_folder(folder, error);
    if (!entries)
        return error->status;
    for (struct dirent *entry; (entry = readdir(entries)) && !error->status;)
        if (is_ours(entry->d_name, states) && !join(folder, entry->d_name, path, error) &&
            unlink(path))
            cs_fail(error, CS_ERR_FILE, "cannot remove \"%s\": %s", path, strerror(errno));
    closedir(entries);
    return error->status;
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
