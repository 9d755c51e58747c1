/* compare_reference_cache.h - stores a reference in a file for further comparisons of the
 * scene. */
#ifndef CS_COMPARE_REFERENCE_CACHE_H
#define CS_COMPARE_REFERENCE_CACHE_H

#include "study/reference/compare_reference_state.h"

/* Writes the hash of everything a reference depends on, CS_HASH_DIGITS characters.
 * CS_ERR_MEMORY. */
enum cs_status cs_compare_reference_key(const struct cs_compare_reference *reference,
                                        const struct cs_recorded_run *recording,
                                        const struct cs_compare_reference_settings *settings,
                                        char *key, struct cs_error *error);

/* Reads or writes DIR/reference-KEY.state. A file that does not match the scene, the machine or
 * its own hash counts as missing. */
bool cs_compare_reference_read(struct cs_compare_reference *reference, const char *folder,
                               const char *key, const struct cs_recorded_run *recording);
enum cs_status cs_compare_reference_write(const struct cs_compare_reference *reference,
                                          const char *folder, const char *key,
                                          struct cs_error *error);

#endif
