/* parameter_sweep.h - runs a scene with every combination of values and methods: the Cartesian
 * product as cells, and each run as a row of one table. */
#ifndef CS_PARAMETER_SWEEP_H
#define CS_PARAMETER_SWEEP_H

#include "study/parameter_sweep_state.h"

/* Runs the cells of the shard that sweep.csv lacks. Each row is appended at once, also while
 * other processes write; when all cells are there, they are sorted. CS_ERR_USAGE if the file
 * belongs to another sweep; CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *product,
                                      struct cs_error *error);

/* Merges the sweep.csv of folders, as far as they have one, into that of `out`; *n: rows. */
enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error);

#endif
