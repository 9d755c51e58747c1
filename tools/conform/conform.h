/* conform.h - makes the conformance card of a method: measures the claims of its descriptor.
 *
 * Each check runs small scenes that are made in memory and compares a figure with a bound. A
 * claim of order p gives the bound: the error may be (h w)^p of the motion, where w is the rate
 * of the scene, times its growth over the run. Checks that the descriptor lists in `fails` are
 * expected to fail; one that passes nevertheless is stale.
 *
 *   method -> card -> per check: scene text -> probe (session) -> accuracy -> frames -> figure
 *   -> row with its verdict -> report */
#ifndef CS_CONFORM_H
#define CS_CONFORM_H

#include "conform/conform_checks.h"

/* Runs the checks in order and reports each row; claims that do not hold are no error. Returns
 * CS_ERR_USAGE if only_checks has a name that is no check, before any is run, and CS_ERR_MEMORY
 * if memory ran out in a check, CS_ERR_INTERRUPT if a run in one was interrupted. */
enum cs_status cs_conform_check(struct cs_conform *conform, struct cs_error *error);

/* Adds the name of every check and what it shows, one per line, for --list. */
void cs_conform_print_checks(struct cs_text *out);

/* Names of the checks, closed by NULL. */
extern const char *const cs_conform_check_names[];

#endif
