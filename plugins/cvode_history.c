/* cvode_history.c - finds CVODE's value vector, checks it, and writes the changed state to
 * it. */
#include "cvode_history.h"

#include <cvode/cvode.h>
#include <string.h>

/* Bytes of a state (6n). */
static size_t bytes_of(const struct sundials *base) {
    return 6 * sizeof(double) * (size_t)base->host->view->n;
}

void cvode_history_update(struct cvode_history *history, struct sundials *base) {
    history->value = NULL;
    history->is_checked = false;
    base->vectors.copied_from = NULL;
}

void cvode_history_find(struct cvode_history *history, const struct sundials *base) {
    if (base->vectors.copied_from == base->state)
        history->value = base->vectors.copied_to;
}

/* True if CVODE's own interpolant gives the changed state, bit for bit, at the end of the
 * last step. */
static bool is_moved(const struct cvode_history *history, struct sundials *base) {
    double t; /* the end of the last step: the stop time is met up to rounding only */
    return CVodeGetCurrentTime(base->memory, &t) == CV_SUCCESS &&
           CVodeGetDky(base->memory, t, 0, history->scratch) == CV_SUCCESS &&
           !memcmp(sundials_data(history->scratch), sundials_data(base->state), bytes_of(base));
}

bool cvode_history_move(struct cvode_history *history, struct sundials *base) {
    if (!history->value)
        return false;
    memcpy(sundials_data(history->value), sundials_data(base->state), bytes_of(base));
    if (!history->is_checked && !is_moved(history, base))
        history->value = NULL;
    history->is_checked = true;
    return history->value != NULL;
}
