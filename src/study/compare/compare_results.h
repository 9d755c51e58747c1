/* compare_results.h - compare.csv while it grows, so that an interrupted comparison goes on. */
#ifndef CS_COMPARE_RESULTS_H
#define CS_COMPARE_RESULTS_H

#include "base/table.h"
#include "study/compare/compare_state.h"

/* It is locked for each look at it and each change, so that several processes can fill one
 * folder. */
struct cs_compare_results {
    struct cs_row_table table;
    struct cs_cell *old_rows; /* (n_old) rows of the file, owned */
    uint32_t n_old_rows;
};
/* Takes over the rows of the same scene, time and reference: those of cells of this comparison
 * (by their keys), others as further cells. Writes them. CS_ERR_USAGE where the file is of
 * another comparison. */
enum cs_status cs_compare_results_open(struct cs_compare_results *ledger,
                                       struct cs_compare *compare, struct cs_error *error);
enum cs_status cs_compare_results_append(struct cs_compare_results *ledger,
                                         const struct cs_cell *cell, struct cs_error *error);
/* Takes over what other processes have added since. */
enum cs_status cs_compare_results_refresh(struct cs_compare_results *ledger,
                                          struct cs_compare *compare, struct cs_error *error);
/* Writes all cells in their order, and behind them those that others have added. */
enum cs_status cs_compare_results_rewrite(struct cs_compare_results *ledger,
                                          const struct cs_compare *compare,
                                          struct cs_error *error);
/* Joins the compare.csv of the folders, where they have one, into that of the folder out; *n:
 * rows. CS_ERR_USAGE where they are of different comparisons. */
enum cs_status cs_compare_results_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error);
void cs_compare_results_close(struct cs_compare_results *ledger);

#endif
