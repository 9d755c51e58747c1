/* Compares the files that a study writes with those that it reads. */
#include "cli/study_file_conflicts.h"

#include "io/file_conflicts.h"

#include <stdio.h>
#include <stdlib.h>

enum cs_status cs_study_files_check(const struct cs_session_settings *session,
                                    const char *folder, const char *const *names,
                                    struct cs_error *error) {
    struct cs_file_conflicts *conflicts = calloc(1, sizeof *conflicts);
    if (!conflicts)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of files");
    cs_file_conflicts_input(conflicts, session->scene, "the scene");
    for (uint32_t k = 0; k < session->n_plugins; k++)
        cs_file_conflicts_input(conflicts, session->plugins[k], "a module");
    for (; *names && !error->status; names++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, *names);
        cs_file_conflicts_output(conflicts, path, "--out", error);
    }
    free(conflicts);
    return error->status;
}
