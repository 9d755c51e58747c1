/* cell_list.h - which methods at which steps or tolerances: the cells of a comparison.
 */
#ifndef CS_CELL_LIST_H
#define CS_CELL_LIST_H

#include "study/compare/compare_cell.h"

/* Zeroed: empty. */
struct cs_cell_list {
    struct cs_cell *cells; /* (n) owned; those of a refused method have their outcome */
    uint32_t n, capacity;
};

void cs_cell_list_finish(struct cs_cell_list *sweep);

/* Adds a cell behind those of its series that have longer steps or looser tolerances; one that
 * is there already is left as it is. CS_ERR_USAGE where the series is of another method or
 * options; CS_ERR_MEMORY. */
enum cs_status cs_cell_list_add(struct cs_cell_list *sweep, const struct cs_cell *cell,
                                struct cs_error *error);

/* Takes out the cells that were not run; returns how many, and of how many series. */
uint32_t cs_cell_list_drop_unrun(struct cs_cell_list *sweep, uint32_t *series);

/* Makes it a row that says why there are no figures. */
void cs_cell_refuse(struct cs_cell *cell, const char *why);
/* Makes one refused cell, which says why, of a series; first is the first of its cells. */
void cs_cell_list_refuse(struct cs_cell_list *sweep, uint32_t first, const char *why);

/* "NAME:options" of a cell, of at most CS_CELL_INTEGRATOR characters. */
enum { CS_CELL_INTEGRATOR = 336 };
void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size);

#endif
