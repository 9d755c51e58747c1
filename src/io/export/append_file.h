/* append_file.h - a file that grows sample by sample and is valid after each. It has its final
 * path from the start; its header or its list tells readers how much of it counts. */
#ifndef CS_EXPORT_APPEND_FILE_H
#define CS_EXPORT_APPEND_FILE_H

#include "io/export/export_name.h"

#include <stddef.h>

/* An open file; zeroed: closed. */
struct cs_append_file {
    int file;        /* descriptor + 1, so that 0 means closed */
    uint64_t length; /* bytes written completely */
    char path[CS_EXPORT_PATH];
};

/* Opens a new file; or, if kept > 0, an existing one, cut off after `kept` bytes: samples after
 * the checkpoint of a continued run are dropped. All calls fail with CS_ERR_FILE; this one also
 * if the existing file is shorter. Does not follow a symbolic link. */
enum cs_status cs_append_file_open(struct cs_append_file *grown, const char *path,
                                   uint64_t kept, struct cs_error *error);

/* Writes n bytes at offset `at`, at most the length. On failure the file is as long as
 * before. */
enum cs_status cs_append_file_write(struct cs_append_file *grown, uint64_t at,
                                    const void *bytes, size_t n, struct cs_error *error);

/* Reads n bytes at offset `at`; fewer are a failure. */
enum cs_status cs_append_file_read(const struct cs_append_file *grown, uint64_t at, void *bytes,
                                   size_t n, struct cs_error *error);

/* Returns when the disk has what was written. Does nothing if closed. */
enum cs_status cs_append_file_sync(const struct cs_append_file *grown, struct cs_error *error);

/* Closes the file; safe on a closed one. */
void cs_append_file_close(struct cs_append_file *grown);

#endif
