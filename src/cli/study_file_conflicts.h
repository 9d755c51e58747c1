/* study_file_conflicts.h - refuses output paths that would overwrite an input of the study. */
#ifndef CS_STUDY_FILE_CONFLICTS_H
#define CS_STUDY_FILE_CONFLICTS_H

#include "study/session.h"

/* CS_ERR_FILE if one of the files (names closed by NULL) to be written into the folder is the
 * session's scene or one of its modules. Files are compared as such, not by their paths. */
enum cs_status cs_study_files_check(const struct cs_session_settings *session,
                                    const char *folder, const char *const *names,
                                    struct cs_error *error);

#endif
