/* stability_journal.h - what a map has so far, in a file that the next attempt goes on from. */
#ifndef CS_STABILITY_JOURNAL_H
#define CS_STABILITY_JOURNAL_H

#include "study/stability/stability_state.h"

/* Opens FOLDER/SERIES.partial and takes over what is there of the same map: scene, method,
 * axis, steps, times and version. Each record is appended whole, by whichever process has it.
 * Without a folder there is none. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_journal_open(struct cs_stability *map, struct cs_error *error);

/* Keep the reference of a column, one of its cells, or its border. */
enum cs_status cs_journal_append_reference(const struct cs_stability *map, uint32_t column,
                                           struct cs_error *error);
enum cs_status cs_journal_append_cell(const struct cs_stability *map, uint32_t column,
                                      uint32_t row, struct cs_error *error);
enum cs_status cs_journal_append_boundary(const struct cs_stability *map, uint32_t column,
                                          struct cs_error *error);

/* A map that is complete needs none. */
void cs_journal_remove(const struct cs_stability *map);

/* Appends the journals of folders to those of the folder out; *n: journals. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_journal_merge(const char *const *folders, uint32_t n_folders, const char *out,
                                uint32_t *n, struct cs_error *error);

#endif
