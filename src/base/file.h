/* file.h - whole files: read at once, or written beside the old file and renamed, so that no
 * reader sees half a file. */
#ifndef CS_FILE_H
#define CS_FILE_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Reads a regular file of at most max bytes into malloc'd memory, followed by a zero byte. The
 * caller frees *bytes. On failure returns CS_ERR_FILE or CS_ERR_MEMORY, and *bytes is NULL. */
enum cs_status cs_file_read(const char *path, size_t max, char **bytes, size_t *length,
                            struct cs_error *error);

/* A file being written: `path.tmp.PID`, which cs_file_finish renames. */
struct cs_file_out {
    FILE *file;   /* NULL: not open */
    bool durable; /* set after create: finish waits until the file is on disk */
    char path[4096], temporary[4160];
};
/* Opens the temporary file. The old file stays as it is. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_file_create(struct cs_file_out *out, const char *path,
                              struct cs_error *error);
/* Status of a failed system call, from its errno: CS_ERR_MEMORY or CS_ERR_FILE. */
enum cs_status cs_file_status(int reason);

/* Checks all earlier writes, closes and renames. On failure the temporary file is removed, and
 * the old file is intact. */
enum cs_status cs_file_finish(struct cs_file_out *out, struct cs_error *error);
/* Gives up: closes and removes the temporary file. Safe on a zeroed or finished struct. */
void cs_file_abandon(struct cs_file_out *out);

/* Removes a file that is no longer needed, if it is there. CS_ERR_FILE. */
enum cs_status cs_file_remove(const char *path, struct cs_error *error);

/* Writes a whole file by the three calls above. */
enum cs_status cs_file_write(const char *path, const void *bytes, size_t length,
                             struct cs_error *error);

/* Writes a text and frees it in any case. Returns CS_ERR_MEMORY if the text has failed, else
 * CS_ERR_FILE on failure. */
enum cs_status cs_file_write_text(const char *path, struct cs_text *text,
                                  struct cs_error *error);

/* The same as cs_file_write; the file is on disk when the call returns. */
enum cs_status cs_file_write_durable(const char *path, const void *bytes, size_t length,
                                     struct cs_error *error);

/* Makes a folder and its parents. An existing folder is no error. */
enum cs_status cs_folder_create(const char *path, struct cs_error *error);

#endif
