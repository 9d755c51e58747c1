/* compare_reference_choice.h - chooses the two families of methods of a reference. */
#ifndef CS_COMPARE_REFERENCE_CHOICE_H
#define CS_COMPARE_REFERENCE_CHOICE_H

#include "study/reference/compare_reference_state.h"

/* Writes the tighter settings of "NAME:key=value,...": rtol and atol divided by 10, dt by 2.
 * CS_ERR_USAGE if they cannot be read or do not fit. */
enum cs_status cs_compare_reference_tighten(const char *integrator, char *out, size_t size,
                                            struct cs_error *error);

/* Chooses the best available method of each family, with its settings. instead: the next
 * candidate for the second family; "" if there is none or both families are given. */
enum cs_status cs_compare_reference_choose(const struct cs_compare_reference_settings *settings,
                                           char chosen[2][256], char instead[256],
                                           struct cs_error *error);

#endif
