/* study_file_conflicts.h - what a study reads is not overwritten by what it writes. */
#ifndef CS_STUDY_FILE_CONFLICTS_H
#define CS_STUDY_FILE_CONFLICTS_H

#include "study/session.h"

/* CS_ERR_FILE where one of the files (closed by NULL) that are to be written into the folder is
 * the session's scene or one of its modules, whatever the paths look like. */
enum cs_status cs_study_files_check(const struct cs_session_settings *session,
                                    const char *folder, const char *const *names,
                                    struct cs_error *error);

#endif
