/* run_output.h - the folders of a run's numbered files: who owns them, what is there already,
 * and the states. */
#ifndef CS_RUN_OUTPUT_H
#define CS_RUN_OUTPUT_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stdint.h>

/* What may be in a folder: numbered frame_*.png, run.json, run.checkpoint and what --export
 * writes; or numbered x_*.npy and v_*.npy; and manifest.txt. */
bool cs_output_is_result(const char *name);
bool cs_output_is_state(const char *name);
typedef bool cs_output_kind(const char *name);

/* Looks for files of an earlier run in a folder (NULL or not there: fine). CS_ERR_FILE names
 * the first that is there. */
enum cs_status cs_output_check(const char *folder, cs_output_kind *is_ours,
                               struct cs_error *error);

/* The same for one file. */
enum cs_status cs_output_check_file(const char *path, struct cs_error *error);

/* What becomes of the files of an earlier run. */
enum cs_output_earlier { CS_OUTPUT_REFUSE, CS_OUTPUT_REMOVE, CS_OUTPUT_KEEP };

/* A folder that this process writes into, alone. */
struct cs_output {
    int folder_lock; /* file descriptor + 1; 0: none, or the other output has it */
};

/* Makes the folder (but where earlier files are kept), becomes its owner until release or the
 * end of the process, and does with earlier files as told; what killed runs left half written
 * is removed in any case. other: an output of this run that may be the same folder, or NULL.
 * CS_ERR_FILE where another run is at work there. */
enum cs_status cs_output_lock_folders(struct cs_output *output, const struct cs_output *other,
                                      const char *folder, cs_output_kind *is_ours,
                                      enum cs_output_earlier earlier, struct cs_error *error);
void cs_output_unlock_folders(struct cs_output *output);

/* Writes x_NUMBER.npy and v_NUMBER.npy of n particles. */
enum cs_status cs_output_state(const char *folder, uint32_t number, const double *x,
                               const double *v, uint32_t n, struct cs_error *error);

#endif
