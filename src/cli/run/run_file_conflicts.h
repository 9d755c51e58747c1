/* run_file_conflicts.h - no input of a run is overwritten, also with -y, and no two outputs are
 * one file.
 */
#ifndef CS_RUN_FILE_CONFLICTS_H
#define CS_RUN_FILE_CONFLICTS_H

#include "study/session.h"

/* What a run writes; NULL: none. */
struct cs_run_outputs {
    const char *json, *monitor_file, *ledger; /* files; json "-" is none */
    const char *states, *folder;              /* folders */
};

/* CS_ERR_FILE names the option, and what the file is beside. */
enum cs_status cs_run_check_claims(const struct cs_session *session,
                                   const struct cs_run_outputs *outputs,
                                   struct cs_error *error);

/* CS_ERR_FILE names the first that is there already. */
enum cs_status cs_run_check_fresh(const struct cs_run_outputs *outputs, struct cs_error *error);

#endif
