/* file_conflicts.h - checks that a run overwrites none of its inputs and writes no file twice,
 * whatever the paths look like. */
#ifndef CS_FILE_CONFLICTS_H
#define CS_FILE_CONFLICTS_H

#include "base/status.h"

#include <stdbool.h>
#include <sys/types.h>

/* A file of the run. An existing one is known by device and inode, so that links count; one
 * that does not exist yet by the device and inode of its folder and its name. */
struct cs_file_use {
    const char *role; /* borrowed, as in "is read as the scene" */
    dev_t device_id, folder_device_id;
    ino_t inode, folder_inode;
    bool exists, is_output;
    char name[256];
};

/* Inputs beyond so many are not tracked. */
enum { CS_FILE_CONFLICTS_MAX = 256 };

/* The files of a run; zeroed: none. */
struct cs_file_conflicts {
    unsigned n;
    struct cs_file_use items[CS_FILE_CONFLICTS_MAX];
};

/* Registers a file that the run reads, as `what`; ignores one that does not exist. */
void cs_file_conflicts_input(struct cs_file_conflicts *conflicts, const char *path,
                             const char *what);

/* Registers a file that the run will write, by the option `what`; character devices are left
 * out. CS_ERR_FILE if an input or another output is the same file or its temporary file
 * (NAME.part, NAME.tmp.DIGITS); it is then not registered. */
enum cs_status cs_file_conflicts_output(struct cs_file_conflicts *conflicts, const char *path,
                                        const char *what, struct cs_error *error);

/* Checks the one output of a command, the file that the option `what` names (NULL: none),
 * against a file that the command reads as `role`. CS_ERR_FILE if both are the same file, or
 * one is the temporary file of the other. */
enum cs_status cs_file_conflicts_pair(const char *output, const char *what, const char *input,
                                      const char *role, struct cs_error *error);

/* Checks a folder in which files of certain names will be written or removed: CS_ERR_FILE if
 * one of them, or a temporary file of one, is registered. A folder that does not exist holds
 * none. */
enum cs_status cs_file_conflicts_folder(const struct cs_file_conflicts *conflicts,
                                        const char *folder, bool (*is_ours)(const char *name),
                                        const char *what, struct cs_error *error);

#endif
