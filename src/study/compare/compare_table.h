/* compare_table.h - prints a comparison as aligned text. */
#ifndef CS_COMPARE_TABLE_H
#define CS_COMPARE_TABLE_H

#include "study/compare/ranking.h"

/* Adds the scene with its contact and switched-off corrections, and the reference: methods,
 * error bar, horizon. */
void cs_table_add_reference(const struct cs_compare *compare, struct cs_text *out);

/* Add the names of the columns, and the row of a cell. */
void cs_table_add_head(const struct cs_compare *compare, struct cs_text *out);
void cs_table_add_row(const struct cs_compare *compare, const struct cs_cell *cell,
                      struct cs_text *out);

/* Adds one line per series: observed order, largest stable step, achieved tolerance. */
void cs_table_add_series(const struct cs_compare *compare, struct cs_text *out);

/* Adds the energy balance of each cell, as far as it is known. */
void cs_table_add_ledger(const struct cs_compare *compare, struct cs_text *out);

#endif
