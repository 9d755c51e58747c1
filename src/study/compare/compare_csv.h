/* compare_csv.h - the cells of a comparison as a file: one line a cell, a column a field. */
#ifndef CS_COMPARE_CSV_H
#define CS_COMPARE_CSV_H

#include "study/compare/compare_cell.h"

/* Adds the line of names, or of one cell. Numbers read back the same; NAN is an empty field. */
void cs_csv_add_head(struct cs_text *out);
void cs_csv_add_cell(struct cs_text *out, const struct cs_cell *cell);

/* Reads a file into malloc'd cells; columns are found by name, absent ones are empty, others
 * are ignored, and a last line without its end is dropped. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_csv_read(const char *path, struct cs_cell **cells, uint32_t *n,
                           struct cs_error *error);

#endif
