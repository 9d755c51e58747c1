/* method.c - the parser of NAME:key=value,... that every command uses.
 *
 * The grammar of a list of methods:
 *   list   = method { "," method }
 *   method = [ SERIES "=" ] NAME [ ":" pair { "," pair } ]
 *   NAME   = name | FILE | "program:" COMMAND | "tableau:" FILE
 *   pair   = key "=" value
 *
 * A comma separates both methods and pairs. A token between commas is a pair if it has a '=',
 * unless a ':' follows the token after the '=': then it is SERIES=NAME:... . A SERIES
 * therefore needs a method with options. */
#include "session/method.h"

#include <math.h>
#include <stdio.h>
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

size_t cs_method_name_length(const char *text) {
    const size_t begin = cs_names_program(text) ? strcspn(text, ":") + 1 : 0;
    return begin + strcspn(text + begin, ":");
}

enum cs_status cs_method_find(struct cs_method *method, struct cs_registry *registry,
                              const char *text, const char **pairs, struct cs_error *error) {
    const size_t length = cs_method_name_length(text);
    const bool is_program = cs_names_program(text);
    const struct cs_registry_entry *found;
    *method = (struct cs_method){0};
    *pairs = text[length] ? text + length + 1 : NULL;
    if (length == 0 || (!is_program && strcspn(text, "=,") < length))
        return cs_fail(error, CS_ERR_USAGE,
                       "found integrator \"%.60s\", expected NAME or NAME:key=value,...", text);
    char *name = strndup(text, length);
    if (!name)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the name of an integrator");
    else if (!(strchr(name, '/') && !is_program
                   ? cs_registry_find_in(registry, name, &found, error)
                   : cs_registry_find(registry, name, &found, error)))
        cs_method_init(method, found->integrator, NULL, error);
    free(name);
    return error->status;
}

/* The bit of a row in `given`. Rows from the 65th on have none, and never count as given. */
static uint64_t bit_of(const struct cs_method *method, const struct cs_option *row) {
    const ptrdiff_t k = row - method->table.rows;
    return k < 64 ? UINT64_C(1) << k : 0;
}

/* Fails if the option was given already. */
static enum cs_status refuse_twice(const struct cs_method *method, const char *key,
                                   struct cs_error *error) {
    const struct cs_option *row = cs_option_find(&method->table, key);
    if (row && method->given & bit_of(method, row))
        cs_fail(error, CS_ERR_USAGE, "integrator \"%s\": %.60s is given twice",
                method->integrator->name, key);
    return error->status;
}

enum cs_status cs_method_set_pairs(struct cs_method *method, const char *pairs,
                                   struct cs_error *error) {
    char *copy = pairs ? strdup(pairs) : NULL, *rest = copy;
    const char *key, *value;
    const uint64_t given = method->given; // by the scene
    if (pairs && !copy)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of %s",
                       method->integrator->name);
    method->given = 0;
    while (rest &&
           !cs_method_parse_pair(method->integrator->name, &rest, &key, &value, error) &&
           !refuse_twice(method, key, error) &&
           !cs_method_set(method, key, value, NULL, CS_ERR_USAGE, error))
        ;
    method->given |= given;
    free(copy);
    return error->status ? error->status : cs_method_check(method, NULL, CS_ERR_USAGE, error);
}

/* The error for a key that no row has, with the nearest one. */
static enum cs_status unknown_option(const struct cs_method *method, const char *where,
                                     const char *key, enum cs_status status,
                                     struct cs_error *error) {
    /* in a scene the method itself is a key beside its options */
    const bool of_scene = strstr(where, "integrator.");
    const char *nearest = of_scene && (!strcmp(key, "method") || !strcmp(key, "type"))
                              ? "name"
                              : cs_option_nearest(&method->table, key);
    return cs_fail(error, status, "%s: no such option%s%s%s (see: clothsim integrators %s)",
                   where, nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                   nearest ? "\"?" : "", method->integrator->name);
}

/* Adds the place of an option for a message: place and key, or the integrator and key. */
static void add_place(const struct cs_method *method, const char *place, const char *key,
                      struct cs_text *out) {
    if (place)
        cs_text_add(out, "%s%.60s", place, key);
    else
        cs_text_add(out, "integrator \"%s\": %.60s", method->integrator->name, key);
}

/* Says what an option is called now, on standard error, once for each text of a table. */
static void report_old_name(const char *name, const struct cs_option_rename *rename) {
    static const char *reported[16];
    static uint32_t n;
    for (uint32_t k = 0; k < n; k++)
        if (reported[k] == rename->old_name)
            return;
    if (n < sizeof reported / sizeof *reported)
        reported[n++] = rename->old_name;
    fprintf(stderr,
            "clothsim: %.60s:%s is now %.60s:%s; the old name goes in the next release\n", name,
            rename->old_name, name, rename->option);
}

/* The row of a name, or of the name that the last release had for it. */
static const struct cs_option *find_row(const struct cs_method *method, const char *key) {
    const struct cs_integrator *integrator = method->integrator;
    const uint32_t n = CS_HAS(integrator, n_renames) ? integrator->n_renames : 0;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_option_rename *rename = integrator->renames + k;
        if (strcmp(rename->old_name, key))
            continue;
        report_old_name(integrator->name, rename);
        return cs_option_find(&method->table, rename->option);
    }
    return cs_option_find(&method->table, key);
}

enum cs_status cs_method_set(struct cs_method *method, const char *key, const char *value,
                             const char *place, enum cs_status status, struct cs_error *error) {
    const struct cs_option *row = find_row(method, key);
    struct cs_text where = {0};
    add_place(method, place, key, &where);
    if (!row)
        unknown_option(method, cs_text_get(&where), key, status, error);
    else if (!cs_option_set(row, method->options, value, cs_text_get(&where), status, error))
        method->given |= bit_of(method, row);
    cs_text_finish(&where);
    return error->status;
}

/* The value of a CHOICE: its number among the names. */
static int32_t choice_of(const struct cs_method *method, const struct cs_option *choice) {
    int32_t value;
    memcpy(&value, (const char *)method->options + choice->offset, sizeof value);
    return value;
}

/* The error for an option without effect: names the values of the choice that give it one. */
static enum cs_status refuse_idle(const struct cs_method *method,
                                  const struct cs_option_use *use,
                                  const struct cs_option *choice, const char *place,
                                  enum cs_status status, struct cs_error *error) {
    struct cs_text where = {0}, expected = {0};
    add_place(method, place, use->option, &where);
    for (uint32_t k = 0; k < 32 && choice->choices[k]; k++)
        if (use->values >> k & 1)
            cs_text_add(&expected, "%s%s=%s", *cs_text_get(&expected) ? " or " : "",
                        choice->name, choice->choices[k]);
    cs_fail(error, status, "%s: has no effect with %s=%s, expected %s", cs_text_get(&where),
            choice->name, choice->choices[choice_of(method, choice)], cs_text_get(&expected));
    cs_text_finish(&where);
    cs_text_finish(&expected);
    return error->status;
}

enum cs_status cs_method_check(const struct cs_method *method, const char *place,
                               enum cs_status status, struct cs_error *error) {
    const struct cs_integrator *integrator = method->integrator;
    const uint32_t n = CS_HAS(integrator, n_uses) ? integrator->n_uses : 0;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_option_use *use = integrator->uses + k;
        const struct cs_option *row = cs_option_find(&method->table, use->option),
                               *choice = cs_option_find(&method->table, use->choice);
        // defaults pass: printed options list every value, also those without effect
        if ((method->given & bit_of(method, row)) &&
            !cs_option_is_default(row, method->options) &&
            !(use->values >> choice_of(method, choice) & 1))
            return refuse_idle(method, use, choice, place, status, error);
    }
    return CS_OK;
}

/* The start of NAME in "SERIES=NAME:..."; NULL if there is no SERIES. Only a ':' after the
 * '=' tells it from an option key=value. */
static const char *after_series(const char *token) {
    const size_t name = strcspn(token, ",:=");
    const char *method = token + name + 1;
    return token[name] == '=' && method[strcspn(method, ",:=")] == ':' ? method : NULL;
}

char *cs_method_split(char **list) {
    char *method = *list, *comma = method;
    // key=value, as against NAME, NAME:... and SERIES=NAME:...
    while (comma && (comma = strchr(comma, ',')) &&
           comma[1 + strcspn(comma + 1, ",:=")] == '=' && !after_series(comma + 1))
        comma++;
    if (comma)
        *comma++ = 0;
    *list = comma;
    return method;
}

enum cs_status cs_method_parse_pair(const char *name, char **pairs, const char **key,
                                    const char **value, struct cs_error *error) {
    char *pair = strsep(pairs, ","), *equals = strchr(pair, '=');
    if (!equals)
        return cs_fail(error, CS_ERR_USAGE,
                       "integrator \"%s\": found \"%.60s\", expected key=value%s", name, pair,
                       *pair && strspn(pair, "0123456789e-") == strlen(pair)
                           ? " (decimals have a point, as in 0.001)"
                           : "");
    *equals = 0;
    *key = pair;
    *value = equals + 1;
    return CS_OK;
}

/* The option dt of a method, if it is a real number; else NULL. */
static const struct cs_option *find_dt(const struct cs_integrator *integrator) {
    const struct cs_table table = {.rows = integrator->options, .n = integrator->n_options};
    const struct cs_option *row = cs_option_find(&table, "dt");
    return row && row->type == CS_REAL ? row : NULL;
}

uint32_t cs_method_order(const struct cs_integrator *integrator, const void *options,
                         bool damped) {
    const struct cs_table table = {.rows = integrator->options, .n = integrator->n_options};
    const struct cs_option *row = cs_option_find(&table, "order");
    int64_t asked;
    if (options && CS_HAS(integrator, order_of) && integrator->order_of)
        return integrator->order_of(options, damped);
    if (!options || !row || row->type != CS_INT)
        return damped ? integrator->order_damped : integrator->order;
    memcpy(&asked, (const char *)options + row->offset, sizeof asked);
    return (uint32_t)asked;
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

void cs_method_step_by_frames(struct cs_method *method) {
    const struct cs_option *row = find_dt(method->integrator);
    const double frame = HUGE_VAL;
    if (row && row->choices && method->integrator->traits & CS_IMPLICIT &&
        cs_option_is_default(row, method->options))
        memcpy((char *)method->options + row->offset, &frame, sizeof frame);
}

void cs_method_describe(const struct cs_method *method, struct cs_text *out) {
    cs_text_add(out, "%s", method->integrator->name);
    char mark = ':';
    for (uint32_t r = 0; r < method->table.n; r++) {
        const struct cs_option *row = method->table.rows + r;
        if (cs_option_is_optional(row) && !cs_option_is_set(row, method->options))
            continue;
        cs_text_add(out, "%c%s=", mark, row->name);
        cs_option_print_plain(row, method->options, out);
        mark = ',';
    }
}

/* Makes and checks the names of series, so that no two share one. */

enum cs_status cs_series_parse_name(const char **text, char name[CS_SERIES_BYTES],
                                    struct cs_error *error) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_+-";
    const char *method = after_series(*text);
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
        if (cs_option_is_default(row, options) || !strcmp(row->name, except))
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
