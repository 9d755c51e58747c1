/* run_folder.h - folders of a run's numbered files: locks, earlier files, and states. */
#ifndef CS_RUN_FOLDER_H
#define CS_RUN_FOLDER_H

#include "base/status.h"
#include "base/text.h"
#include "cli/line/args.h"
#include "session/session.h"

/* Predicates on file names that a run writes: numbered frame_*.png, run.json, run.checkpoint
 * and exports; or numbered x_*.npy and v_*.npy; and manifest.txt. */
bool cs_output_is_result(const char *name);
bool cs_output_is_state(const char *name);

typedef bool cs_output_kind(const char *name);

/* Looks for files of an earlier run in a folder (NULL or absent: fine). CS_ERR_FILE names the
 * first one. */
enum cs_status cs_output_check(const char *folder, cs_output_kind *is_ours,
                               struct cs_error *error);

/* The same for one file; a device or a FIFO is no earlier file. */
enum cs_status cs_output_check_file(const char *path, struct cs_error *error);

/* Treatment of files of an earlier run. */
enum cs_output_earlier { CS_OUTPUT_REFUSE, CS_OUTPUT_REMOVE, CS_OUTPUT_RESUME };

/* A folder that this process writes into, alone. */
struct cs_output {
    int folder_lock; /* file descriptor + 1; 0: none, or the other output has it */
};

/* Creates the folder (unless earlier files are kept), locks it until release or the end of the
 * process, and treats earlier files as requested. Half-written files of killed runs are removed
 * in any case. other: an output of this run that may have the same folder, or NULL. CS_ERR_FILE
 * if another run has the lock. */
enum cs_status cs_output_lock_folders(struct cs_output *output, const struct cs_output *other,
                                      const char *folder, cs_output_kind *is_ours,
                                      enum cs_output_earlier earlier, struct cs_error *error);

/* Releases the lock, if there is one. */
void cs_output_unlock_folders(struct cs_output *output);

/* Writes x_NUMBER.npy and v_NUMBER.npy of n particles. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_output_state(const char *folder, uint32_t number, const double *x,
                               const double *v, uint32_t n, struct cs_error *error);

/* Refuses output paths that would overwrite an input of the study. */

/* CS_ERR_FILE if the path that an option gives, neither NULL nor "-", is the session's scene or
 * one of its modules. Files are compared as such, not by their paths. */
enum cs_status cs_study_output_check(const struct cs_session_settings *session,
                                     const char *path, const char *option,
                                     struct cs_error *error);
/* CS_ERR_FILE if one of the files (names closed by NULL) to be written into the folder is one
 * of these. */
enum cs_status cs_study_files_check(const struct cs_session_settings *session,
                                    const char *folder, const char *const *names,
                                    struct cs_error *error);

/* CS_ERR_USAGE if the folder is that of the session's scene: results would lie among scenes. */
enum cs_status cs_study_folder_check(const struct cs_session_settings *session,
                                     const char *folder, struct cs_error *error);

/* Adds the line of a study for its report: "clothsim NAME OPERANDS --OPTION VALUE". */
void cs_study_print_command(const struct cs_args *args, const char *name, struct cs_text *out);

#endif
