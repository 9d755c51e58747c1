/* Fills the rows of a card. Of several figures it keeps the most significant one. */
#include "study/conform/conform_card.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *cs_verdict_text(enum cs_verdict verdict) {
    static const char *const texts[] = {
#define X(name, text) text,
        CS_VERDICT_LIST(X)
#undef X
    };
    return texts[verdict];
}

static void note(struct cs_conform_row *row, const char *format, va_list args) {
    vsnprintf(row->note, sizeof row->note, format, args);
}

/* Used fraction of the bound. A figure that fails with a bound of 0, or is NAN, uses HUGE_VAL;
 * a figure of 0 with a bound of 0 uses nothing. */
static double used(double figure, double bound) {
    return !(figure <= bound) ? (figure > bound && bound > 0 ? figure / bound : HUGE_VAL)
           : bound > 0        ? figure / bound
                              : 0;
}

void cs_row_state(struct cs_conform_row *row, double figure, double bound, const char *format,
                  ...) {
    // the first that fails is the plainest
    if (row->verdict == CS_VERDICT_FAIL)
        return;
    if (!isnan(row->bound) && used(figure, bound) <= used(row->figure, row->bound))
        return;
    row->figure = figure;
    row->bound = bound;
    row->verdict = figure <= bound ? CS_VERDICT_PASS : CS_VERDICT_FAIL;
    va_list args;
    va_start(args, format);
    note(row, format, args);
    va_end(args);
}

void cs_row_skip(struct cs_conform_row *row, const char *reason) {
    row->verdict = CS_VERDICT_NONE;
    snprintf(row->note, sizeof row->note, "%s", reason);
}

void cs_row_fail(struct cs_conform_row *row, const char *format, ...) {
    if (row->verdict == CS_VERDICT_FAIL)
        return;
    row->verdict = CS_VERDICT_FAIL;
    row->figure = row->bound = (double)NAN;
    va_list args;
    va_start(args, format);
    note(row, format, args);
    va_end(args);
}
