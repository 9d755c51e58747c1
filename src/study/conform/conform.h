/* conform.h - the conformance card of a method: what its descriptor claims, measured.
 *
 * Each check runs small scenes made in memory and compares a figure with a bound. Checks that
 * the descriptor names in `fails` are expected to fail; one that passes all the same is stale.
 */
#ifndef CS_CONFORM_H
#define CS_CONFORM_H

#include "base/status.h"
#include "base/text.h"

#include <clothsim/integrator.h>

#define CS_VERDICT_LIST(X)                                                                     \
    X(CS_VERDICT_PASS, "pass")                                                                 \
    X(CS_VERDICT_FAIL, "FAIL")                                                                 \
    X(CS_VERDICT_EXPECTED, "expected")                                                         \
    X(CS_VERDICT_STALE, "STALE")                                                               \
    X(CS_VERDICT_NONE, "n/a")
enum cs_verdict {
#define X(name, text) name,
    CS_VERDICT_LIST(X)
#undef X
        CS_VERDICTS
};
const char *cs_verdict_text(enum cs_verdict verdict);

struct cs_conform_row {
    const char *check, *what; /* its name, and what it shows */
    enum cs_verdict verdict;
    double figure, bound; /* passes where figure <= bound; both NAN: nothing was measured */
    char note[320];       /* what the figure is, or why there is none */
};

struct cs_conform_cache;

struct cs_conform {
    const struct cs_integrator *method;
    const void *options; /* filled, before the checks' own; NULL: the defaults */
    /* the method that CS_FIDELITY_IMPLICIT_EULER is held against; NULL: there is none */
    const struct cs_integrator *implicit_euler;
    const char *only; /* one check by its name; NULL: all */
    /* references that earlier cards have run, and where this one's go; NULL: none are kept */
    struct cs_conform_cache *cache;
    /* called after each check */
    void (*report)(void *ctx, const struct cs_conform_row *row);
    void *ctx;
    uint32_t counts[CS_VERDICTS];
};

/* Runs the checks in their order. Verdicts are counted; whether a claim failed is in
 * counts[CS_VERDICT_FAIL] and [CS_VERDICT_STALE]. CS_ERR_USAGE where `only` names no
 * check. */
enum cs_status cs_conform_check(struct cs_conform *card, struct cs_error *error);

/* Adds every check's name and what it shows, one a line: for --list. */
void cs_conform_print_checks(struct cs_text *out);

#endif
