/* parameter_sweep_table.h - the rows of a sweep by their cells, as lines of sweep.csv. */
#ifndef CS_PARAMETER_SWEEP_TABLE_H
#define CS_PARAMETER_SWEEP_TABLE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Lines of a table by cell; each begins with the number of its cell and ends with its key. */
struct cs_parameter_sweep_table {
    char path[4096], lock[4096];
    char *header;
    char **lines; /* (n) owned, with their line breaks; NULL: not there */
    uint32_t n;
};

/* Makes the folder; no file is read. */
enum cs_status cs_product_table_open(struct cs_parameter_sweep_table *table, const char *folder,
                                     struct cs_error *error);
void cs_product_table_finish(struct cs_parameter_sweep_table *table);

/* Room for n rows. CS_ERR_MEMORY. */
enum cs_status cs_product_table_grow(struct cs_parameter_sweep_table *table, uint32_t n,
                                     struct cs_error *error);

/* Takes over the rows of a file, where there is one; what was cut off is passed over. Its first
 * line is to be the table's, and rows of a cell that is there are to have its key: else
 * CS_ERR_USAGE. */
enum cs_status cs_product_table_read(struct cs_parameter_sweep_table *table, const char *path,
                                     struct cs_error *error);
/* Writes sweep.csv anew, in the order of the cells. */
enum cs_status cs_product_table_write(const struct cs_parameter_sweep_table *table,
                                      struct cs_error *error);
/* Keeps the row of a cell, whoever else writes there. */
enum cs_status cs_parameter_sweep_table_store(struct cs_parameter_sweep_table *table,
                                              uint32_t cell, const char *line,
                                              struct cs_error *error);
/* Whether the row of a cell, which is there, has that key. */
bool cs_product_table_has(const struct cs_parameter_sweep_table *table, uint32_t cell,
                          const char *key);

#endif
