/* parameter_sweep.h - a scene with every combination of values and methods: the Cartesian
 * product as cells, and what each run came to as a row of one table. */
#ifndef CS_PARAMETER_SWEEP_H
#define CS_PARAMETER_SWEEP_H

#include "study/parameter_sweep_state.h"

/* Runs the cells of the shard that sweep.csv does not have. A row is kept as it comes, whoever
 * else writes there; when all cells are there, they are put in order. CS_ERR_USAGE where the
 * file is of another sweep; CS_ERR_INTERRUPT. */
enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *product,
                                      struct cs_error *error);

/* Joins the sweep.csv of folders, where they have one, into that of out; *n: rows. */
enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error);

#endif
