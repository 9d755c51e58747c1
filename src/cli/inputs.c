/* Holds the files that a study writes against those that it reads. */
#include "cli/inputs.h"

#include "io/claims.h"

#include <stdio.h>
#include <stdlib.h>

enum cs_status cs_inputs_keep(const struct cs_session_settings *session, const char *folder,
                              const char *const *names, struct cs_error *error) {
    struct cs_claims *claims = calloc(1, sizeof *claims);
    if (!claims)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of files");
    cs_claims_input(claims, session->scene, "the scene");
    for (uint32_t k = 0; k < session->n_plugins; k++)
        cs_claims_input(claims, session->plugins[k], "a module");
    for (; *names && !error->status; names++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, *names);
        cs_claims_output(claims, path, "--out", error);
    }
    free(claims);
    return error->status;
}
