/* Describes the error norms of a comparison in one table. */
#include "study/compare/compare_state.h"

#include <math.h>

const char *const cs_norm_names[] = {"error", "path", "largest", "velocity", "energy", NULL};

/* One row per norm: text, unit, column, and whether it is a pointwise error. */
static const struct norm {
    const char *words, *unit, *column;
    bool of_particles;
} norms[CS_NORMS] = {
    [CS_NORM_END] = {"error", "m", "error", true},
    [CS_NORM_PATH] = {"path error", "m", "path_error", true},
    [CS_NORM_LARGEST] = {"largest error", "m", "max_error", true},
    [CS_NORM_VELOCITY] = {"velocity error", "m/s", "velocity_error", true},
    [CS_NORM_ENERGY] = {"energy error", "", "energy_error", false},
};

const char *cs_norm_words(enum cs_norm norm) {
    return norms[norm].words;
}

const char *cs_norm_unit(enum cs_norm norm) {
    return norms[norm].unit;
}

const struct cs_column *cs_norm_column(enum cs_norm norm) {
    return cs_column_find(norms[norm].column);
}

bool cs_norm_is_known(enum cs_norm norm, const struct cs_compare_reference *reference) {
    return norms[norm].of_particles ? reference->pointwise : reference->families_agree;
}

double cs_norm_of(enum cs_norm norm, const struct cs_cell *cell,
                  const struct cs_compare_reference *reference) {
    const double error = cs_cell_number(cell, cs_norm_column(norm));
    // the reference's own error is known for positions
    if (norm > CS_NORM_LARGEST || isnan(error))
        return error;
    return fmax(error,
                norm == CS_NORM_LARGEST ? reference->error_bar_max : reference->error_bar);
}

double cs_norm_scale(enum cs_norm norm, const struct cs_compare_reference *reference) {
    return norm <= CS_NORM_LARGEST  ? reference->motion_scale
           : norm == CS_NORM_ENERGY ? 1
                                    : HUGE_VAL;
}
