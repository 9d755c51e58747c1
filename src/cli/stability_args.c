/* Holds the options of clothsim stability and reads them into its settings. */
#include "cli/stability_args.h"

#include "base/pool.h"
#include "cli/line/interrupt.h"
#include "study/process_pool.h"

#include <string.h>

const struct cs_arg cs_stability_rows[STABILITY_ROWS] = {
    [STABILITY_INTEGRATORS] = {"integrators", 'i', "LIST",
                               "methods, NAME:KEY=VALUE,...,NAME...; all: every method; "
                               "may be repeated (default: the scene's own)",
                               true},
    [STABILITY_AXIS] = {"axis", 0, "NAME",
                        "stiffness, damping, mass or resolution (default: stiffness)", false},
    [STABILITY_STIFFNESS] = {"stiffness", 0, "LOW..HIGH",
                             "that axis and its values in N/m: the stiffest kind of spring, "
                             "others in proportion",
                             false},
    [STABILITY_DAMPING] = {"damping", 0, "LOW..HIGH", "that axis, in N s/m", false},
    [STABILITY_MASS] = {"mass", 0, "LOW..HIGH", "that axis, in kg of the first particle",
                        false},
    [STABILITY_RESOLUTION] = {"resolution", 0, "LOW..HIGH", "that axis, in columns of the grid",
                              false},
    [STABILITY_DT] = {"dt", 0, "LOW..HIGH", "steps in s (default: round the expected border)",
                      false},
    [STABILITY_COLUMNS] = {"columns", 0, "N", "values on the axis (default: 9)", false},
    [STABILITY_STEPS] = {"rows", 0, "N", "values of dt (default: 15)", false},
    [STABILITY_TIME] = {"time", 't', "SECONDS", "simulated by a cell (default: 0.5)", false},
    [STABILITY_BUDGET] = {"budget", 0, "SECONDS",
                          "processor time that one cell may take (default: 5)", false},
    [STABILITY_JOBS] = {"jobs", 'j', "N", "cells at a time (default: one a processor)", false},
    [STABILITY_SET] = {"set", 's', "PATH=VALUE",
                       "another value for a key of the scene; may be repeated", true},
    [STABILITY_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
                          true},
    [STABILITY_OUT] = {"out", 'o', "DIR",
                       "folder for NAME.csv, NAME_border.csv, NAME.json, NAME.gp and, with "
                       "gnuplot, NAME.png (default: stability)",
                       false},
    [STABILITY_OVERWRITE] = {"overwrite", 'y', NULL, "replace the files of an earlier map",
                             false},
    [STABILITY_EXTREME] = {"extreme", 0, NULL,
                           "run the catalogue of extreme scenes instead, with every method; "
                           "SCENE is then part of "
                           "a name",
                           false},
    [STABILITY_FOLDER] = {"folder", 0, "DIR",
                          "the catalogue's folder (default: scenes/extreme)", false},
    [STABILITY_SHARD] = {"shard", 0, "K/N",
                         "do the K-th of N shares of the columns; see: clothsim merge", false},
    [STABILITY_JSON] = {"json", 0, "FILE",
                        "with --extreme: write the rows as JSON too; -: to standard output",
                        false},
    [STABILITY_STRICT] = {"strict", 0, NULL,
                          "exit with 8 where a cell is unstable or its method failed", false},
    [STABILITY_QUIET] = {"quiet", 'q', NULL, "no progress and no tables", false},
};

static enum cs_status read_range(const struct cs_args *args, uint32_t row,
                                 struct cs_range *range, struct cs_error *error) {
    const char *text = cs_args_get(args, row);
    const char *dots = text ? strstr(text, "..") : NULL;
    char low[64] = "";
    if (!text)
        return CS_OK;
    if (dots && dots - text < (ptrdiff_t)sizeof low)
        memcpy(low, text, (size_t)(dots - text));
    if (!dots || !cs_parse_real(low, &range->from) || !cs_parse_real(dots + 2, &range->to) ||
        !(range->from > 0 && range->from <= range->to && range->to <= 1e15))
        return cs_fail(error, CS_ERR_USAGE,
                       "--%s: expected LOW..HIGH, both above 0, found \"%.60s\"",
                       cs_stability_rows[row].name, text);
    return CS_OK;
}

/* The axis by its name, or by the option that holds its values. */
static enum cs_status read_axis(const struct cs_args *args,
                                struct cs_stability_settings *settings,
                                struct cs_error *error) {
    int axis = -1, named = -1;
    /* the options of the axes stand in the order of enum cs_axis */
    for (uint32_t row = STABILITY_STIFFNESS; row <= STABILITY_RESOLUTION; row++) {
        if (!cs_args_get(args, row))
            continue;
        if (axis >= 0)
            return cs_fail(error, CS_ERR_USAGE, "--%s and --%s: a map has one axis",
                           cs_axis_names[axis], cs_stability_rows[row].name);
        axis = (int)(row - STABILITY_STIFFNESS);
        if (read_range(args, row, &settings->values, error))
            return error->status;
    }
    if (cs_args_choice(args, STABILITY_AXIS, cs_axis_names, &named, error))
        return error->status;
    if (axis >= 0 && named >= 0 && axis != named)
        return cs_fail(error, CS_ERR_USAGE, "--axis %s and --%s: a map has one axis",
                       cs_axis_names[named], cs_axis_names[axis]);
    /* --axis may repeat what the option of the values says already */
    settings->axis = (enum cs_axis)(axis >= 0 ? axis : named >= 0 ? named : 0);
    return CS_OK;
}

enum cs_status cs_stability_read(struct cs_args *args, struct cs_stability_settings *settings,
                                 struct cs_error *error) {
    *settings =
        (struct cs_stability_settings){.columns = 9,
                                       .rows = 15,
                                       .seconds = 0.5,
                                       .budget = 5,
                                       .workers = cs_pool_processors(CS_PROCESS_POOL_MAX)};
    settings->session.run.stop = cs_interrupt_catch();
    /* no scene is no mistake here: --extreme needs none */
    settings->session.scene = args->n_operands ? args->operands[0] : NULL;
    if (cs_args_integer(args, STABILITY_COLUMNS, 1, CS_MAP_CELLS_MAX, &settings->columns,
                        error) ||
        cs_args_integer(args, STABILITY_STEPS, 1, CS_MAP_CELLS_MAX, &settings->rows, error) ||
        cs_args_integer(args, STABILITY_JOBS, 1, CS_PROCESS_POOL_MAX, &settings->workers,
                        error) ||
        cs_args_real(args, STABILITY_TIME, &settings->seconds, error) ||
        cs_args_real(args, STABILITY_BUDGET, &settings->budget, error) ||
        cs_args_shard(args, STABILITY_SHARD, &settings->shard, error) ||
        read_axis(args, settings, error) ||
        read_range(args, STABILITY_DT, &settings->dt, error) ||
        cs_args_overrides(args, STABILITY_SET, &settings->session.overrides,
                          &settings->session.n_overrides, error))
        return error->status;
    return cs_args_get_all(args, STABILITY_PLUGIN, &settings->session.plugins,
                           &settings->session.n_plugins, error);
}
