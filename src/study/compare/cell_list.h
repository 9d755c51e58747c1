/* cell_list.h - the cells of a comparison: methods with their steps or tolerances. Cells of one
 * series are adjacent, by falling step or tolerance. */
#ifndef CS_CELL_LIST_H
#define CS_CELL_LIST_H

#include "study/compare/compare_cell.h"

/* Zeroed: empty. */
struct cs_cell_list {
    struct cs_cell *cells; /* (n) owned; those of a refused method have their outcome */
    uint32_t n, capacity;
};

/* Frees the cells; the list is then empty. */
void cs_cell_list_finish(struct cs_cell_list *sweep);

/* Inserts a cell into its series after those with longer steps or looser tolerances; an equal
 * one is left as it is. CS_ERR_USAGE if the series has another method or other options;
 * CS_ERR_MEMORY. The list is unchanged on failure. Pointers to cells become invalid. */
enum cs_status cs_cell_list_add(struct cs_cell_list *sweep, const struct cs_cell *cell,
                                struct cs_error *error);

/* Removes the cells that were not run. Returns their number; *series: that of their series. */
uint32_t cs_cell_list_drop_unrun(struct cs_cell_list *sweep, uint32_t *series);

/* Marks a cell as refused, with the reason. */
void cs_cell_refuse(struct cs_cell *cell, const char *why);
/* Replaces the series that begins at cell `first` by one refused cell with the reason. */
void cs_cell_list_refuse(struct cs_cell_list *sweep, uint32_t first, const char *why);

/* "NAME:options" of a cell, of at most CS_CELL_INTEGRATOR characters. */
enum { CS_CELL_INTEGRATOR = 336 };
void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size);

#endif
