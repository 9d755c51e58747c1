/* Runs the Cartesian product of values and methods, and stores one row per cell. */
#include "study/parameter_sweep.h"

#include "base/file.h"
#include "base/table.h"
#include "study/parameter_sweep_cell.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const NAME = "sweep.csv";

/* The rows by their cells: each begins with the number of its cell and ends with its key. */
struct sweep_rows {
    struct cs_row_table table;
    struct cs_text names; /* first line; empty: not known yet */
    char **lines;         /* (n) owned; NULL: not there */
    uint32_t n;
};

/* Frees all lines. */
static void finish_rows(struct sweep_rows *rows) {
    for (uint32_t k = 0; k < rows->n; k++)
        free(rows->lines[k]);
    free(rows->lines);
    cs_text_finish(&rows->names);
}

/* Grows the array of lines to n; new ones are NULL. */
static enum cs_status reserve_rows(struct sweep_rows *rows, uint32_t n,
                                   struct cs_error *error) {
    if (n <= rows->n)
        return CS_OK;
    char **lines = realloc(rows->lines, n * sizeof *lines);
    if (!lines)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u rows", n);
    memset(lines + rows->n, 0, (n - rows->n) * sizeof *lines);
    rows->lines = lines;
    rows->n = n;
    return CS_OK;
}

/* The key of a row, its last column. */
static const char *key_of(const char *line) {
    const char *comma = strrchr(line, ',');
    return comma ? comma + 1 : "";
}

/* Stores a line under its cell; a text that is no row is skipped. Two different keys for one
 * cell mean two different sweeps. */
static enum cs_status store_line(struct sweep_rows *rows, const char *line, const char *path,
                                 struct cs_error *error) {
    char *end;
    const unsigned long cell = strtoul(line, &end, 10);
    if (end == line || *end != ',' || cell >= CS_PARAMETER_SWEEP_CELLS_MAX)
        return CS_OK;
    if (reserve_rows(rows, (uint32_t)cell + 1, error))
        return error->status;
    char **stored = rows->lines + cell;
    if (*stored && strcmp(key_of(*stored), key_of(line)) != 0)
        return cs_fail(error, CS_ERR_USAGE, "%s belongs to a different sweep: cell %lu differs",
                       path, cell);
    if (!*stored && !(*stored = strdup(line)))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the rows of %s", path);
    return error->status;
}

/* Adds the rows of a folder, if there are any. Their columns must be those of the sweep. */
static enum cs_status read_rows(struct sweep_rows *rows, const char *folder,
                                struct cs_error *error) {
    struct cs_rows found;
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, NAME);
    if (access(path, F_OK) || cs_rows_open(&found, path, 0, error))
        return error->status;
    const char *line = cs_rows_next(&found);
    if (line && !rows->names.length)
        cs_text_add(&rows->names, "%s", line);
    if (rows->names.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the columns");
    else if (line && strcmp(cs_text_get(&rows->names), line) != 0)
        cs_fail(error, CS_ERR_USAGE, "%s belongs to a different sweep: its columns differ",
                path);
    while (!error->status && (line = cs_rows_next(&found)))
        store_line(rows, line, path, error);
    cs_rows_close(&found);
    return error->status;
}

/* All rows in the order of the cells. */
static enum cs_status write_rows(const struct sweep_rows *rows, struct cs_error *error) {
    struct cs_text out = {.failed = rows->names.failed};
    cs_text_add(&out, "%s\n", cs_text_get(&rows->names));
    for (uint32_t k = 0; k < rows->n; k++)
        if (rows->lines[k])
            cs_text_add(&out, "%s\n", rows->lines[k]);
    return cs_file_write_text(rows->table.path, &out, error);
}

/* Number of finished cells. */
static uint32_t count_rows(const struct sweep_rows *rows) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < rows->n; k++)
        n += rows->lines[k] != NULL;
    return n;
}

/* Runs one cell, unless its row exists or it belongs to another shard. */
static enum cs_status do_cell(struct cs_parameter_sweep *product, const struct sweep_rows *rows,
                              uint32_t number, struct cs_error *error) {
    struct cs_parameter_sweep_cell cell;
    struct cs_text line = {0};
    const char *taken = rows->lines[number];
    if (!taken && !cs_shard_holds(&product->shard, number))
        return CS_OK;
    if (cs_parameter_sweep_cell_open(&cell, product, number, error))
        return error->status;
    product->n_reused += taken != NULL;
    if (taken && strcmp(key_of(taken), cell.key) != 0)
        cs_fail(error, CS_ERR_USAGE,
                "%s belongs to a different sweep; choose another folder with --out",
                rows->table.path);
    else if (!taken && !cs_parameter_sweep_cell_run(&cell, product, &line, error))
        cs_row_table_append(&rows->table, line.bytes, line.length, error);
    cs_text_finish(&line);
    cs_parameter_sweep_cell_close(&cell);
    return error->status;
}

/* Writes the first line of a new file, or adds the rows of an old one. */
static enum cs_status begin(struct cs_parameter_sweep *product, struct sweep_rows *rows,
                            struct cs_error *error) {
    cs_parameter_sweep_add_head(product, &rows->names);
    if (reserve_rows(rows, product->cells, error) || cs_row_table_lock(&rows->table, error))
        return error->status;
    if (access(rows->table.path, F_OK))
        write_rows(rows, error);
    else
        read_rows(rows, product->folder, error);
    cs_row_table_unlock(&rows->table);
    if (!error->status && rows->n > product->cells)
        cs_fail(error, CS_ERR_USAGE,
                "%s belongs to a different sweep; choose another folder with --out",
                rows->table.path);
    return error->status;
}

/* Adds what this and other processes have appended since; the rows are written in order when
 * all are there. */
static enum cs_status end(struct cs_parameter_sweep *product, struct sweep_rows *rows,
                          struct cs_error *error) {
    if (cs_row_table_lock(&rows->table, error))
        return error->status;
    read_rows(rows, product->folder, error);
    product->n_done = count_rows(rows);
    if (!error->status && product->n_done == product->cells)
        write_rows(rows, error);
    cs_row_table_unlock(&rows->table);
    return error->status;
}

static enum cs_status count(struct cs_parameter_sweep *product, struct cs_error *error) {
    double cells = product->n_methods ? product->n_methods : 1;
    for (uint32_t k = 0; k < product->n_keys; k++)
        cells *= product->keys[k].n;
    if (cells > CS_PARAMETER_SWEEP_CELLS_MAX)
        return cs_fail(error, CS_ERR_USAGE, "%.0f cells, expected at most %d", cells,
                       CS_PARAMETER_SWEEP_CELLS_MAX);
    product->cells = (uint32_t)cells;
    return CS_OK;
}

enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *product,
                                      struct cs_error *error) {
    struct sweep_rows rows = {0};
    if (count(product, error))
        return error->status;
    if (!cs_row_table_open(&rows.table, product->folder, NAME, ".lock", 0, error) &&
        !begin(product, &rows, error)) {
        for (uint32_t k = 0; k < product->cells && !error->status; k++) {
            do_cell(product, &rows, k, error);
            if (product->progress)
                product->progress(product->ctx, k + 1, product->cells);
        }
        if (!error->status)
            end(product, &rows, error);
    }
    finish_rows(&rows);
    return error->status;
}

enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error) {
    struct sweep_rows rows = {0};
    if (!cs_row_table_open(&rows.table, out, NAME, ".lock", 0, error))
        read_rows(&rows, out, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++)
        read_rows(&rows, folders[k], error);
    *n = count_rows(&rows);
    if (!error->status && rows.names.length)
        write_rows(&rows, error);
    finish_rows(&rows);
    return error->status;
}
