/* file.h - whole files: read at once, or written beside the old file and renamed, so that no
 * reader sees half a file.
 *
 * A path that is written leads to nothing or to a regular file, which is replaced, or a link to
 * one, which is replaced itself; or to a character device or a FIFO, which gets the bytes as
 * they come. All else is refused: folders, disks, sockets, and the file that standard output or
 * standard error goes to. */
#ifndef CS_FILE_H
#define CS_FILE_H

#include "base/status.h"
#include "base/text.h"

#include <stdio.h>

enum { CS_FILE_NAME_BYTES = 256 };

/* Reads a regular file of at most max bytes into malloc'd memory, followed by a zero byte. The
 * caller frees *bytes. On failure returns CS_ERR_FILE or CS_ERR_MEMORY, and *bytes is NULL. */
enum cs_status cs_file_read(const char *path, size_t max, char **bytes, size_t *length,
                            struct cs_error *error);

/* Begins a figure of a page with a picture of at most 64 MiB in the page itself, which needs no
 * other file; its caption and its end follow. Returns false, and adds nothing, where the file
 * cannot be read. alt: of the picture. */
bool cs_file_add_figure(const char *path, const char *alt, struct cs_text *out);

/* A file being written: `path.tmp.PID`, which is locked and which cs_file_finish renames. */
struct cs_file_out {
    FILE *file;   /* NULL: not open */
    bool durable; /* set after create: finish waits until the file is on disk */
    char path[4096], temporary[4160]; /* temporary "": a stream */
};
/* Opens the temporary file, or the stream. The old file stays as it is. CS_ERR_FILE,
 * CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_file_create(struct cs_file_out *out, const char *path,
                              struct cs_error *error);
/* Status of a failed system call, from its errno: CS_ERR_MEMORY, CS_ERR_INTERRUPT or
 * CS_ERR_FILE.
 */
enum cs_status cs_file_status(int reason);

/* Checks all earlier writes, closes and renames. On failure the temporary file is removed, and
 * the old file is intact. */
enum cs_status cs_file_finish(struct cs_file_out *out, struct cs_error *error);
/* Gives up: closes and removes the temporary file. Safe on a zeroed or finished struct. */
void cs_file_abandon(struct cs_file_out *out);

/* Sets *streams for a device or a FIFO. CS_ERR_FILE if the path cannot be written. */
enum cs_status cs_file_target(const char *path, bool *streams, struct cs_error *error);
/* Opens a device or a FIFO for writing; waits 10 s at most for the reader of a FIFO, or until a
 * signal. Returns the descriptor; -1 with CS_ERR_FILE or CS_ERR_INTERRUPT. */
int cs_file_open_stream(const char *path, struct cs_error *error);
/* Opens a regular file that grows in place for reading and writing, of one process or of all
 * that agree on a lock. A link, or a file with another name too, is refused: its rows would be
 * written over. flags: O_CREAT or 0. Returns the descriptor; -1 with CS_ERR_FILE. */
int cs_file_open_shared(const char *path, int flags, struct cs_error *error);
/* The same, locked against other processes. */
int cs_file_open_own(const char *path, int flags, struct cs_error *error);

/* True for NAME.tmp.DIGITS; target gets NAME. */
bool cs_file_is_temporary(const char *name, char target[CS_FILE_NAME_BYTES]);
/* Removes the temporary files that killed processes left of a file; with is_ours, of all files
 * in the folder `path` that it accepts. A living process has its own locked; where a file
 * system has no locks, they stay. */
void cs_file_sweep(const char *path, bool (*is_ours)(const char *name));

/* Gives a file that has grown in place its name. CS_ERR_FILE. */
enum cs_status cs_file_rename(const char *from, const char *to, struct cs_error *error);
/* Removes a file that is no longer needed, if it is there. CS_ERR_FILE. */
enum cs_status cs_file_remove(const char *path, struct cs_error *error);

/* Writes a whole file by the three calls above. */
enum cs_status cs_file_write(const char *path, const void *bytes, size_t length,
                             struct cs_error *error);

/* Writes a text and frees it in any case; sweeps the file. Returns CS_ERR_MEMORY if the text
 * has failed, else CS_ERR_FILE on failure. */
enum cs_status cs_file_write_text(const char *path, struct cs_text *text,
                                  struct cs_error *error);

/* The same as cs_file_write; the file is on disk when the call returns. */
enum cs_status cs_file_write_durable(const char *path, const void *bytes, size_t length,
                                     struct cs_error *error);

/* Makes a folder and its parents. An existing folder is no error. */
enum cs_status cs_folder_create(const char *path, struct cs_error *error);

#endif
