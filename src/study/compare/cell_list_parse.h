/* cell_list_parse.h - reads a list of methods into the cells of a comparison.
 *
 * A list is "NAME,NAME:key=value,key=low..high,SERIES=NAME:key=value,...". The cells of one
 * entry form a series. It is called SERIES or, without one, by the method and the options that
 * are not at their defaults. Entries of the same method and options form one series.
 *
 * A range of dt goes from high down by factors of 2, one of rtol by half decades. Without a
 * range, a method of fixed step takes 1/fps divided by powers of 2 (explicit ones from just
 * beyond their stability limit on), an adaptive one rtol = atol from 1e-2 to 1e-13; a
 * comparison runs them down to its smallest error, or to its budget. */
#ifndef CS_CELL_LIST_PARSE_H
#define CS_CELL_LIST_PARSE_H

#include "base/arena.h"
#include "base/hash.h"
#include "study/compare/compare_cell.h"

/* The cells of a comparison: methods with their steps or tolerances. Cells of one
 * series are adjacent, by falling step or tolerance. */

/* Zeroed: empty. */
struct cs_cell_list {
    struct cs_cell *cells; /* (n) owned; those of a refused method have their outcome */
    uint32_t n, capacity;
};

/* Frees the cells; the list is then empty. */
void cs_cell_list_finish(struct cs_cell_list *list);

/* Inserts a cell into its series after those with longer steps or looser tolerances; an equal
 * one is left as it is. CS_ERR_USAGE if the series has another method or other options;
 * CS_ERR_MEMORY. The list is unchanged on failure. Pointers to cells become invalid. */
enum cs_status cs_cell_list_add(struct cs_cell_list *list, const struct cs_cell *cell,
                                struct cs_error *error);

/* Removes the cells that were not run. */
void cs_cell_list_drop_unrun(struct cs_cell_list *list);

/* Makes a cell of the same series with another value of its control, without results or key. */
void cs_cell_derive(struct cs_cell *cell, const struct cs_cell *of, double value);

/* Replaces the series that begins at cell `first` by one refused cell with the reason. */
void cs_cell_list_refuse(struct cs_cell_list *list, uint32_t first, const char *why);

/* "NAME:options" of a cell, of at most CS_CELL_INTEGRATOR characters. */
enum { CS_CELL_INTEGRATOR = 336 };

void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size);

/* Facts of the scene that steps and tolerances are derived from. */
struct cs_cell_list_settings {
    const char *list;           /* NULL: every method there is, and its variants */
    const char *const *plugins; /* (n_plugins) module files */
    uint32_t n_plugins;
    double fps, omega; /* of the scene: the default steps come from them */
};

/* Reads the list of methods into cells. A module file is found by the name of its first method,
 * hence cs_cell_list_add_modules comes first. CS_ERR_USAGE for a list that cannot be read or an
 * unknown method; CS_ERR_MODULE. The list is empty on failure. */
enum cs_status cs_cell_list_parse(struct cs_cell_list *list,
                                  const struct cs_cell_list_settings *settings,
                                  struct cs_error *error);

/* Appends to *plugins the module files that a list names in place of methods: items with a "/".
 * The new array is the arena's. CS_ERR_MEMORY. */
enum cs_status cs_cell_list_add_modules(const char *list, struct cs_arena *arena,
                                        const char *const **plugins, uint32_t *n_plugins,
                                        struct cs_error *error);

#endif
