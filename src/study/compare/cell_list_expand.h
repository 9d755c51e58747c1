/* cell_list_expand.h - expands one method of a list to cells. */
#ifndef CS_CELL_LIST_EXPAND_H
#define CS_CELL_LIST_EXPAND_H

#include "base/hash.h"
#include "study/compare/cell_list.h"

/* Facts of the scene that steps and tolerances are derived from. */
struct cs_cell_list_settings {
    const char *list;           /* NULL: every method there is */
    const char *const *plugins; /* (n_plugins) module files */
    uint32_t n_plugins;
    double fps, omega; /* of the scene: the default steps come from them */
    double size;       /* m: atol is rtol times it, so that another unit changes nothing */
};

/* One method of a list, while it is read. */
struct cs_cell_list_entry {
    struct cs_method method;
    char series[CS_SERIES_BYTES];
    char fixed[sizeof((struct cs_cell *)0)->fixed]; /* options without the swept one */
    const char *control;                            /* "dt", "rtol" or "" */
    double low, high;                               /* of the control; NAN: the default sweep */
    char module[CS_HASH_DIGITS]; /* hash of the file: a rebuilt module is a different one */
};

/* Adds the cells of the entry over its range, or over the default range. A method of another
 * model gets one refused cell. CS_ERR_USAGE, CS_ERR_MEMORY. */
enum cs_status cs_cell_list_expand(struct cs_cell_list *sweep,
                                   const struct cs_cell_list_entry *entry,
                                   const struct cs_cell_list_settings *settings,
                                   struct cs_error *error);

#endif
