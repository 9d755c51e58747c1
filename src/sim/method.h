/* method.h - an integrator with its options: what NAME:key=value,key=value says. */
#ifndef CS_METHOD_H
#define CS_METHOD_H

#include "base/text.h"
#include "sim/registry.h"

#include <clothsim/option.h>

/* Zeroed: none. */
struct cs_method {
    const struct cs_integrator *integrator; /* borrowed from its module */
    struct cs_table table;                  /* of its options */
    void *options;                          /* filled; owned */
    uint64_t given; /* a bit a row of the table: set by cs_method_set, not a default */
};

/* An integrator with a copy of options, NULL: its defaults. CS_ERR_MEMORY. */
enum cs_status cs_method_init(struct cs_method *method, const struct cs_integrator *integrator,
                              const void *options, struct cs_error *error);
void cs_method_finish(struct cs_method *method);

/* Reads NAME or NAME:key=value,... over the defaults; a NAME with a '/' is a module file, of
 * which the first integrator is meant. CS_ERR_USAGE with the nearest right name; whoever reads
 * methods does it by these calls, so that one mistake has one message. */
enum cs_status cs_method_read(struct cs_method *method, struct cs_registry *registry,
                              const char *text, struct cs_error *error);

/* The two halves of it: the integrator with its defaults, and what to do with the rest.
 * *pairs: behind the ':', NULL where there is none. */
enum cs_status cs_method_find(struct cs_method *method, struct cs_registry *registry,
                              const char *text, const char **pairs, struct cs_error *error);
/* "key=value,key=value"; NULL: nothing to set. */
enum cs_status cs_method_set_pairs(struct cs_method *method, const char *pairs,
                                   struct cs_error *error);

/* One option, by its name or its old one, which is reported. place stands before its name in a
 * message ("scene.json: integrator."), NULL: the integrator's name; status is that of a
 * failure. */
enum cs_status cs_method_set(struct cs_method *method, const char *key, const char *value,
                             const char *place, enum cs_status status, struct cs_error *error);

/* Refuses a given option, other than its default, that has no effect beside the others; place
 * and status as above. To be called when all are set, which cs_method_read and
 * cs_method_set_pairs do. */
enum cs_status cs_method_check(const struct cs_method *method, const char *place,
                               enum cs_status status, struct cs_error *error);

/* Whether an option was set, to its default or not. */
bool cs_method_is_given(const struct cs_method *method, const struct cs_option *row);
/* The number of a CHOICE. */
int32_t cs_method_choice(const struct cs_method *method, const struct cs_option *choice);

/* Where NAME begins in "SERIES=NAME:..."; NULL: there is no SERIES. */
const char *cs_method_after_series(const char *text);

/* Adds "NAME:key=value,..." with every option that has a value. */
void cs_method_describe(const struct cs_method *method, struct cs_text *out);

/* Cuts the next method off a list NAME:key=value,key=value,NAME,...; NULL: none is left. A
 * comma stands between methods and between options: what has no ':' round its '=' is an
 * option. */
char *cs_method_split(char **list);

/* Cuts the next key=value off *pairs, which becomes NULL behind the last; name: whose. */
enum cs_status cs_method_parse_pair(const char *name, char **pairs, const char **key,
                                    const char **value, struct cs_error *error);

/* Whether it steps by an option `dt` that can be set. */
bool cs_method_takes_dt(const struct cs_integrator *integrator);
/* Sets that option; false: it has none, is adaptive, or refuses the value. */
bool cs_method_set_dt(struct cs_method *method, double dt);

#endif
