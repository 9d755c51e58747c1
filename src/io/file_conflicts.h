/* file_conflicts.h - the files that one run reads and writes: no input is overwritten, and no
 * two outputs are one file, whatever their paths look like. */
#ifndef CS_FILE_CONFLICTS_H
#define CS_FILE_CONFLICTS_H

#include "base/status.h"

#include <stdbool.h>
#include <sys/types.h>

/* A file by what it is, and by where it lies, since an output may not be there yet. */
struct cs_file_use {
    const char *role; /* borrowed, as in "is read as the scene" */
    dev_t device_id, folder_device_id;
    ino_t inode, folder_inode;
    bool exists, is_output;
    char name[256];
};

enum { CS_FILE_CONFLICTS_MAX = 256 };

/* Zeroed: none. Inputs beyond the most are not looked after. */
struct cs_file_conflicts {
    unsigned n;
    struct cs_file_use items[CS_FILE_CONFLICTS_MAX];
};

/* A file that is read; one that is not there is none. */
void cs_file_conflicts_input(struct cs_file_conflicts *conflicts, const char *path,
                             const char *what);

/* A file that is to be written, by the option `what`. CS_ERR_FILE where it is claimed. */
enum cs_status cs_file_conflicts_output(struct cs_file_conflicts *conflicts, const char *path,
                                        const char *what, struct cs_error *error);

/* A folder in which files of certain names are written, or removed: CS_ERR_FILE where one of
 * them is claimed. A folder that is not there holds none. */
enum cs_status cs_file_conflicts_folder(const struct cs_file_conflicts *conflicts,
                                        const char *folder, bool (*is_ours)(const char *name),
                                        const char *what, struct cs_error *error);

#endif
