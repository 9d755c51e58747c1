/* Runs the checks of a card in order and compares them with the method's own claims. */
#include "study/conform/conform.h"

#include "study/conform/conform_checks.h"

#include <math.h>
#include <string.h>

/* The checks in the order of the card, made from CS_CONFORM_LIST. */
static const struct {
    const char *name, *what;
    enum cs_conform_of of;
    void (*run)(const struct cs_conform *card, struct cs_conform_row *row);
} checks[] = {
#define X(name, function, of, what) {name, what, CS_CONFORM_##of, cs_check_##function},
    CS_CONFORM_LIST(X)
#undef X
};
enum { CHECKS = sizeof checks / sizeof *checks };

/* True if the method's `fails` lists the check. */
static bool is_named(const struct cs_integrator *method, const char *check) {
    for (const char *const *name = method->fails; name && *name; name++)
        if (!strcmp(*name, check))
            return true;
    return false;
}

/* A failure that the method declares is an expected one. A declared failure that passes is
 * stale: the declaration is no longer true. */
static void apply_expected_failures(const struct cs_integrator *method,
                                    struct cs_conform_row *row) {
    if (!is_named(method, row->check))
        return;
    if (row->verdict == CS_VERDICT_FAIL)
        row->verdict = CS_VERDICT_EXPECTED;
    else
        row->verdict = CS_VERDICT_STALE;
}

enum cs_status cs_conform_check(struct cs_conform *card, struct cs_error *error) {
    const char *names[CHECKS + 1] = {NULL};
    bool found = false;
    memset(card->counts, 0, sizeof card->counts);
    card->memory_error = error;
    for (uint32_t k = 0; k < CHECKS; k++) {
        /* all names, also those of checks not run: one of them may have been meant */
        names[k] = checks[k].name;
        if (card->only_check && strcmp(card->only_check, checks[k].name) != 0)
            continue;
        found = true;
        struct cs_conform_row row = {.check = checks[k].name,
                                     .description = checks[k].what,
                                     .figure = (double)NAN,
                                     .bound = (double)NAN};
        if (checks[k].of == CS_CONFORM_SPRINGS && card->method->fidelity == CS_FIDELITY_OTHER)
            cs_row_skip(&row, "another model: it does not follow the motion of springs");
        else
            checks[k].run(card, &row);
        if (error->status)
            return error->status;
        apply_expected_failures(card->method, &row);
        card->counts[row.verdict]++;
        if (card->report)
            card->report(card->ctx, &row);
    }
    if (found)
        return CS_OK;
    const char *nearest = cs_nearest_word(card->only_check, names);
    return cs_fail(error, CS_ERR_USAGE,
                   "no check \"%.60s\"%s%s%s (see: clothsim conform --list)", card->only_check,
                   nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                   nearest ? "\"?" : "");
}

void cs_conform_print_checks(struct cs_text *out) {
    for (uint32_t k = 0; k < CHECKS; k++)
        cs_text_add(out, "%-20s %s\n", checks[k].name, checks[k].what);
}
