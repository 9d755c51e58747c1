/* parameter_sweep.h - runs a scene with every combination of values and methods: the Cartesian
 * product as cells, and each run as a row of one table. */
#ifndef CS_PARAMETER_SWEEP_H
#define CS_PARAMETER_SWEEP_H

#include "sweep/sweep_cell.h"

/* Runs the cells of the shard that sweep.csv lacks and no other process runs, each in a process
 * of its own. Each row is appended at once; when all cells are there, they are sorted. A cell
 * that is refused, fails or reaches its limit is a row. CS_ERR_USAGE if the file belongs to
 * another sweep, or values cannot be read; CS_ERR_MODULE if a method cannot be loaded;
 * CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *sweep, struct cs_error *error);

/* Counts the cells that are there or being run, and runs none. CS_ERR_USAGE, CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_parameter_sweep_count(struct cs_parameter_sweep *sweep,
                                        struct cs_error *error);

/* Merges the sweep.csv of folders, as far as they have one, into that of `out`; *n: rows.
 * unchecked: tables without checks are taken too. */
enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, bool unchecked, uint32_t *n,
                                        struct cs_error *error);

#endif
