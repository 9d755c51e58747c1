/* conform.h - the conformance card of a method: what its descriptor claims, measured.
 *
 * Each check runs small scenes made in memory and compares a figure with a bound. Checks that
 * the descriptor names in `fails` are expected to fail; one that passes all the same is stale.
 */
#ifndef CS_CONFORM_H
#define CS_CONFORM_H

#include "study/conform/conform_card.h"

/* Runs the checks in their order. Verdicts are counted; whether a claim failed is in
 * counts[CS_VERDICT_FAIL] and [CS_VERDICT_STALE]. CS_ERR_USAGE where `only` names no
 * check. */
enum cs_status cs_conform_check(struct cs_conform *card, struct cs_error *error);

/* Adds every check's name and what it shows, one a line: for --list. */
void cs_conform_print_checks(struct cs_text *out);

#endif
