/* compare_reference_choice.h - which two families of methods make the reference. */
#ifndef CS_COMPARE_REFERENCE_CHOICE_H
#define CS_COMPARE_REFERENCE_CHOICE_H

#include "study/reference/compare_reference_state.h"

/* Writes the next tighter settings of "NAME:key=value,...": rtol and atol divided by 10, dt by
 * 2. CS_ERR_USAGE where they cannot be read or do not fit. */
enum cs_status cs_compare_reference_tighten(const char *integrator, char *out, size_t size,
                                            struct cs_error *error);

/* Chooses two families of the methods that are there, best first, with their settings; instead:
 * the next for the second, "" where there is none or both are given. */
enum cs_status cs_compare_reference_choose(const struct cs_compare_reference_settings *settings,
                                           char chosen[2][256], char instead[256],
                                           struct cs_error *error);

#endif
