/* compare_norm.h - the errors that a comparison can go by. */
#ifndef CS_COMPARE_NORM_H
#define CS_COMPARE_NORM_H

#include "study/compare/compare_cell.h"
#include "study/reference/compare_reference_state.h"

enum cs_norm {
    CS_NORM_END,
    CS_NORM_PATH,
    CS_NORM_LARGEST,
    CS_NORM_VELOCITY,
    CS_NORM_ENERGY,
    CS_NORMS
};

/* What --error-norm takes, closed by NULL. */
extern const char *const cs_norm_names[];
/* "position error", "m" (or ""), and the column that holds it. */
const char *cs_norm_words(enum cs_norm norm);
const char *cs_norm_unit(enum cs_norm norm);
const struct cs_column *cs_norm_column(enum cs_norm norm);

/* Whether the reference allows it: errors of position need a time before the horizon. */
bool cs_norm_is_known(enum cs_norm norm, const struct cs_compare_reference *reference);
/* The error of a cell; not below what the reference is known to. NAN: none. */
double cs_norm_of(enum cs_norm norm, const struct cs_cell *cell,
                  const struct cs_compare_reference *reference);
/* The error of one that has learnt nothing of the motion; HUGE_VAL: not known. */
double cs_norm_scale(enum cs_norm norm, const struct cs_compare_reference *reference);

#endif
