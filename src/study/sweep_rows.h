/* sweep_rows.h - the rows of sweep.csv by their cells. A row begins with the number of its cell
 * and ends with its key. */
#ifndef CS_SWEEP_ROWS_H
#define CS_SWEEP_ROWS_H

#include "base/table.h"
#include "base/text.h"

enum { CS_PARAMETER_SWEEP_CELLS_MAX = 10000000 };

/* Zeroed: none. */
struct cs_sweep_rows {
    struct cs_row_table table;
    struct cs_text names; /* first line; empty: not known yet */
    char **lines;         /* (n) owned, without their checks; NULL: not there */
    uint32_t n;
};

/* Sets the path of the table in a folder, which it makes; reads nothing. CS_ERR_FILE. */
enum cs_status cs_sweep_rows_open(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error);
/* Grows the array of lines to n; new ones are NULL. CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_reserve(struct cs_sweep_rows *rows, uint32_t n,
                                     struct cs_error *error);
/* Adds the rows of a folder, if there are any. CS_ERR_USAGE if their columns or keys are those
 * of a different sweep; CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_read(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error);
/* Writes all rows in the order of the cells. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_write(const struct cs_sweep_rows *rows, struct cs_error *error);
/* Number of rows that are there. */
uint32_t cs_sweep_rows_count(const struct cs_sweep_rows *rows);
/* The key of a row, its last column. */
const char *cs_sweep_row_key(const char *line);
/* Frees all lines. */
void cs_sweep_rows_finish(struct cs_sweep_rows *rows);

#endif
