/* append_file.h - a file that grows sample by sample and is whole after each: its path is its
 * own from the start, and its reader never looks behind what it says it holds. */
#ifndef CS_EXPORT_APPEND_FILE_H
#define CS_EXPORT_APPEND_FILE_H

#include "io/export/export_name.h"

#include <stddef.h>

/* Zeroed: closed. */
struct cs_append_file {
    int file;        /* descriptor + 1; 0: closed */
    uint64_t length; /* bytes */
    char path[CS_EXPORT_PATH];
};

/* A new file; or, kept above 0, the first bytes of one that is there. CS_ERR_FILE, as in all
 * below: also where that one is shorter. */
enum cs_status cs_append_file_open(struct cs_append_file *grown, const char *path,
                                   uint64_t kept, struct cs_error *error);

/* Writes n bytes from `at` on, which is not behind the end. Where that fails the file is no
 * longer than before. */
enum cs_status cs_append_file_write(struct cs_append_file *grown, uint64_t at,
                                    const void *bytes, size_t n, struct cs_error *error);

enum cs_status cs_append_file_read(const struct cs_append_file *grown, uint64_t at, void *bytes,
                                   size_t n, struct cs_error *error);

/* Returns when the disk has what was written. Closed: nothing. */
enum cs_status cs_append_file_sync(const struct cs_append_file *grown, struct cs_error *error);

void cs_append_file_close(struct cs_append_file *grown);

#endif
