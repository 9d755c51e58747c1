/* Lists the files that a run reads, and holds its outputs against them and each other. */
#include "cli/run/run_file_conflicts.h"

#include "cli/run_output.h"
#include "io/file_conflicts.h"
#include "study/provenance_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void claim_input(void *ctx, const char *path, const char *what) {
    cs_file_conflicts_input(ctx, path, what);
}

static void claim_inputs(const struct cs_session *session,
                         struct cs_file_conflicts *conflicts) {
    cs_scene_each_file(&session->scene, claim_input, conflicts);
    for (uint32_t k = 0; k < session->settings.n_plugins; k++)
        cs_file_conflicts_input(conflicts, session->settings.plugins[k], "a module");
}

static void claim_file(struct cs_file_conflicts *conflicts, const char *path, const char *what,
                       struct cs_error *error) {
    if (path && strcmp(path, "-") != 0 && !error->status)
        cs_file_conflicts_output(conflicts, path, what, error);
}

static enum cs_status claim_outputs(struct cs_file_conflicts *conflicts,
                                    const struct cs_run_outputs *outputs,
                                    struct cs_error *error) {
    claim_file(conflicts, outputs->json, "--json", error);
    claim_file(conflicts, outputs->monitor_file, "--watch", error);
    claim_file(conflicts, outputs->ledger, "--ledger", error);
    if (error->status)
        return error->status;
    if (outputs->states && cs_file_conflicts_folder(conflicts, outputs->states,
                                                    cs_output_is_state, "--states", error))
        return error->status;
    return outputs->folder ? cs_file_conflicts_folder(conflicts, outputs->folder,
                                                      cs_output_is_result, "--out", error)
                           : CS_OK;
}

enum cs_status cs_run_check_claims(const struct cs_session *session,
                                   const struct cs_run_outputs *outputs,
                                   struct cs_error *error) {
    struct cs_file_conflicts *conflicts = calloc(1, sizeof *conflicts);
    if (!conflicts)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of files");
    claim_inputs(session, conflicts);
    claim_outputs(conflicts, outputs, error);
    free(conflicts);
    return error->status;
}

enum cs_status cs_run_check_fresh(const struct cs_run_outputs *outputs,
                                  struct cs_error *error) {
    const char *const files[] = {outputs->json, outputs->monitor_file, outputs->ledger};
    if (cs_output_check(outputs->folder, cs_output_is_result, error))
        return error->status;
    for (size_t k = 0; k < sizeof files / sizeof *files; k++)
        if (files[k] && strcmp(files[k], "-") != 0 && cs_output_check_file(files[k], error))
            return error->status;
    return cs_output_check(outputs->states, cs_output_is_state, error);
}
