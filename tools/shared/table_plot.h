/* table_plot.h - tables of numbers that the program writes, and the diagrams of stability maps.
 */
#ifndef CS_TABLE_PLOT_H
#define CS_TABLE_PLOT_H

#include "diagram/diagram.h"
#include "session/table.h"

enum { CS_TABLE_COLUMNS = 128 };

/* A CSV in memory, whose first line names its columns; a field that is no number is NAN. */
struct cs_number_table {
    char *names[CS_TABLE_COLUMNS]; /* (columns) */
    uint32_t columns, rows;
    double *values; /* (rows, columns) */
    char **words; /* (rows) of "verdict", else, or where it is "series", of the first column */
};

/* Number of a column; that of the columns if there is none of this name. */
uint32_t cs_number_table_find(const struct cs_number_table *table, const char *name);

static inline double cs_number_table_at(const struct cs_number_table *table, uint32_t row,
                                        uint32_t column) {
    return table->values[(size_t)row * table->columns + column];
}

/* Reads a CSV into the memory of a diagram that was begun, and makes the diagram of a stability
 * map, with its border in NAME_border.csv where that is there; that of another table has no
 * panels yet. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_table_plot_read(struct cs_diagram *plot, struct cs_number_table *table,
                                  const char *path, struct cs_error *error);

/* Adds a line of the second column over the first to a panel, whose series have room for it,
 * through the rows whose word is `group`; NULL: all. Returns NULL if out of memory. */
struct cs_series *cs_table_plot_add_series(struct cs_diagram *plot, struct cs_panel *panel,
                                           const struct cs_number_table *table,
                                           const uint32_t columns[2], const char *group,
                                           struct cs_error *error);

#endif
