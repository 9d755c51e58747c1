/* Holds the list of the outputs that --out, --export, --hash and others ask for, and walks it.
 */
#include "cli/run/job_state.h"

#include "base/file.h"
#include "cli/file_conflicts.h"
#include "cli/manifest.h"
#include "session/provenance_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Order of the calls per frame: the report's row says which picture was begun, in which range.
 */
static const struct cs_run_output *const outputs[] = {
    &cs_run_output_trace,    &cs_run_output_watch, &cs_run_output_ledger, &cs_run_output_states,
    &cs_run_output_pictures, &cs_run_output_json,  &cs_run_output_export, &cs_run_output_hash,
};
enum { OUTPUTS = sizeof outputs / sizeof *outputs };
_Static_assert((int)OUTPUTS <= (int)CS_RUN_OUTPUTS_MAX, "too many outputs for one run");

/* File or folder of an output; NULL: none. */
static const char *path_of(const struct cs_job *job, const struct cs_run_output *output) {
    const char *path = NULL;
    CS_ASSERT(output->option || !output->is_ours);
    if (output->option)
        memcpy(&path, (const char *)job->settings + output->path, sizeof path);
    return path && !output->is_ours && !strcmp(path, "-") ? NULL : path;
}

static void claim_input(void *ctx, const char *path, const char *what) {
    cs_file_conflicts_input(ctx, path, what);
}

/* Registers the files that the run reads: the scene's files and the modules. */
static void claim_inputs(const struct cs_session *session,
                         struct cs_file_conflicts *conflicts) {
    cs_scene_each_file(session->scene, claim_input, conflicts);
    for (uint32_t k = 0; k < session->settings.n_plugins; k++)
        cs_file_conflicts_input(conflicts, session->settings.plugins[k], "a module");
}

/* Registers all outputs; a conflict with an input or another output fails. */
static enum cs_status check_claims(const struct cs_job *job, struct cs_error *error) {
    struct cs_file_conflicts *conflicts = calloc(1, sizeof *conflicts);
    if (!conflicts)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of files");
    claim_inputs(&job->session, conflicts);
    /* files first: each folder is held against them */
    for (int k = 0; k < OUTPUTS && !error->status; k++)
        if (path_of(job, outputs[k]) && !outputs[k]->is_ours)
            cs_file_conflicts_output(conflicts, path_of(job, outputs[k]), outputs[k]->option,
                                     error);
    for (int k = 0; k < OUTPUTS && !error->status; k++)
        if (path_of(job, outputs[k]) && outputs[k]->is_ours)
            cs_file_conflicts_folder(conflicts, path_of(job, outputs[k]), outputs[k]->is_ours,
                                     outputs[k]->option, error);
    free(conflicts);
    return error->status;
}

/* Looks for the file of an earlier run, and for the rows of one that was killed. */
static enum cs_status check_file(const char *path, struct cs_error *error) {
    char part[4104];
    snprintf(part, sizeof part, "%s.part", path);
    return cs_output_check_file(path, error) ? error->status
                                             : cs_output_check_file(part, error);
}

enum cs_status cs_run_outputs_check(const struct cs_job *job, struct cs_error *error) {
    if (check_claims(job, error) || job->settings->overwrite || job->settings->resume)
        return error->status;
    /* the pictures of an earlier run are named before other files of it */
    cs_output_check(job->settings->folder, cs_output_is_result, error);
    for (int k = 0; k < OUTPUTS && !error->status; k++) {
        const char *path = path_of(job, outputs[k]);
        if (path && outputs[k]->is_ours)
            cs_output_check(path, outputs[k]->is_ours, error);
        else if (path)
            check_file(path, error);
    }
    return error->status;
}

enum cs_status cs_run_outputs_at(struct cs_job *job, enum cs_run_stage stage,
                                 struct cs_error *error) {
    for (int k = 0; k < OUTPUTS && (!error->status || stage == CS_RUN_END); k++)
        if (outputs[k]->at[stage])
            outputs[k]->at[stage](job, error);
    return error->status;
}

/* True if the file lies in the folder of -o, which need not be there yet. */
static bool is_in_folder(const char *path, const char *folder) {
    const size_t length = folder ? strlen(folder) : 0;
    return length > 0 && !strncmp(path, folder, length) && path[length] == '/';
}

enum cs_status cs_run_outputs_open(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    const enum cs_output_earlier earlier = settings->resume      ? CS_OUTPUT_RESUME
                                           : settings->overwrite ? CS_OUTPUT_REMOVE
                                                                 : CS_OUTPUT_REFUSE;
    const struct cs_output *other = NULL;
    cs_run_outputs_at(job, CS_RUN_OPEN, error);
    for (int k = 0; k < OUTPUTS && !error->status; k++) {
        const char *path = path_of(job, outputs[k]);
        if (path && !outputs[k]->is_ours && is_in_folder(path, settings->out))
            cs_folder_create(settings->out, error);
        if (!path || !outputs[k]->is_ours)
            continue;
        cs_output_lock_folders(&job->folders[k], other, path, outputs[k]->is_ours, earlier,
                               error);
        other = &job->folders[k];
    }
    return error->status;
}

enum cs_status cs_run_outputs_consume(const struct cs_job *job, struct cs_error *error) {
    for (int k = 0; k < OUTPUTS && !error->status; k++)
        if (job->folders[k].folder_lock)
            cs_manifest_consume(path_of(job, outputs[k]), error);
    return error->status;
}

void cs_run_outputs_record(struct cs_job *job, struct cs_serialiser *serialiser) {
    for (int k = 0; k < OUTPUTS; k++)
        if (outputs[k]->record)
            outputs[k]->record(job, serialiser);
}

enum cs_status cs_run_outputs_sign(const struct cs_job *job, struct cs_error *error) {
    for (int k = 0; k < OUTPUTS && !error->status; k++)
        if (job->folders[k].folder_lock)
            cs_manifest_write(path_of(job, outputs[k]), error);
    return error->status;
}

/* Reads the options of exports, and exports a run. */

/* Bit of a word of that length; 0: unknown. */
static uint32_t bit_of(const char *word, size_t length, const char *const *names) {
    for (uint32_t k = 0; names[k]; k++)
        if (strlen(names[k]) == length && !strncmp(names[k], word, length))
            return 1u << k;
    return 0;
}

static enum cs_status refuse_name(const char *option, const char *list,
                                  const char *const *names, struct cs_error *error) {
    char known[64] = "";
    for (size_t k = 0, at = 0; names[k] && at < sizeof known; k++)
        at += (size_t)snprintf(known + at, sizeof known - at, k ? ", %s" : "%s", names[k]);
    return cs_fail(error, CS_ERR_USAGE,
                   "%s: found \"%.60s\", expected one or more of %s, separated by commas",
                   option, list, known);
}

/* Reads a list with commas as a set of bits. */
static enum cs_status read_set(const char *option, const char *list, const char *const *names,
                               uint32_t *set, struct cs_error *error) {
    for (const char *word = list; word;) {
        const size_t length = strcspn(word, ",");
        const uint32_t bit = bit_of(word, length, names);
        if (!bit)
            return refuse_name(option, list, names, error);
        *set |= bit;
        word = word[length] ? word + length + 1 : NULL;
    }
    return CS_OK;
}

enum cs_status cs_run_export_read(const char *formats, const char *values,
                                  struct cs_export_settings *settings, struct cs_error *error) {
    if (read_set("--export", formats, cs_export_format_names, &settings->formats, error) ||
        read_set("--export-values", values, cs_export_value_names, &settings->values, error))
        return error->status;
    if (values && !(settings->formats & cs_export_with_values()))
        return cs_fail(
            error, CS_ERR_USAGE,
            "--export-values: only VTP and NPZ files hold values; add vtp or npz to --export");
    return CS_OK;
}

static void print_set(uint32_t set, const char *const *names, struct cs_text *out) {
    for (uint32_t k = 0; names[k]; k++)
        if (set & 1u << k)
            cs_text_add(out, " %s", names[k]);
}

void cs_run_export_print(const struct cs_export_settings *settings, struct cs_text *out) {
    print_set(settings->formats, cs_export_format_names, out);
    print_set(settings->values, cs_export_value_names, out);
    if (!settings->formats)
        cs_text_add(out, " none");
}

/* Opens the export at the start of the run, or at the frame where it resumes. */
static enum cs_status begin_export(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const bool goes_on = job->settings->resume;
    struct cs_export_settings settings = job->settings->export;
    if (!settings.formats)
        return CS_OK;
    settings.folder = job->settings->folder;
    settings.frame_interval = job->settings->frame_interval;
    /* the start, and one every so many frames */
    settings.n_samples_before = goes_on ? run->frame / settings.frame_interval + 1 : 0;
    if (cs_export_open(&job->export, &settings, run->system, error) || goes_on)
        return error->status;
    return cs_export_write_sample(&job->export, run->frame, run->t, run->x, run->v, error);
}

static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    return cs_export_write_sample(&job->export, run->frame, run->t, run->x, run->v, error);
}

/* Before a checkpoint: the samples so far must be on disk, because a resumed run appends to
 * them. */
static enum cs_status settle(struct cs_job *job, struct cs_error *error) {
    return cs_job_makes_checkpoints(job->settings) ? cs_export_sync(&job->export, error)
                                                   : CS_OK;
}

static enum cs_status end(struct cs_job *job, struct cs_error *error) {
    return cs_export_finish(&job->export, cs_job_makes_checkpoints(job->settings), error);
}

const struct cs_run_output cs_run_output_export = {.at = {[CS_RUN_BEGIN] = begin_export,
                                                          [CS_RUN_FRAME] = frame,
                                                          [CS_RUN_SETTLE] = settle,
                                                          [CS_RUN_END] = end}};
