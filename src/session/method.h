/* method.h - an integrator with its options, as NAME:key=value,key=value gives them. */
#ifndef CS_METHOD_H
#define CS_METHOD_H

#include "base/options.h"
#include "base/text.h"
#include "sim/registry.h"

/* Any copy of it shares the options: only one may be finished. Zeroed: none. */
struct cs_method {
    const struct cs_integrator *integrator; /* borrowed from its module */
    struct cs_table table;                  /* of its options */
    void *options;                          /* filled; owned */
    uint64_t given; /* a bit per row of the table (the first 64): set by cs_method_set */
};

/* An integrator with a copy of options (its options_size bytes); options NULL: the defaults.
 * No row counts as given. CS_ERR_MEMORY. */
enum cs_status cs_method_init(struct cs_method *method, const struct cs_integrator *integrator,
                              const void *options, struct cs_error *error);

/* Frees the options and zeroes the method. */
void cs_method_finish(struct cs_method *method);

/* The length of NAME in NAME:key=value,...; it may be "program:COMMAND", without another colon.
 */
size_t cs_method_name_length(const char *text);

/* Reads NAME of NAME:key=value,...: the integrator with its defaults. *pairs is the text after
 * the ':', or NULL. A NAME with a '/' is a module file, and stands for its first integrator; a
 * program must have been added to the registry before. Every reader of methods uses this call
 * and the next, so that one mistake has one message. CS_ERR_USAGE with the nearest right name;
 * the caller finishes the method on failure too. */
enum cs_status cs_method_find(struct cs_method *method, struct cs_registry *registry,
                              const char *text, const char **pairs, struct cs_error *error);

/* Sets "key=value,key=value", each key once, and checks the result; pairs NULL sets nothing. */
enum cs_status cs_method_set_pairs(struct cs_method *method, const char *pairs,
                                   struct cs_error *error);

/* Sets one option, by its name or its old one, which is reported, and marks it as given. place
 * stands before its name in a message ("scene.json: integrator."); NULL: the integrator's name.
 * status is the one of a failure. */
enum cs_status cs_method_set(struct cs_method *method, const char *key, const char *value,
                             const char *place, enum cs_status status, struct cs_error *error);

/* Refuses a given option, other than its default, that has no effect with the values of the
 * others; place and status as above. Call it when all are set; cs_method_set_pairs
 * does. */
enum cs_status cs_method_check(const struct cs_method *method, const char *place,
                               enum cs_status status, struct cs_error *error);

/* Adds "NAME:key=value,..." with every option that has a value. */
void cs_method_describe(const struct cs_method *method, struct cs_text *out);

/* Cuts the next method off a list NAME:key=value,key=value,NAME,... and moves *list to the
 * next, NULL after the last. A comma separates both methods and options: a token with '=' is
 * an option, unless it is SERIES=NAME:... . Returns the method, zero-terminated in place. */
char *cs_method_split(char **list);

/* Cuts the next key=value off *pairs, which becomes NULL after the last. name: the
 * integrator, for the message. CS_ERR_USAGE without a '='. */
enum cs_status cs_method_parse_pair(const char *name, char **pairs, const char **key,
                                    const char **value, struct cs_error *error);

/* The order that a method claims with its options (NULL: the defaults), with damping or
 * without: by its order_of, an option "order", or its descriptor. */
uint32_t cs_method_order(const struct cs_integrator *integrator, const void *options,
                         bool damped);

/* True for a method of fixed steps with an option `dt`. */
bool cs_method_takes_dt(const struct cs_integrator *integrator);

/* Sets that option. Returns false if there is none, the method is adaptive, or dt is out of
 * range. */
bool cs_method_set_dt(struct cs_method *method, double dt);

/* Makes an implicit method whose dt is at its default take one step per frame. */
void cs_method_step_by_frames(struct cs_method *method);

/* The name of a series: a method with its options, the same in every output of a
 * study. */

/* Capacity of a name, with its zero. */
enum { CS_SERIES_BYTES = 256 };

/* Cuts SERIES off "SERIES=NAME:key=value": *text then begins with NAME. name is "" if there
 * is no SERIES. CS_ERR_USAGE if it has other characters than letters, digits and _ + -, or
 * more than 60: it becomes part of file names. */
enum cs_status cs_series_parse_name(const char **text, char name[CS_SERIES_BYTES],
                                    struct cs_error *error);

/* Refuses a name of a series that is another integrator's name: a table could not tell the
 * two apart. */
enum cs_status cs_series_check_name(struct cs_registry *registry, const char *name,
                                    const struct cs_method *method, struct cs_error *error);

/* Adds "key=value,key=value" of the options that differ from the defaults, in the order of
 * the table, without the option `except`, which a study varies. A given atol is added at its
 * default too. */
void cs_method_add_options(const struct cs_method *method, const char *except,
                           struct cs_text *out);

/* The default name of a series: "NAME" or "NAME:options". CS_ERR_USAGE if it does not fit
 * into CS_SERIES_BYTES. */
enum cs_status cs_series_name(const struct cs_method *method, const char *except,
                              char name[CS_SERIES_BYTES], struct cs_error *error);

/* The name of a series as part of a file name, ':' as '.': distinct names stay distinct. */
void cs_series_file_name(const char *name, char file[CS_SERIES_BYTES]);

#endif
