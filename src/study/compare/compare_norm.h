/* compare_norm.h - the error norms that a comparison can be ranked by. */
#ifndef CS_COMPARE_NORM_H
#define CS_COMPARE_NORM_H

#include "study/compare/compare_cell.h"
#include "study/reference/compare_reference_state.h"

/* Position norms come first (see compare_norm.c); all are distances to the reference. */
enum cs_norm {
    CS_NORM_END,
    CS_NORM_PATH,
    CS_NORM_LARGEST,
    CS_NORM_VELOCITY,
    CS_NORM_ENERGY,
    CS_NORMS
};

/* Values of --error-norm, closed by NULL, in the order of enum cs_norm. */
extern const char *const cs_norm_names[];
/* Its name in text, its unit ("" for none), and its column in compare.csv. */
const char *cs_norm_words(enum cs_norm norm);
const char *cs_norm_unit(enum cs_norm norm);
const struct cs_column *cs_norm_column(enum cs_norm norm);

/* True if the reference supports the norm: pointwise errors need a time before the horizon, the
 * energy error only families that agree. */
bool cs_norm_is_known(enum cs_norm norm, const struct cs_compare_reference *reference);
/* Error of a cell, not below the reference's own error; NAN if there is none. */
double cs_norm_of(enum cs_norm norm, const struct cs_cell *cell,
                  const struct cs_compare_reference *reference);
/* Error of a run without any information on the motion, in the unit of the norm; HUGE_VAL if
 * not known. */
double cs_norm_scale(enum cs_norm norm, const struct cs_compare_reference *reference);

#endif
