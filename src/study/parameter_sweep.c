/* Runs the Cartesian product of values and methods, and keeps a row a cell. */
#include "study/parameter_sweep.h"

#include "base/lock.h"
#include "study/parameter_sweep_cell.h"
#include "study/parameter_sweep_table.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Others' cells are not looked at: their rows are there, or are none of this process's. */
static enum cs_status do_cell(struct cs_parameter_sweep *product,
                              struct cs_parameter_sweep_table *table, uint32_t number,
                              struct cs_error *error) {
    struct cs_parameter_sweep_cell cell;
    struct cs_text line = {0};
    const bool taken = table->lines[number];
    if (!taken && !cs_shard_holds(&product->shard, number))
        return CS_OK;
    if (cs_parameter_sweep_cell_open(&cell, product, number, error))
        return error->status;
    product->n_reused += taken;
    if (taken && !cs_product_table_has(table, number, cell.key))
        cs_fail(error, CS_ERR_USAGE, "%s is of another sweep: give another folder with --out",
                table->path);
    else if (!taken && !cs_parameter_sweep_cell_run(&cell, product, &line, error))
        cs_parameter_sweep_table_store(table, number, cs_text_get(&line), error);
    cs_text_finish(&line);
    cs_parameter_sweep_cell_close(&cell);
    return error->status;
}

/* Makes the first line of a new file, or checks that of an old one, and takes its rows over. */
static enum cs_status begin(struct cs_parameter_sweep *product,
                            struct cs_parameter_sweep_table *table, struct cs_error *error) {
    struct cs_text head = {0};
    struct cs_lock lock;
    cs_parameter_sweep_add_head(product, &head);
    table->header = head.failed ? NULL : strdup(cs_text_get(&head));
    cs_text_finish(&head);
    if (!table->header)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the columns");
    if (cs_product_table_grow(table, product->cells, error) ||
        cs_lock_acquire(&lock, table->lock, error))
        return error->status;
    if (access(table->path, F_OK))
        cs_product_table_write(table, error);
    else
        cs_product_table_read(table, table->path, error);
    cs_lock_release(&lock);
    if (!error->status && table->n > product->cells)
        cs_fail(error, CS_ERR_USAGE, "%s is of another sweep: give another folder with --out",
                table->path);
    return error->status;
}

/* With what others have added meanwhile; in order where nothing is left to do. */
static enum cs_status end(struct cs_parameter_sweep *product,
                          struct cs_parameter_sweep_table *table, struct cs_error *error) {
    struct cs_lock lock;
    if (cs_lock_acquire(&lock, table->lock, error))
        return error->status;
    cs_product_table_read(table, table->path, error);
    product->n_done = 0;
    for (uint32_t k = 0; k < product->cells && !error->status; k++)
        product->n_done += table->lines[k] != NULL;
    if (!error->status && product->n_done == product->cells)
        cs_product_table_write(table, error);
    cs_lock_release(&lock);
    return error->status;
}

static enum cs_status count(struct cs_parameter_sweep *product, struct cs_error *error) {
    double cells = product->n_methods ? product->n_methods : 1;
    for (uint32_t k = 0; k < product->n_keys; k++)
        cells *= product->keys[k].n;
    if (cells > CS_PARAMETER_SWEEP_CELLS_MAX)
        return cs_fail(error, CS_ERR_USAGE, "%.0f cells are more than %d", cells,
                       CS_PARAMETER_SWEEP_CELLS_MAX);
    product->cells = (uint32_t)cells;
    return CS_OK;
}

enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *product,
                                      struct cs_error *error) {
    struct cs_parameter_sweep_table table = {0};
    if (count(product, error))
        return error->status;
    if (!cs_product_table_open(&table, product->folder, error) &&
        !begin(product, &table, error)) {
        for (uint32_t k = 0; k < product->cells && !error->status; k++) {
            do_cell(product, &table, k, error);
            if (product->progress)
                product->progress(product->ctx, k + 1, product->cells);
        }
        if (!error->status)
            end(product, &table, error);
    }
    cs_product_table_finish(&table);
    return error->status;
}

enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error) {
    struct cs_parameter_sweep_table table;
    char path[4096];
    if (cs_product_table_open(&table, out, error))
        return error->status;
    cs_product_table_read(&table, table.path, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++) {
        snprintf(path, sizeof path, "%s/sweep.csv", folders[k]);
        cs_product_table_read(&table, path, error);
    }
    *n = 0;
    for (uint32_t k = 0; k < table.n; k++)
        *n += table.lines[k] != NULL;
    if (!error->status && table.header)
        cs_product_table_write(&table, error);
    cs_product_table_finish(&table);
    return error->status;
}
