/* Reads the options of exports, and exports a run. */
#include "cli/run/job_state.h"

#include <string.h>

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
