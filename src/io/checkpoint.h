/* checkpoint.h - a record in a file, with what it belongs to and a checksum over all of it.
 *
 *   clothsim checkpoint 1
 *   NAME LENGTH, then the bytes of the value, for each fact
 *   record LENGTH, then the bytes of the record
 *   the hash of all that, in hexadecimal digits
 */
#ifndef CS_CHECKPOINT_H
#define CS_CHECKPOINT_H

#include "base/serialise.h"
#include "base/status.h"

#include <stdint.h>

/* Something that must be the same where a record is used again. */
struct cs_checkpoint_key {
    const char *name; /* as in "another NAME" */
    const char *value;
};

/* Replaces the file by a whole new one, and returns when the disk has it. */
enum cs_status cs_checkpoint_write(const char *path, const struct cs_checkpoint_key *facts,
                                   uint32_t n_facts, const struct cs_serialiser *record,
                                   struct cs_error *error);

/* Reads what was written, as a record to load. CS_ERR_FILE where the file cannot be read, is
 * damaged in any byte, or a fact differs: the message then says what it is there and here.
 * record is to be finished. */
enum cs_status cs_checkpoint_read(const char *path, const struct cs_checkpoint_key *facts,
                                  uint32_t n_facts, struct cs_serialiser *record,
                                  struct cs_error *error);

#endif
