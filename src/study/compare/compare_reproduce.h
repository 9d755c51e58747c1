/* compare_reproduce.h - a row of a comparison, made again. */
#ifndef CS_COMPARE_REPRODUCE_H
#define CS_COMPARE_REPRODUCE_H

#include "study/reproduce.h"

/* Runs the method of a row of settings->file, a compare.csv (1: the first behind the names of
 * the columns) on the scene in origin.json beside it, and compares how it ended: outcome, time,
 * steps, state. CS_ERR_USAGE where there is no such row, or what ended it was the clock. */
enum cs_status cs_compare_reproduce_row(struct cs_reproduction *again,
                                        const struct cs_reproduction_settings *settings,
                                        uint32_t row, struct cs_error *error);

#endif
