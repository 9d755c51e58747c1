/* cell_list_parse.h - reads a list of methods into the cells of a comparison.
 *
 * A list is "NAME,NAME:key=value,key=low..high,SERIES=NAME:key=value,...". The cells of one
 * entry form a series. It is called SERIES or, without one, by the method and the options that
 * are not at their defaults. Entries of the same method and options form one series.
 *
 * A range of dt goes from high down by factors of 2, one of rtol by half decades. Without a
 * range, a method of fixed step takes 1/fps divided by powers of 2 (explicit ones from just
 * beyond their stability limit on), an adaptive one rtol = atol from 1e-2 to 1e-9. */
#ifndef CS_CELL_LIST_PARSE_H
#define CS_CELL_LIST_PARSE_H

#include "base/arena.h"
#include "study/compare/cell_list_expand.h"

/* Reads the list of methods into cells. A module file is found by the name of its first method,
 * hence cs_cell_list_add_modules comes first. CS_ERR_USAGE for a list that cannot be read or an
 * unknown method; CS_ERR_MODULE. The list is empty on failure. */
enum cs_status cs_cell_list_parse(struct cs_cell_list *sweep,
                                  const struct cs_cell_list_settings *settings,
                                  struct cs_error *error);

/* Appends to *plugins the module files that a list names in place of methods: items with a "/".
 * The new array is the arena's. CS_ERR_MEMORY. */
enum cs_status cs_cell_list_add_modules(const char *list, struct cs_arena *arena,
                                        const char *const **plugins, uint32_t *n_plugins,
                                        struct cs_error *error);

#endif
