/* Runs the checks of a card in order and compares them with the method's own claims. */
#include "conform/conform.h"

#include "conform/conform_checks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The checks in the order of the card, made from CS_CONFORM_LIST. */
static const struct {
    const char *name, *what;
    enum cs_conform_of of;
    void (*run)(const struct cs_conform *conform, struct cs_conform_row *row);
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
    if (!is_named(method, row->check) || row->is_guard)
        return;
    if (row->verdict == CS_VERDICT_FAIL)
        row->verdict = CS_VERDICT_EXPECTED;
    else
        row->verdict = CS_VERDICT_STALE;
}

/* True if the list, names with commas between them, has the name; NULL has all. */
static bool is_in(const char *list, const char *name) {
    const size_t length = strlen(name);
    for (; list; list = strchr(list, ',') ? strchr(list, ',') + 1 : NULL)
        if (strcspn(list, ",") == length && !strncmp(list, name, length))
            return true;
    return false;
}

const char *const cs_conform_check_names[] = {
#define X(name, function, of, what) name,
    CS_CONFORM_LIST(X)
#undef X
        NULL};

/* Fails if a name of the list is no check. */
static enum cs_status check_names(const char *list, struct cs_error *error) {
    const char *const *names = cs_conform_check_names;
    while (list && !error->status) {
        const size_t length = strcspn(list, ",");
        uint32_t k = 0;
        while (k < CHECKS && (strlen(names[k]) != length || strncmp(list, names[k], length)))
            k++;
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)fmin((double)length, 60), list);
        const char *nearest = cs_nearest_word(name, names);
        if (k == CHECKS)
            cs_fail(error, CS_ERR_USAGE, "no check \"%s\"%s%s%s (see: clothsim conform --list)",
                    name, nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                    nearest ? "\"?" : "");
        list = list[length] ? list + length + 1 : NULL;
    }
    return error->status;
}

/* Runs check k. One whose scene the method refuses does not apply. */
static void run(const struct cs_conform *conform, uint32_t k, struct cs_conform_row *row) {
    *conform->refused = false;
    checks[k].run(conform, row);
    if (*conform->refused)
        cs_row_skip(row, "it is refused with contact and events");
}

enum cs_status cs_conform_check(struct cs_conform *conform, struct cs_error *error) {
    bool refused;
    conform->card_error = error;
    conform->refused = &refused;
    check_names(conform->only_checks, error);
    for (uint32_t k = 0; k < CHECKS && !error->status; k++) {
        if (conform->only_checks && !is_in(conform->only_checks, checks[k].name))
            continue;
        // another process may have reported it
        if (conform->begin && !conform->begin(conform->ctx, checks[k].name))
            continue;
        struct cs_conform_row row = {
            .check = checks[k].name, .figure = (double)NAN, .bound = (double)NAN};
        if (checks[k].of == CS_CONFORM_SPRINGS &&
            conform->method->fidelity == CS_FIDELITY_OTHER)
            cs_row_skip(&row, "another model: it does not follow the motion of springs");
        else
            run(conform, k, &row);
        apply_expected_failures(conform->method, &row);
        if (!error->status)
            conform->report(conform->ctx, &row);
        if (conform->fail_fast &&
            (row.verdict == CS_VERDICT_FAIL || row.verdict == CS_VERDICT_STALE))
            break;
    }
    conform->refused = NULL;
    return error->status;
}

void cs_conform_print_checks(struct cs_text *out) {
    for (uint32_t k = 0; k < CHECKS; k++)
        cs_text_add(out, "%-20s %s\n", checks[k].name, checks[k].what);
}
