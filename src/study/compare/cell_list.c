/* Keeps the cells of a comparison sorted by series. */
#include "study/compare/cell_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Inserts a copy at an index; the capacity doubles when it is used up. */
static enum cs_status insert(struct cs_cell_list *sweep, uint32_t at,
                             const struct cs_cell *cell, struct cs_error *error) {
    if (sweep->n == sweep->capacity) {
        const uint32_t capacity = sweep->capacity ? 2 * sweep->capacity : 64;
        struct cs_cell *cells = realloc(sweep->cells, capacity * sizeof *cells);
        if (!cells)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u cells", capacity);
        sweep->cells = cells;
        sweep->capacity = capacity;
    }
    struct cs_cell *place = sweep->cells + at;
    memmove(place + 1, place, (sweep->n++ - at) * sizeof *place);
    *place = *cell;
    return CS_OK;
}

/* Reports two different methods under one series name. */
static enum cs_status refuse_series(const struct cs_cell *one, const struct cs_cell *other,
                                    struct cs_error *error) {
    return cs_fail(error, CS_ERR_USAGE,
                   "series \"%s\" is %s%s%s and %s%s%s: give one of them another name",
                   one->series, one->method, *one->fixed ? ":" : "", one->fixed, other->method,
                   *other->fixed ? ":" : "", other->fixed);
}

/* Walks the whole series: a duplicate can be anywhere, and the place is before the first
 * smaller value. */
enum cs_status cs_cell_list_add(struct cs_cell_list *sweep, const struct cs_cell *cell,
                                struct cs_error *error) {
    uint32_t at = sweep->n;
    for (uint32_t k = 0; k < sweep->n; k++) {
        const struct cs_cell *other = sweep->cells + k;
        if (!cs_cell_same_series(other, cell))
            continue;
        if (strcmp(other->method, cell->method) != 0 || strcmp(other->fixed, cell->fixed) != 0)
            return refuse_series(other, cell, error);
        if (!strcmp(other->options, cell->options))
            return CS_OK;
        at = k + 1;
        if (other->value < cell->value) {
            at = k;
            break;
        }
    }
    return insert(sweep, at, cell, error);
}

void cs_cell_refuse(struct cs_cell *cell, const char *why) {
    snprintf(cell->outcome, sizeof cell->outcome, "refused");
    snprintf(cell->note, sizeof cell->note, "%.239s", why);
}

/* Replaces the cells of the series in place; the cells after it move up. */
void cs_cell_list_refuse(struct cs_cell_list *sweep, uint32_t first, const char *why) {
    const struct cs_cell *of = sweep->cells + first;
    struct cs_cell cell;
    uint32_t next = first + 1;
    cs_cell_init(&cell, of->method);
    memcpy(cell.series, of->series, sizeof cell.series);
    memcpy(cell.fixed, of->fixed, sizeof cell.fixed);
    cs_cell_refuse(&cell, why);
    while (next < sweep->n && cs_cell_same_series(sweep->cells + next, &cell))
        next++;
    memmove(sweep->cells + first + 1, sweep->cells + next,
            (sweep->n - next) * sizeof *sweep->cells);
    sweep->n -= next - first - 1;
    sweep->cells[first] = cell;
}

/* A series is counted at its first cell that was not run, the one after a cell with an outcome.
 */
uint32_t cs_cell_list_drop_unrun(struct cs_cell_list *sweep, uint32_t *series) {
    uint32_t kept = 0;
    *series = 0;
    for (uint32_t k = 0; k < sweep->n; k++) {
        const struct cs_cell *cell = sweep->cells + k;
        if (*cell->outcome)
            sweep->cells[kept++] = *cell;
        else
            *series += k > 0 && *cell[-1].outcome;
    }
    const uint32_t dropped = sweep->n - kept;
    sweep->n = kept;
    return dropped;
}

void cs_cell_list_finish(struct cs_cell_list *sweep) {
    free(sweep->cells);
    *sweep = (struct cs_cell_list){0};
}

void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size) {
    snprintf(out, size, "%s%s%s", cell->method, *cell->options ? ":" : "", cell->options);
}
