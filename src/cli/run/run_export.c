/* Reads what is to be exported, and begins it. */
#include "cli/run/run_export.h"

#include <string.h>

/* the bit of a word of so many letters; 0: it is none */
static uint32_t bit_of(const char *word, size_t length, const char *const *names) {
    for (uint32_t k = 0; names[k]; k++)
        if (strlen(names[k]) == length && !strncmp(names[k], word, length))
            return 1u << k;
    return 0;
}

static enum cs_status refuse(const char *option, const char *list, const char *const *names,
                             struct cs_error *error) {
    char known[64] = "";
    for (size_t k = 0, at = 0; names[k] && at < sizeof known; k++)
        at += (size_t)snprintf(known + at, sizeof known - at, k ? ", %s" : "%s", names[k]);
    return cs_fail(error, CS_ERR_USAGE,
                   "%s: found \"%.60s\", expected some of %s, with commas between", option,
                   list, known);
}

static enum cs_status read_set(const char *option, const char *list, const char *const *names,
                               uint32_t *set, struct cs_error *error) {
    for (const char *word = list; word;) {
        const size_t length = strcspn(word, ",");
        const uint32_t bit = bit_of(word, length, names);
        if (!bit)
            return refuse(option, list, names, error);
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
        return cs_fail(error, CS_ERR_USAGE,
                       "--export-values: only files of VTP and NPZ hold values; expected one "
                       "of them in --export");
    return CS_OK;
}

enum cs_status cs_run_export_begin(struct cs_export *export,
                                   const struct cs_export_settings *settings,
                                   const struct cs_run *run, bool goes_on,
                                   struct cs_error *error) {
    struct cs_export_settings these = *settings;
    /* the start, and one every so many frames */
    these.kept = goes_on ? run->frame / these.every + 1 : 0;
    if (cs_export_open(export, &these, run->system, error) || goes_on)
        return error->status;
    return cs_export_take(export, run->frame, run->t, run->x, run->v, error);
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
