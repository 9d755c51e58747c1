/* run_output.h - the numbered files of a run: what is there already, and the states. */
#ifndef CS_RUN_OUTPUT_H
#define CS_RUN_OUTPUT_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Looks for files of an earlier run in a folder (NULL or not there: fine): numbered
 * frame_*.png, run.json and run.checkpoint, or numbered x_*.npy and v_*.npy with states.
 * CS_ERR_FILE names the first that is there. */
enum cs_status cs_output_check(const char *folder, bool states, struct cs_error *error);

/* The same for one file. */
enum cs_status cs_output_check_file(const char *path, struct cs_error *error);

/* Makes the folder and, with `empty`, removes those files. */
enum cs_status cs_output_prepare(const char *folder, bool states, bool empty,
                                 struct cs_error *error);

/* Writes x_NUMBER.npy and v_NUMBER.npy of n particles. */
enum cs_status cs_output_state(const char *folder, uint32_t number, const double *x,
                               const double *v, uint32_t n, struct cs_error *error);

#endif
