/* stability_args.h - the options of clothsim stability. */
#ifndef CS_STABILITY_ARGS_H
#define CS_STABILITY_ARGS_H

#include "cli/line/args.h"
#include "study/stability/stability.h"

enum {
    STABILITY_INTEGRATORS,
    STABILITY_AXIS,
    STABILITY_STIFFNESS,
    STABILITY_DAMPING,
    STABILITY_MASS,
    STABILITY_RESOLUTION,
    STABILITY_DT,
    STABILITY_COLUMNS,
    STABILITY_STEPS,
    STABILITY_TIME,
    STABILITY_BUDGET,
    STABILITY_JOBS,
    STABILITY_SET,
    STABILITY_PLUGIN,
    STABILITY_OUT,
    STABILITY_OVERWRITE,
    STABILITY_EXTREME,
    STABILITY_FOLDER,
    STABILITY_SHARD,
    STABILITY_JSON,
    STABILITY_STRICT,
    STABILITY_QUIET,
    STABILITY_ROWS
};

extern const struct cs_arg cs_stability_rows[STABILITY_ROWS];

/* What the options ask for; the integrator is left open. Texts stay those of args. */
enum cs_status cs_stability_read(struct cs_args *args, struct cs_stability_settings *settings,
                                 struct cs_error *error);

#endif
