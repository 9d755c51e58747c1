/* series.h - the name of a series: a method with its options, the same in every output of a
 * study. */
#ifndef CS_SERIES_H
#define CS_SERIES_H

#include "base/text.h"
#include "sim/method.h"

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
