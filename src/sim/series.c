/* series.c - makes and checks the names of series, so that no two share one. */
#include "sim/series.h"

#include "base/options.h"

#include <stdio.h>
#include <string.h>

enum cs_status cs_series_parse_name(const char **text, char name[CS_SERIES_BYTES],
                                    struct cs_error *error) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_+-";
    const char *method = cs_method_after_series(*text);
    const size_t length = method ? (size_t)(method - *text) - 1 : 0;
    *name = 0;
    if (!method)
        return CS_OK;
    if (length == 0 || length > 60 || strspn(*text, letters) < length)
        return cs_fail(error, CS_ERR_USAGE,
                       "found series \"%.60s\", expected up to 60 letters, digits and _ + -",
                       *text);
    snprintf(name, CS_SERIES_BYTES, "%.*s", (int)length, *text);
    *text = method;
    return CS_OK;
}

enum cs_status cs_series_check_name(struct cs_registry *registry, const char *name,
                                    const struct cs_method *method, struct cs_error *error) {
    const struct cs_registry_entry *found;
    struct cs_error unknown = {0};
    if (*name && strcmp(name, method->integrator->name) != 0 &&
        !cs_registry_find(registry, name, &found, &unknown))
        return cs_fail(error, CS_ERR_USAGE,
                       "found series \"%s\" of \"%s\", expected no other integrator's name",
                       name, method->integrator->name);
    return CS_OK;
}

void cs_method_add_options(const struct cs_method *method, const char *except,
                           struct cs_text *out) {
    bool any = false;
    for (uint32_t k = 0; k < method->table.n; k++) {
        const struct cs_option *row = method->table.rows + k;
        const void *options = method->options;
        // atol given at its default is not the same as atol left to a study
        const bool kept = !cs_option_is_default(row, options) ||
                          (!strcmp(row->name, "atol") && cs_method_is_given(method, row));
        if (!kept || !strcmp(row->name, except))
            continue;
        cs_text_add(out, "%s%s=", any ? "," : "", row->name);
        cs_option_print_plain(row, options, out);
        any = true;
    }
}

enum cs_status cs_series_name(const struct cs_method *method, const char *except,
                              char name[CS_SERIES_BYTES], struct cs_error *error) {
    struct cs_text options = {0};
    cs_method_add_options(method, except, &options);
    if (options.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the name of a series");
    else if (snprintf(name, CS_SERIES_BYTES, "%s%s%s", method->integrator->name,
                      *cs_text_get(&options) ? ":" : "",
                      cs_text_get(&options)) >= CS_SERIES_BYTES)
        cs_fail(error, CS_ERR_USAGE, "integrator \"%s\": options of more than %d characters",
                method->integrator->name, CS_SERIES_BYTES - 1);
    cs_text_finish(&options);
    return error->status;
}

void cs_series_file_name(const char *name, char file[CS_SERIES_BYTES]) {
    snprintf(file, CS_SERIES_BYTES, "%s", name);
    // a colon is special in paths of other programs; no name has a point
    for (char *c = file; (c = strchr(c, ':'));)
        *c = '.';
}
