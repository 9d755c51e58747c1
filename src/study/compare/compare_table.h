/* compare_table.h - a comparison as aligned text. */
#ifndef CS_COMPARE_TABLE_H
#define CS_COMPARE_TABLE_H

#include "study/compare/ranking.h"

/* Adds the scene with its contact and what is switched off, and the reference in a few lines:
 * methods, error bar, horizon. */
void cs_table_add_reference(const struct cs_compare *compare, struct cs_text *out);

/* Adds the names of the columns, or the row of a cell. */
void cs_table_add_head(const struct cs_compare *compare, struct cs_text *out);
void cs_table_add_row(const struct cs_compare *compare, const struct cs_cell *cell,
                      struct cs_text *out);

/* Adds one line a series: its observed order, largest step that held, tolerance kept. */
void cs_table_add_series(const struct cs_compare *compare, struct cs_text *out);

/* Adds where the energy of each cell went, as far as it is known; nothing where it is not. */
void cs_table_add_ledger(const struct cs_compare *compare, struct cs_text *out);

#endif
