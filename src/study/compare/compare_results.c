/* Reads, appends and rewrites the rows of compare.csv. */
#include "study/compare/compare_state.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const NAME = "compare.csv";

/* Finds the cell of the same series and options. */
static struct cs_cell *find_cell(const struct cs_cell_list *list, const struct cs_cell *cell) {
    for (uint32_t k = 0; k < list->n; k++)
        if (cs_cell_same_series(list->cells + k, cell) &&
            !strcmp(list->cells[k].options, cell->options))
            return list->cells + k;
    return NULL;
}

/* Writes the cells that have an outcome; with `others`, also rows of the file that match no
 * cell. */
static enum cs_status write_rows(const struct cs_compare_results *results,
                                 const struct cs_compare *compare, bool others,
                                 struct cs_error *error) {
    struct cs_text text = {0};
    cs_columns_print_names(cs_columns, cs_n_columns, &text);
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (*compare->cells.cells[k].outcome)
            cs_columns_print_row(cs_columns, cs_n_columns, compare->cells.cells + k, &text);
    for (uint32_t k = 0; k < results->n_old_rows && others; k++)
        if (!find_cell(&compare->cells, results->old_rows + k))
            cs_columns_print_row(cs_columns, cs_n_columns, results->old_rows + k, &text);
    return cs_file_write_text(results->table.path, &text, error);
}

/* Reads the rows of a file; a missing file has none. Rows of other machines get a series of
 * their own. */
static enum cs_status read_rows(const char *path, bool unchecked, const char *machine,
                                struct cs_cell **cells, uint32_t *n, struct cs_error *error) {
    *cells = NULL;
    *n = 0;
    if (access(path, F_OK) || cs_csv_read(path, unchecked, cells, n, error))
        return error->status;
    for (uint32_t i = 0; i < *n; i++)
        cs_cell_name_machine(*cells + i, machine);
    return CS_OK;
}

/* Replaces the old rows by those of the file now. */
static enum cs_status read_again(struct cs_compare_results *results,
                                 const struct cs_compare *compare, struct cs_error *error) {
    free(results->old_rows);
    return read_rows(results->table.path, false, compare->machine, &results->old_rows,
                     &results->n_old_rows, error);
}

/* Reads the rows and refuses a file of another comparison: it must not be overwritten. */
static enum cs_status read_old(struct cs_compare_results *results,
                               const struct cs_compare *compare, struct cs_error *error) {
    if (compare->settings->overwrite || read_again(results, compare, error))
        return error->status;
    for (uint32_t i = 0; i < results->n_old_rows && compare->cells.n > 0; i++)
        if (strncmp(results->old_rows[i].key, compare->cells.cells[0].key, CS_COMPARE_DIGITS) !=
            0)
            return cs_fail(error, CS_ERR_USAGE,
                           "%s belongs to another scene, time or reference; choose another "
                           "folder with --out, or --overwrite to replace it",
                           results->table.path);
    return CS_OK;
}

/* True if an earlier row need not be run again. A run over budget is repeated if it may do more
 * work now; a run without a ledger if one is requested. */
static bool is_valid(const struct cs_cell *old, const struct cs_compare *compare) {
    if (compare->settings->ledger && cs_cell_is_finished(old) && !cs_cell_has_ledger(old))
        return false;
    return *old->outcome &&
           (strcmp(old->outcome, cs_outcome_text(CS_OVER_BUDGET)) != 0 ||
            fmax(old->work, old->steps) * compare->pass_seconds > compare->budget);
}

/* Gives a cell the results of an old row; its limits are those of this comparison. */
static void copy_row(struct cs_cell *cell, const struct cs_cell *old) {
    const struct cs_cell asked = *cell;
    *cell = *old;
    cell->low = asked.low;
    cell->high = asked.high;
    cell->open = asked.open;
}

/* Takes over old rows by series, options and key. A row of the file that no cell asks for
 * becomes a further cell. */
static enum cs_status reuse_row(struct cs_compare_results *results, struct cs_compare *compare,
                                struct cs_error *error) {
    struct cs_cell_list *list = &compare->cells;
    for (uint32_t i = 0; i < results->n_old_rows && !error->status; i++) {
        const struct cs_cell *old = results->old_rows + i;
        struct cs_cell *found = find_cell(list, old);
        if (!found)
            cs_cell_list_add(list, old, error);
        else if (!*found->outcome && !strcmp(found->key, old->key) && is_valid(old, compare))
            copy_row(found, old);
    }
    return error->status;
}

enum cs_status cs_compare_results_open(struct cs_compare_results *results,
                                       struct cs_compare *compare, struct cs_error *error) {
    *results = (struct cs_compare_results){0};
    if (cs_row_table_open(&results->table, compare->settings->folder, NAME, ".lock", 0,
                          error) ||
        cs_row_table_lock(&results->table, error))
        return error->status;
    if (!read_old(results, compare, error) && !reuse_row(results, compare, error))
        write_rows(results, compare, false, error);
    cs_row_table_unlock(&results->table);
    return error->status;
}

enum cs_status cs_compare_results_append(struct cs_compare_results *results,
                                         const struct cs_cell *cell, struct cs_error *error) {
    struct cs_text line = {0};
    cs_columns_print_row(cs_columns, cs_n_columns, cell, &line);
    if (line.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    else
        cs_row_table_append(&results->table, line.bytes, line.length, error);
    cs_text_finish(&line);
    return error->status;
}

enum cs_status cs_compare_results_refresh(struct cs_compare_results *results,
                                          struct cs_compare *compare, struct cs_error *error) {
    if (cs_row_table_lock(&results->table, error))
        return error->status;
    if (!read_again(results, compare, error))
        reuse_row(results, compare, error);
    cs_row_table_unlock(&results->table);
    return error->status;
}

enum cs_status cs_compare_results_rewrite(struct cs_compare_results *results,
                                          const struct cs_compare *compare,
                                          struct cs_error *error) {
    if (cs_row_table_lock(&results->table, error))
        return error->status;
    if (!read_again(results, compare, error))
        write_rows(results, compare, true, error);
    cs_row_table_unlock(&results->table);
    return error->status;
}

void cs_compare_results_close(struct cs_compare_results *results) {
    free(results->old_rows);
    *results = (struct cs_compare_results){0};
}

/* Adds the rows of one file, after a check that all belong to one comparison. */
static enum cs_status add_file(struct cs_compare *compare, const char *folder, bool unchecked,
                               struct cs_error *error) {
    struct cs_cell_list *list = &compare->cells;
    struct cs_cell *cells;
    char path[4200];
    uint32_t n;
    snprintf(path, sizeof path, "%s/%s", folder, NAME);
    read_rows(path, unchecked, compare->machine, &cells, &n, error);
    for (uint32_t k = 0; k < n && !error->status; k++)
        if (strncmp(cells[k].key, list->n ? list->cells[0].key : cells[k].key,
                    CS_COMPARE_DIGITS) != 0)
            cs_fail(error, CS_ERR_USAGE, "%s belongs to another scene, time or reference",
                    path);
        else
            cs_cell_list_add(list, cells + k, error);
    free(cells);
    return error->status;
}

enum cs_status cs_compare_results_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, bool unchecked, uint32_t *n,
                                        struct cs_error *error) {
    struct cs_compare_results results = {0};
    struct cs_compare compare = {0};
    cs_machine_name(compare.machine);
    // what is in the whole already is a part of it
    if (!cs_row_table_open(&results.table, out, NAME, ".lock", 0, error))
        add_file(&compare, out, unchecked, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++)
        add_file(&compare, folders[k], unchecked, error);
    *n = compare.cells.n;
    if (!error->status && *n > 0)
        write_rows(&results, &compare, false, error);
    cs_cell_list_finish(&compare.cells);
    return error->status;
}
