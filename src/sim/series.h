/* series.h - a series: a method with its options, under one name in every output. */
#ifndef CS_SERIES_H
#define CS_SERIES_H

#include "base/text.h"
#include "sim/method.h"

enum { CS_SERIES_BYTES = 256 };

/* Takes SERIES off "SERIES=NAME:key=value": *text then begins with NAME, and name is "" where
 * there is no SERIES. CS_ERR_USAGE where it is none that a file can have. */
enum cs_status cs_series_parse_name(const char **text, char name[CS_SERIES_BYTES],
                                    struct cs_error *error);

/* Refuses the name of a series that is the name of another method: it would be taken for it. */
enum cs_status cs_series_check_name(struct cs_registry *registry, const char *name,
                                    const struct cs_method *method, struct cs_error *error);

/* "key=value,key=value" of the options that make a method another one than its defaults, in the
 * order of the table; without the one called except, which a study varies. */
void cs_method_add_options(const struct cs_method *method, const char *except,
                           struct cs_text *out);

/* The name of a series where it has none of its own: "NAME" or "NAME:options". CS_ERR_USAGE
 * where it is longer than CS_SERIES_BYTES. */
enum cs_status cs_series_name(const struct cs_method *method, const char *except,
                              char name[CS_SERIES_BYTES], struct cs_error *error);

/* The name of a series as part of the name of a file: no two series share one. */
void cs_series_file_name(const char *name, char file[CS_SERIES_BYTES]);

#endif
