/* file.h - whole files: read at once; write beside and rename, so that none is ever half there.
 */
#ifndef CS_FILE_H
#define CS_FILE_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Reads a regular file of at most max bytes into malloc'd memory, with a zero behind it.
 * On failure CS_ERR_FILE (or CS_ERR_MEMORY) and *bytes is NULL. */
enum cs_status cs_file_read(const char *path, size_t max, char **bytes, size_t *length,
                            struct cs_error *error);

/* A file under way: written to `path.tmp.PID` and renamed by finish. */
struct cs_file_out {
    FILE *file;   /* NULL: not open */
    bool durable; /* set after create: finish waits until the disk has it */
    char path[4096], temporary[4160];
};
enum cs_status cs_file_create(struct cs_file_out *out, const char *path,
                              struct cs_error *error);
/* What a call that failed comes to, by its errno: CS_ERR_MEMORY or CS_ERR_FILE. */
enum cs_status cs_file_status(int reason);

/* Checks every earlier write, closes and renames; on failure the temporary is gone. */
enum cs_status cs_file_finish(struct cs_file_out *out, struct cs_error *error);
/* Gives up: closes and removes the temporary. Safe on a zeroed or finished one. */
void cs_file_abandon(struct cs_file_out *out);

/* Writes a whole text file by the three calls above. */
enum cs_status cs_file_write(const char *path, const void *bytes, size_t length,
                             struct cs_error *error);

/* Writes a text, whose memory is released. CS_ERR_FILE, CS_ERR_MEMORY where the text has
 * failed.
 */
enum cs_status cs_file_write_text(const char *path, struct cs_text *text,
                                  struct cs_error *error);

/* The same as cs_file_write, and the disk has it when the call returns. */
enum cs_status cs_file_write_durable(const char *path, const void *bytes, size_t length,
                                     struct cs_error *error);

/* Makes a folder and its parents; one that is there already is fine. */
enum cs_status cs_folder_create(const char *path, struct cs_error *error);

#endif
