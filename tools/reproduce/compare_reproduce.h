/* compare_reproduce.h - reproduces a row of a comparison. */
#ifndef CS_COMPARE_REPRODUCE_H
#define CS_COMPARE_REPRODUCE_H

#include "reproduce/reproduce.h"

/* Runs the method of a row of settings->file, a compare.csv (1: the first row after the names),
 * on the scene in origin.json beside it. Compares outcome, time, steps and final state.
 * CS_ERR_USAGE if there is no such row, or if the clock ended it. */
enum cs_status cs_compare_reproduce_row(struct cs_reproduction *reproduction,
                                        const struct cs_reproduction_settings *settings,
                                        uint32_t row, struct cs_error *error);

#endif
