/* Identifies files by device and inode, and by folder and name. */
#include "cli/file_conflicts.h"

#include "base/file.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* Reads device and inode of a path's folder; returns false if there is none. */
static bool stat_folder(const char *path, struct stat *info) {
    char folder[4096];
    const char *end = strrchr(path, '/');
    const int length = end ? (int)(end - path) : 1;
    if (snprintf(folder, sizeof folder, "%.*s", length, end ? path : ".") >= (int)sizeof folder)
        return false;
    return !stat(*folder ? folder : "/", info);
}

/* Fills a file's identity; returns false if neither it nor its folder exists. */
static bool stat_file(const char *path, const char *what, bool output,
                      struct cs_file_use *use) {
    struct stat file, folder;
    const char *end = strrchr(path, '/');
    *use = (struct cs_file_use){.role = what, .is_output = output};
    snprintf(use->name, sizeof use->name, "%s", end ? end + 1 : path);
    if (!stat_folder(path, &folder))
        return false;
    use->folder_device_id = folder.st_dev;
    use->folder_inode = folder.st_ino;
    // a character device has no content that another use could harm
    use->exists = !stat(path, &file) && !S_ISCHR(file.st_mode);
    if (use->exists) {
        use->device_id = file.st_dev;
        use->inode = file.st_ino;
    }
    return true;
}

/* True if the file `name` is written under the name `other` first: a temporary file. */
static bool is_on_the_way(const char *name, const char *other) {
    char target[CS_FILE_NAME_BYTES];
    const size_t length = strlen(name);
    return (!strncmp(name, other, length) && !strcmp(other + length, ".part")) ||
           (cs_file_is_temporary(other, target) && !strcmp(name, target));
}

/* Compares identities: the same inode, or the same name in the same folder, or one of which the
 * other is the temporary file. */
static bool is_same(const struct cs_file_use *a, const struct cs_file_use *b) {
    if (a->exists && b->exists && a->device_id == b->device_id && a->inode == b->inode)
        return true;
    return a->folder_device_id == b->folder_device_id && a->folder_inode == b->folder_inode &&
           (!strcmp(a->name, b->name) || is_on_the_way(a->name, b->name) ||
            is_on_the_way(b->name, a->name));
}

void cs_file_conflicts_input(struct cs_file_conflicts *conflicts, const char *path,
                             const char *what) {
    if (conflicts->n < CS_FILE_CONFLICTS_MAX &&
        stat_file(path, what, false, conflicts->items + conflicts->n))
        conflicts->n++;
}

/* Names the two uses that collide. */
static enum cs_status refuse_use(const struct cs_file_use *use, const char *path,
                                 const char *what, struct cs_error *error) {
    const char *name = strrchr(path, '/');
    const bool on_the_way = is_on_the_way(name ? name + 1 : path, use->name);
    return cs_fail(error, CS_ERR_FILE, "%s: \"%s\"%s%s%s is %s %s", what, path,
                   on_the_way ? " is first \"" : "", on_the_way ? use->name : "",
                   on_the_way ? "\", which" : "",
                   use->is_output ? "also written by" : "read as", use->role);
}

enum cs_status cs_file_conflicts_output(struct cs_file_conflicts *conflicts, const char *path,
                                        const char *what, struct cs_error *error) {
    struct cs_file_use use;
    struct stat device;
    if (!stat_file(path, what, true, &use) || (!stat(path, &device) && S_ISCHR(device.st_mode)))
        return CS_OK; // writing it will say why it cannot be; a device is harmed by nothing
    for (unsigned k = 0; k < conflicts->n; k++)
        if (is_same(&use, conflicts->items + k))
            return refuse_use(conflicts->items + k, path, what, error);
    if (conflicts->n < CS_FILE_CONFLICTS_MAX)
        conflicts->items[conflicts->n++] = use;
    return CS_OK;
}

enum cs_status cs_file_conflicts_pair(const char *output, const char *what, const char *input,
                                      const char *role, struct cs_error *error) {
    struct cs_file_use written, read;
    return output && stat_file(input, role, false, &read) &&
                   stat_file(output, what, true, &written) && is_same(&written, &read)
               ? refuse_use(&read, output, what, error)
               : CS_OK;
}

enum cs_status cs_file_conflicts_folder(const struct cs_file_conflicts *conflicts,
                                        const char *folder, bool (*is_ours)(const char *name),
                                        const char *what, struct cs_error *error) {
    struct stat info;
    if (stat(folder, &info))
        return CS_OK;
    for (unsigned k = 0; k < conflicts->n; k++) {
        const struct cs_file_use *use = conflicts->items + k;
        char path[4096], target[CS_FILE_NAME_BYTES];
        const bool on_the_way = cs_file_is_temporary(use->name, target);
        if (use->folder_device_id != info.st_dev || use->folder_inode != info.st_ino ||
            !is_ours(on_the_way ? target : use->name))
            continue;
        snprintf(path, sizeof path, "%.3800s/%s", folder, use->name);
        return refuse_use(use, path, what, error);
    }
    return CS_OK;
}
