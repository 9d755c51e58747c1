/* The parser of NAME:key=value,... that every command uses. */
#include "sim/method.h"

#include "base/options.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

enum cs_status cs_method_init(struct cs_method *method, const struct cs_integrator *integrator,
                              const void *options, struct cs_error *error) {
    *method = (struct cs_method){.integrator = integrator,
                                 .table = {.rows = integrator->options,
                                           .n = integrator->n_options,
                                           .size = integrator->options_size}};
    method->options = calloc(1, method->table.size + 1);
    if (!method->options)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of %s",
                       integrator->name);
    if (options)
        memcpy(method->options, options, method->table.size);
    else
        cs_options_default(&method->table, method->options);
    return CS_OK;
}

void cs_method_finish(struct cs_method *method) {
    free(method->options);
    *method = (struct cs_method){0};
}

enum cs_status cs_method_find(struct cs_method *method, struct cs_registry *registry,
                              const char *text, const char **pairs, struct cs_error *error) {
    const size_t length = strcspn(text, ":");
    const struct cs_registered *found;
    *method = (struct cs_method){0};
    *pairs = text[length] ? text + length + 1 : NULL;
    if (length == 0 || strcspn(text, "=,") < length)
        return cs_fail(error, CS_ERR_USAGE,
                       "found integrator \"%.60s\", expected NAME or NAME:key=value,...", text);
    char *name = strndup(text, length);
    if (!name)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the name of an integrator");
    else if (!cs_registry_find(registry, name, &found, error))
        cs_method_init(method, found->integrator, NULL, error);
    free(name);
    return error->status;
}

enum cs_status cs_method_read(struct cs_method *method, struct cs_registry *registry,
                              const char *text, struct cs_error *error) {
    const char *pairs;
    return cs_method_find(method, registry, text, &pairs, error)
               ? error->status
               : cs_method_set_pairs(method, pairs, error);
}

enum cs_status cs_method_set_pairs(struct cs_method *method, const char *pairs,
                                   struct cs_error *error) {
    char *copy = pairs ? strdup(pairs) : NULL, *rest = copy;
    const char *key, *value;
    if (pairs && !copy)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of %s",
                       method->integrator->name);
    while (rest && !cs_method_take_pair(method->integrator->name, &rest, &key, &value, error) &&
           !cs_method_set(method, key, value, NULL, CS_ERR_USAGE, error))
        ;
    free(copy);
    return error->status;
}

static enum cs_status unknown_option(const struct cs_method *method, const char *where,
                                     const char *key, enum cs_status status,
                                     struct cs_error *error) {
    const char *nearest = cs_option_nearest(&method->table, key);
    return cs_fail(error, status, "%s: no such option%s%s%s (see: clothsim integrators %s)",
                   where, nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                   nearest ? "\"?" : "", method->integrator->name);
}

enum cs_status cs_method_set(struct cs_method *method, const char *key, const char *value,
                             const char *place, enum cs_status status, struct cs_error *error) {
    const struct cs_option *row = cs_option_find(&method->table, key);
    struct cs_text where = {0};
    if (place)
        cs_text_add(&where, "%s%.60s", place, key);
    else
        cs_text_add(&where, "integrator \"%s\": %.60s", method->integrator->name, key);
    if (row)
        cs_option_set(row, method->options, value, cs_text_get(&where), status, error);
    else
        unknown_option(method, cs_text_get(&where), key, status, error);
    cs_text_finish(&where);
    return error->status;
}

static bool is_option(const char *token) {
    const size_t length = strcspn(token, ",:=");
    return token[length] == '=';
}

char *cs_method_split(char **list) {
    char *method = *list, *comma = method;
    while (comma && (comma = strchr(comma, ',')) && is_option(comma + 1))
        comma++;
    if (comma)
        *comma++ = 0;
    *list = comma;
    return method;
}

enum cs_status cs_method_take_pair(const char *name, char **pairs, const char **key,
                                   const char **value, struct cs_error *error) {
    char *pair = strsep(pairs, ","), *equals = strchr(pair, '=');
    if (!equals)
        return cs_fail(error, CS_ERR_USAGE,
                       "integrator \"%s\": found \"%.60s\", expected key=value", name, pair);
    *equals = 0;
    *key = pair;
    *value = equals + 1;
    return CS_OK;
}

static const struct cs_option *find_dt(const struct cs_integrator *integrator) {
    const struct cs_table table = {.rows = integrator->options, .n = integrator->n_options};
    const struct cs_option *row = cs_option_find(&table, "dt");
    return row && row->type == CS_REAL ? row : NULL;
}

bool cs_method_takes_dt(const struct cs_integrator *integrator) {
    return !(integrator->traits & CS_ADAPTIVE) && find_dt(integrator);
}

bool cs_method_set_dt(struct cs_method *method, double dt) {
    const struct cs_option *row = find_dt(method->integrator);
    if (!cs_method_takes_dt(method->integrator) || !(dt >= row->min && dt <= row->max))
        return false;
    memcpy((char *)method->options + row->offset, &dt, sizeof dt);
    return true;
}
