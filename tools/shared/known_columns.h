/* known_columns.h - finds the unit and meaning of a column by its name. */
#ifndef CS_KNOWN_COLUMNS_H
#define CS_KNOWN_COLUMNS_H

#include "session/table.h"

/* The columns of the ledger that stand in every one: forces may add columns of their own. */
extern const struct cs_column cs_ledger_columns[];
extern const uint32_t cs_n_ledger_columns;

/* The column of that name of a table that the program writes; NULL: none has one. */
const struct cs_column *cs_known_column(const char *name);

#endif
