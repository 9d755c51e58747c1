/* conform_card.h - a card in the making: the method, its rows, and the statement of a result.
 */
#ifndef CS_CONFORM_CARD_H
#define CS_CONFORM_CARD_H

#include "base/status.h"
#include "base/text.h"

#include <clothsim/integrator.h>
#include <stdbool.h>

/* X(name, text) of the verdicts on a claim. */
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
/* Text of a verdict in reports. */
const char *cs_verdict_text(enum cs_verdict verdict);

/* Result of one check. */
struct cs_conform_row {
    const char *check; /* its name */
    enum cs_verdict verdict;
    double figure, bound; /* passes where figure <= bound; both NAN: nothing was measured */
    char note[320];       /* what the figure is, or why there is none */
};

struct cs_conform_cache;

/* A card: the tested method, its settings and the counts of verdicts. Pointers are borrowed. */
struct cs_conform {
    const struct cs_integrator *method;
    const void *options; /* filled, before the checks' own; NULL: the defaults */
    /* the method that CS_FIDELITY_IMPLICIT_EULER is compared with; NULL: none */
    const struct cs_integrator *implicit_euler;
    const char *only_checks; /* names with commas between them; NULL: all */
    /* references that earlier cards have run, and where this one's go; NULL: none are kept */
    struct cs_conform_cache *cache;
    /* lack of memory, which is no fault of the method's: it ends the card; set by check */
    struct cs_error *memory_error;
    /* called before each check; false: the check is left out. May be NULL. */
    bool (*begin)(void *ctx, const char *check);
    /* called after each check */
    void (*report)(void *ctx, const struct cs_conform_row *row);
    void *ctx;
};

/* States a figure that must not exceed its bound; NAN fails. If a check states several, the row
 * keeps the first that fails, else the one that uses most of its bound. */
void cs_row_state(struct cs_conform_row *row, double figure, double bound, const char *format,
                  ...) __attribute__((format(printf, 4, 5)));
/* Marks the check as not applicable, with the reason. */
void cs_row_skip(struct cs_conform_row *row, const char *reason);
/* Marks the check as failed without a figure; an earlier failure stays. */
void cs_row_fail(struct cs_conform_row *row, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
