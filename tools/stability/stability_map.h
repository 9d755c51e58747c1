/* stability_map.h - makes, prints and writes the maps of clothsim stability. */
#ifndef CS_STABILITY_MAP_H
#define CS_STABILITY_MAP_H

#include "borders/stability.h"

/* Options of the command. */
struct cs_stability_options {
    struct cs_stability_settings map;
    const char *const *methods; /* (n_methods) */
    uint32_t n_methods;
    enum cs_axis axis;           /* CS_AXES: not named */
    const char *values[CS_AXES]; /* LOW..HIGH of the axes, one of them at most, or NULL */
    const char *dt;              /* likewise */
    const char *json;            /* of the extreme scenes */
    uint32_t frames;             /* 0: by the time */
    const char *catalogue;       /* their folder; NULL: the installed one */
    bool overwrite, extreme, show, strict, quiet;
};

/* Makes the map of one method, options->map.session.integrator, and writes its files. */
enum cs_status cs_stability_map_one(const struct cs_stability_options *options,
                                    struct cs_error *error);

/* Makes the maps of all methods with a fixed step; the others are named. */
enum cs_status cs_stability_map_all(struct cs_stability_options *options,
                                    struct cs_error *error);

#endif
