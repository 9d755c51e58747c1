/* row_log.h - a text file that grows by a row a frame, and is cut back when a run resumes.
 *
 *   create -> add ... -> finish      rows go to PATH.part, which is renamed to PATH at the end
 *   record -> resume -> add ...      a checkpoint holds length and hash of the rows; what was
 *                                    added after it is cut off
 * No row is kept in memory, and a killed run leaves its rows in PATH.part. */
#ifndef CS_ROW_LOG_H
#define CS_ROW_LOG_H

#include "base/hash.h"
#include "base/serialise.h"
#include "base/status.h"
#include "base/text.h"

#include <stdio.h>

/* Zeroed: closed. */
struct cs_row_log {
    FILE *file;                /* NULL: closed */
    bool streams;              /* to standard output, a device or a FIFO: nothing is renamed */
    uint64_t length;           /* bytes of whole rows */
    char hash[CS_HASH_DIGITS]; /* of each row with the hash before it; "": no rows */
    char path[4096], part[4104];
};

/* Opens PATH.part, empty, and locks it. path: a file; "-": rows go to standard output; a device
 * or a FIFO: there; NULL: to a file without a name, which ends with the process. CS_ERR_FILE,
 * also if another process has PATH.part. */
enum cs_status cs_row_log_create(struct cs_row_log *log, const char *path,
                                 struct cs_error *error);
/* Goes on after the rows of a record that was loaded, with those of PATH.part or of PATH, as a
 * copy. A stream goes on with the next row. CS_ERR_FILE if neither has these rows. */
enum cs_status cs_row_log_resume(struct cs_row_log *log, const char *path,
                                 struct cs_error *error);

/* Adds one line with its end, and frees the text; nothing for a closed log. It is with the
 * system when the call returns. CS_ERR_MEMORY if the text failed; CS_ERR_FILE. */
enum cs_status cs_row_log_add(struct cs_row_log *log, struct cs_text *row,
                              struct cs_error *error);
/* Stores or loads length and hash. */
void cs_row_log_record(struct cs_row_log *log, struct cs_serialiser *serialiser);
/* Waits until the disk has all rows. CS_ERR_FILE. */
enum cs_status cs_row_log_sync(const struct cs_row_log *log, struct cs_error *error);
/* Writes the first bytes of the rows to a stream, whose errors the caller looks at. CS_ERR_FILE
 * if they cannot be read. */
enum cs_status cs_row_log_copy(const struct cs_row_log *log, uint64_t bytes, FILE *out,
                               struct cs_error *error);

/* Closes the file and gives it its name, without what follows the last whole row. CS_ERR_FILE.
 */
enum cs_status cs_row_log_finish(struct cs_row_log *log, struct cs_error *error);
/* Closes and removes it; safe on a closed log. CS_ERR_FILE if it cannot be removed. */
enum cs_status cs_row_log_remove(struct cs_row_log *log, struct cs_error *error);

#endif
