/* stability_journal.h - stores the results of a map while it grows, so an interrupted map
 * resumes.
 *
 * FOLDER/SERIES.partial is a sequence of binary records of equal size: a key, a kind, a column,
 * a row, and a reference, a cell or a border. The key hashes everything the results depend on,
 * so records of a different map are skipped. Each record names its map and cell, hence the
 * order of records does not matter and files can be concatenated. */
#ifndef CS_STABILITY_JOURNAL_H
#define CS_STABILITY_JOURNAL_H

#include "study/stability/stability_state.h"

/* Opens FOLDER/SERIES.partial and takes over its results of the same map: same version, scene,
 * start, method, axis, steps, values, times. Each record is appended whole, by the process that
 * has it. Without a folder there is no journal, and all other calls do nothing. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_journal_open(struct cs_stability *map, struct cs_error *error);

/* Append the reference of a column, one of its cells, or its border. Called by worker
 * processes; the table locks the file. CS_ERR_FILE. */
enum cs_status cs_journal_append_reference(const struct cs_stability *map, uint32_t column,
                                           struct cs_error *error);
enum cs_status cs_journal_append_cell(const struct cs_stability *map, uint32_t column,
                                      uint32_t row, struct cs_error *error);
enum cs_status cs_journal_append_boundary(const struct cs_stability *map, uint32_t column,
                                          struct cs_error *error);

/* Deletes the file of a complete map. */
void cs_journal_remove(const struct cs_stability *map);

/* Appends the journals of the folders to those of the folder `out`; *n: journals read. A record
 * that is cut off at the end of a file is dropped. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_journal_merge(const char *const *folders, uint32_t n_folders, const char *out,
                                uint32_t *n, struct cs_error *error);

#endif
