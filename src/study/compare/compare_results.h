/* compare_results.h - stores the rows of a comparison in compare.csv while they are made, so an
 * interrupted comparison resumes.
 *
 * The file is locked for each read and each change. Several processes can therefore fill one
 * folder, each with its shard of cells. */
#ifndef CS_COMPARE_RESULTS_H
#define CS_COMPARE_RESULTS_H

#include "base/table.h"
#include "study/compare/compare_state.h"

/* The open file, and the rows that it had when it was last read. */
struct cs_compare_results {
    struct cs_row_table table;
    struct cs_cell *old_rows; /* (n_old) rows of the file, owned */
    uint32_t n_old_rows;
};
/* Opens compare.csv of the folder and takes over its rows of the same scene, duration and
 * reference. A row replaces the cell with its key; other rows are added as further cells.
 * Writes the rows back, without incomplete lines. CS_ERR_USAGE if the file belongs to another
 * comparison; CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_results_open(struct cs_compare_results *ledger,
                                       struct cs_compare *compare, struct cs_error *error);
/* Appends one row, whole. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_results_append(struct cs_compare_results *ledger,
                                         const struct cs_cell *cell, struct cs_error *error);
/* Takes over the rows that other processes have appended since. */
enum cs_status cs_compare_results_refresh(struct cs_compare_results *ledger,
                                          struct cs_compare *compare, struct cs_error *error);
/* Writes all cells in their order, and after them rows of other processes. */
enum cs_status cs_compare_results_rewrite(struct cs_compare_results *ledger,
                                          const struct cs_compare *compare,
                                          struct cs_error *error);
/* Merges the compare.csv of the folders, as far as they have one, into that of the folder
 * `out`; *n: rows. unchecked: tables without checks are taken too. CS_ERR_USAGE if they belong
 * to different comparisons. */
enum cs_status cs_compare_results_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, bool unchecked, uint32_t *n,
                                        struct cs_error *error);
/* Frees the rows; the file stays. */
void cs_compare_results_close(struct cs_compare_results *ledger);

#endif
