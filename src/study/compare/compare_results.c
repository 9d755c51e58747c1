/* Takes over, appends and rewrites the rows of compare.csv. */
#include "study/compare/compare_results.h"

#include "base/file.h"
#include "base/lock.h"
#include "study/compare/compare_csv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct cs_cell *find(const struct cs_cell_list *sweep, const struct cs_cell *cell) {
    for (uint32_t k = 0; k < sweep->n; k++)
        if (cs_cell_same_series(sweep->cells + k, cell) &&
            !strcmp(sweep->cells[k].options, cell->options))
            return sweep->cells + k;
    return NULL;
}

/* The cells, and behind them rows of the file that are none of them. */
static enum cs_status write_rows(const struct cs_compare_results *ledger,
                                 const struct cs_compare *compare, bool others,
                                 struct cs_error *error) {
    struct cs_text text = {0};
    cs_csv_add_head(&text);
    for (uint32_t k = 0; k < compare->cells.n; k++)
        if (*compare->cells.cells[k].outcome)
            cs_csv_add_cell(&text, compare->cells.cells + k);
    for (uint32_t k = 0; k < ledger->n_old_rows && others; k++)
        if (!find(&compare->cells, ledger->old_rows + k))
            cs_csv_add_cell(&text, ledger->old_rows + k);
    if (text.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", ledger->path);
    else
        cs_file_write(ledger->path, cs_text_get(&text), text.length, error);
    cs_text_finish(&text);
    return error->status;
}

static enum cs_status read_rows(struct cs_compare_results *ledger,
                                const struct cs_compare *compare, struct cs_error *error) {
    free(ledger->old_rows);
    ledger->old_rows = NULL;
    ledger->n_old_rows = 0;
    if (access(ledger->path, F_OK))
        return CS_OK;
    if (cs_csv_read(ledger->path, &ledger->old_rows, &ledger->n_old_rows, error))
        return error->status;
    for (uint32_t i = 0; i < ledger->n_old_rows; i++)
        cs_cell_name_machine(ledger->old_rows + i, compare->machine);
    return CS_OK;
}

/* A file that is none of ours, or of another comparison, is not written over. */
static enum cs_status read_old(struct cs_compare_results *ledger,
                               const struct cs_compare *compare, struct cs_error *error) {
    if (read_rows(ledger, compare, error))
        return error->status;
    if (compare->settings->overwrite)
        ledger->n_old_rows = 0;
    for (uint32_t i = 0; i < ledger->n_old_rows && compare->cells.n > 0; i++)
        if (strncmp(ledger->old_rows[i].key, compare->cells.cells[0].key, CS_COMPARE_DIGITS) !=
            0)
            return cs_fail(error, CS_ERR_USAGE,
                           "%s is of another scene, time or reference: give another folder "
                           "with --out, or --fresh to write over it",
                           ledger->path);
    return CS_OK;
}

static bool is_over_budget(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET));
}

/* What was stopped is run again where there is more time now, and what has no ledger where one
 * is asked for. */
static bool is_valid(const struct cs_cell *old, const struct cs_compare *compare) {
    if (compare->settings->ledger && cs_cell_is_finished(old) && !cs_cell_has_ledger(old))
        return false;
    return *old->outcome && (!is_over_budget(old) || old->cpu > 0.9 * compare->budget);
}

static enum cs_status reuse_row(struct cs_compare_results *ledger, struct cs_compare *compare,
                                struct cs_error *error) {
    struct cs_cell_list *sweep = &compare->cells;
    for (uint32_t i = 0; i < ledger->n_old_rows && !error->status; i++) {
        const struct cs_cell *old = ledger->old_rows + i;
        struct cs_cell *found = find(sweep, old);
        if (!found)
            cs_cell_list_add(sweep, old, error);
        else if (*found->outcome)
            continue;
        else if (!strcmp(found->key, old->key) && is_valid(old, compare))
            *found = *old;
        else
            continue;
        compare->n_reused++;
    }
    return error->status;
}

enum cs_status cs_compare_results_open(struct cs_compare_results *ledger,
                                       struct cs_compare *compare, struct cs_error *error) {
    struct cs_lock lock;
    *ledger = (struct cs_compare_results){0};
    snprintf(ledger->path, sizeof ledger->path, "%s/compare.csv", compare->settings->folder);
    snprintf(ledger->lock_path, sizeof ledger->lock_path, "%s/.lock",
             compare->settings->folder);
    if (cs_folder_create(compare->settings->folder, error) ||
        cs_lock_acquire(&lock, ledger->lock_path, error))
        return error->status;
    if (!read_old(ledger, compare, error) && !reuse_row(ledger, compare, error))
        write_rows(ledger, compare, false, error);
    cs_lock_release(&lock);
    return error->status;
}

enum cs_status cs_compare_results_append(struct cs_compare_results *ledger,
                                         const struct cs_cell *cell, struct cs_error *error) {
    struct cs_text line = {0};
    struct cs_lock lock;
    cs_csv_add_cell(&line, cell);
    if (line.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    else if (!cs_lock_acquire(&lock, ledger->lock_path, error)) {
        cs_file_append(ledger->path, line.bytes, line.length, error);
        cs_lock_release(&lock);
    }
    cs_text_finish(&line);
    return error->status;
}

enum cs_status cs_compare_results_refresh(struct cs_compare_results *ledger,
                                          struct cs_compare *compare, struct cs_error *error) {
    struct cs_lock lock;
    if (cs_lock_acquire(&lock, ledger->lock_path, error))
        return error->status;
    if (!read_rows(ledger, compare, error))
        reuse_row(ledger, compare, error);
    cs_lock_release(&lock);
    return error->status;
}

enum cs_status cs_compare_results_rewrite(struct cs_compare_results *ledger,
                                          const struct cs_compare *compare,
                                          struct cs_error *error) {
    struct cs_lock lock;
    if (cs_lock_acquire(&lock, ledger->lock_path, error))
        return error->status;
    if (!read_rows(ledger, compare, error))
        write_rows(ledger, compare, true, error);
    cs_lock_release(&lock);
    return error->status;
}

void cs_compare_results_close(struct cs_compare_results *ledger) {
    free(ledger->old_rows);
    *ledger = (struct cs_compare_results){0};
}

/* Adds the rows of one file. */
static enum cs_status add_file(struct cs_cell_list *sweep, const char *path, const char *here,
                               struct cs_error *error) {
    struct cs_cell *cells;
    uint32_t n;
    if (access(path, F_OK) || cs_csv_read(path, &cells, &n, error))
        return error->status;
    for (uint32_t k = 0; k < n && !error->status; k++) {
        cs_cell_name_machine(cells + k, here);
        if (strncmp(cells[k].key, sweep->n ? sweep->cells[0].key : cells[k].key,
                    CS_COMPARE_DIGITS) != 0)
            cs_fail(error, CS_ERR_USAGE, "%s is of another scene, time or reference", path);
        else
            cs_cell_list_add(sweep, cells + k, error);
    }
    free(cells);
    return error->status;
}

enum cs_status cs_compare_results_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error) {
    struct cs_compare_results ledger = {0};
    struct cs_compare compare = {0};
    char path[4096];
    cs_machine_name(compare.machine);
    snprintf(ledger.path, sizeof ledger.path, "%s/compare.csv", out);
    // what is in the whole already is a part of it
    add_file(&compare.cells, ledger.path, compare.machine, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++) {
        snprintf(path, sizeof path, "%s/compare.csv", folders[k]);
        add_file(&compare.cells, path, compare.machine, error);
    }
    *n = compare.cells.n;
    if (!error->status && *n > 0)
        write_rows(&ledger, &compare, false, error);
    cs_cell_list_finish(&compare.cells);
    return error->status;
}
