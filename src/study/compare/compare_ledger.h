/* compare_ledger.h - compare.csv while it grows, so that an interrupted comparison goes on. */
#ifndef CS_COMPARE_LEDGER_H
#define CS_COMPARE_LEDGER_H

#include "study/compare/compare_state.h"

#include <stdio.h>

/* The table's file: what is there already, and the rows to come. */
struct cs_ledger {
    char path[4096];
    struct cs_cell *old; /* (n_old) rows of an earlier run, owned */
    uint32_t n_old;
    FILE *file; /* owned, appended to */
};
/* Takes over the rows of the same scene, time and reference: those of cells of this comparison
 * (by their keys), others as further cells. Writes them and opens the file for what is to
 * come. CS_ERR_USAGE where the file is of another comparison. */
enum cs_status cs_ledger_open(struct cs_ledger *ledger, struct cs_compare *compare,
                              struct cs_error *error);
enum cs_status cs_ledger_append(struct cs_ledger *ledger, const struct cs_cell *cell,
                                struct cs_error *error);
/* Writes all cells in their order. */
enum cs_status cs_ledger_rewrite(struct cs_ledger *ledger, const struct cs_compare *compare,
                                 struct cs_error *error);
void cs_ledger_close(struct cs_ledger *ledger);

#endif
