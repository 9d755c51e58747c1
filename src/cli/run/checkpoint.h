/* checkpoint.h - a record of a run in a file, with the facts that it belongs to and a checksum.
 *
 *   clothsim checkpoint 1
 *   NAME LENGTH, newline, LENGTH bytes of the value, newline: for each fact
 *   record LENGTH, newline, LENGTH bytes of the record, newline
 *   command LENGTH, newline, LENGTH bytes of the command line, newline: if there is one
 *   hash of all bytes before it, in 32 hexadecimal digits, newline
 *
 * Lengths are stated, so values may hold any bytes. The checksum covers everything, so a file
 * that was cut off or changed in any byte is refused.
 *
 * Atomicity: a new checkpoint is written to a temporary file, flushed to the disk and renamed
 * over the old one. After a crash or a loss of power at any moment the path holds the old
 * checkpoint or the new one, whole. A continued run thus always has a state to start from.
 */
#ifndef CS_CHECKPOINT_H
#define CS_CHECKPOINT_H

#include "base/serialise.h"
#include "base/status.h"
#include "base/text.h"

/* A fact that must be the same when the record is used again, such as the scene. Compared byte
 * by byte; borrowed. */
struct cs_checkpoint_key {
    const char *name; /* as in the message "another NAME"; no blanks */
    const char *value;
};

/* Replaces the file atomically and returns when the disk has it. Facts and record are only
 * read. command: words of the command line that the run needs, each closed by a newline; "":
 * none. On failure CS_ERR_FILE or CS_ERR_MEMORY, and an older file stays as it was. */
enum cs_status cs_checkpoint_write(const char *path, const struct cs_checkpoint_key *keys,
                                   uint32_t n_facts, const struct cs_serialiser *serialiser,
                                   const char *command, struct cs_error *error);

/* Adds the command of a checkpoint to a text. CS_ERR_FILE if the file cannot be read, is
 * damaged, or has none; CS_ERR_MEMORY. */
enum cs_status cs_checkpoint_read_command(const char *path, struct cs_text *command,
                                          struct cs_error *error);

/* Reads a checkpoint, as a record positioned at its first byte. Facts must be those of the
 * writer, in its order. Fails with CS_ERR_FILE if the file cannot be read, is damaged in any
 * byte, or a fact differs: the message then shows both values. The caller finishes the record,
 * also after a failure. */
enum cs_status cs_checkpoint_read(const char *path, const struct cs_checkpoint_key *keys,
                                  uint32_t n_facts, struct cs_serialiser *serialiser,
                                  struct cs_error *error);

#endif
