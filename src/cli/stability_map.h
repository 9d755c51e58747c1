/* stability_map.h - maps of clothsim stability: made, printed and written to a folder. */
#ifndef CS_STABILITY_MAP_H
#define CS_STABILITY_MAP_H

#include "study/stability/stability.h"

/* The options of the command. */
struct cs_stability_options {
    struct cs_stability_settings map;
    const char *const *methods; /* (n_methods) */
    uint32_t n_methods;
    enum cs_axis axis;           /* CS_AXES: not named */
    const char *values[CS_AXES]; /* LOW..HIGH of the axes, one of them at most, or NULL */
    const char *dt;              /* likewise */
    const char *json;            /* of the extreme scenes */
    const char *catalogue;       /* their folder; NULL: the installed one */
    bool overwrite, extreme, strict, quiet;
};

/* One method, options->map.session.integrator. */
enum cs_status cs_stability_map_one(const struct cs_stability_options *options,
                                    struct cs_error *error);

/* Every method with a fixed step; the others are named. */
enum cs_status cs_stability_map_all(struct cs_stability_options *options,
                                    struct cs_error *error);

#endif
