/* Runs the Cartesian product of values and methods, and stores one row per cell. */
#include "sweep/parameter_sweep.h"

#include "session/process_pool.h"
#include "session/scene_view.h"
#include "sweep/sweep_cell.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The result that the process of a cell hands over. */
struct cell_row {
    char key[CS_HASH_DIGITS]; /* "": it has not come so far */
    enum cs_status failure;   /* why the row says "failed" */
    size_t length;            /* of the line */
    char line[];              /* (row_bytes) */
};

/* A sweep under way. */
struct sweep_work {
    struct cs_parameter_sweep *sweep;
    struct cs_sweep_rows *rows;
    uint32_t at;      /* the next cell to look at */
    size_t row_bytes; /* that a row may have */
    struct cell_row *slots[CS_PROCESS_POOL_MAX];
    uint32_t cells[CS_PROCESS_POOL_MAX]; /* that the slots run */
};

/* Bytes of the longest row: quotes double at most, and the rest is bounded. */
static size_t longest_row(const struct cs_parameter_sweep *sweep) {
    size_t bytes = 8192, longest = 0;
    for (uint32_t k = 0; k < sweep->n_keys; k++, bytes += 2 * longest + 3, longest = 0)
        for (uint32_t v = 0; v < sweep->keys[k].n; v++)
            if (strlen(sweep->keys[k].values[v]) > longest)
                longest = strlen(sweep->keys[k].values[v]);
    for (uint32_t m = 0; m < sweep->n_methods; m++)
        if (2 * strlen(sweep->methods[m]) > longest)
            longest = 2 * strlen(sweep->methods[m]);
    return bytes + longest;
}

/* Chooses the next cell that has no row, belongs to the shard, and that no other process runs.
 */
static bool next_cell(void *ctx, uint32_t slot, struct cs_error *error) {
    struct sweep_work *work = ctx;
    const struct cs_parameter_sweep *sweep = work->sweep;
    while (work->at < sweep->counts.cells && !error->status) {
        const uint32_t number = work->at++;
        if (work->rows->lines[number] || !cs_shard_holds(&sweep->shard, number) ||
            !cs_sweep_rows_lock_cell(work->rows, number, sweep->folder, error))
            continue;
        work->cells[slot] = number;
        memset(work->slots[slot], 0, sizeof *work->slots[slot]);
        return true;
    }
    return false;
}

/* In the process of a cell: runs it and hands its row over. */
static enum cs_status run_cell(void *ctx, uint32_t slot, struct cs_error *error) {
    const struct sweep_work *work = ctx;
    struct cell_row *row = work->slots[slot];
    struct cs_sweep_cell cell;
    struct cs_text line = {0};
    if (cs_sweep_cell_open(&cell, work->sweep, work->cells[slot], error))
        return error->status;
    memcpy(row->key, cell.key, sizeof row->key);
    cs_sweep_cell_run(&cell, work->sweep, cs_text_get(&work->rows->names), &line, error);
    cs_sweep_cell_close(&cell);
    if (!error->status && line.length > work->row_bytes)
        cs_fail(error, CS_ERR_INTERNAL, "a row of %zu bytes", line.length);
    if (!error->status) {
        row->failure = cell.refusal.status;
        row->length = line.length;
        memcpy(row->line, line.bytes, line.length);
    }
    cs_text_finish(&line);
    return error->status;
}

/* Stores the row of a cell, or of its failure. An interrupted one has none. */
static void end_cell(void *ctx, uint32_t slot, const struct cs_error *result,
                     struct cs_error *error) {
    struct sweep_work *work = ctx;
    const struct cell_row *row = work->slots[slot];
    struct cs_parameter_sweep *sweep = work->sweep;
    const volatile sig_atomic_t *stop = sweep->session.run.stop;
    const uint32_t number = work->cells[slot];
    const enum cs_status failure = result->status ? result->status : row->failure;
    struct cs_text line = {0};
    if (result->status)
        cs_sweep_cell_add_lost(number, sweep, result->message, row->key,
                               cs_text_get(&work->rows->names), &line);
    else
        cs_text_add(&line, "%.*s", (int)row->length, row->line);
    /* a cell that stops though nobody asked for it has failed */
    if (result->status != CS_ERR_INTERRUPT || !(stop && *stop))
        cs_sweep_rows_append(work->rows, number, &line, error);
    cs_sweep_rows_unlock_cell(work->rows, number);
    cs_text_finish(&line);
    if (failure && failure != CS_ERR_SCENE && failure != CS_ERR_MODULE &&
        failure != CS_ERR_INTERRUPT)
        cs_fail(&sweep->cell_failure, failure, "cell %u failed%s%s", number,
                result->status ? ": " : "; its row says why", result->message);
    if (sweep->progress)
        sweep->progress(sweep->ctx, work->at, sweep->counts.cells);
}

/* In a process of its own: compares the keys of the rows that are there with the cells. */
static enum cs_status verify_rows(void *ctx, struct cs_error *error) {
    const struct sweep_work *work = ctx;
    for (uint32_t k = 0; k < work->sweep->counts.cells && !error->status; k++) {
        const char *line = work->rows->lines[k];
        struct cs_sweep_cell cell;
        /* a cell that failed before it was read has no key */
        if (!line || !*cs_sweep_row_key(line))
            continue;
        if (!cs_sweep_cell_open(&cell, work->sweep, k, error) &&
            strcmp(cs_sweep_row_key(line), cell.key) != 0)
            cs_fail(error, CS_ERR_USAGE,
                    "%s belongs to a different sweep; choose another folder with --out, or "
                    "--overwrite to replace it",
                    work->rows->table.path);
        cs_sweep_cell_close(&cell);
    }
    return error->status;
}

/* Runs all cells that are left. */
static enum cs_status run_cells(struct sweep_work *work, struct cs_error *error) {
    const struct cs_parameter_sweep *sweep = work->sweep;
    struct cs_isolate_queue queue = {.isolate = {.seconds = sweep->call_seconds,
                                                 .task_seconds = sweep->cell_seconds,
                                                 .stop_seconds = 0.5,
                                                 .bytes = sweep->cell_bytes,
                                                 .is_cell = true,
                                                 .stop = sweep->session.run.stop},
                                     .n_slots = sweep->jobs ? sweep->jobs : 1,
                                     .ctx = work,
                                     .next = next_cell,
                                     .task = run_cell,
                                     .ended = end_cell};
    const size_t bytes = sizeof **work->slots + (work->row_bytes = longest_row(sweep));
    for (uint32_t k = 0; k < queue.n_slots && !error->status; k++)
        work->slots[k] = cs_process_pool_shared_alloc(bytes, error);
    if (!error->status)
        cs_isolate_queue_run(&queue, error);
    for (uint32_t k = 0; k < queue.n_slots; k++)
        cs_process_pool_shared_free(work->slots[k], bytes);
    return queue.isolate.stop && *queue.isolate.stop
               ? cs_fail(error, CS_ERR_INTERRUPT, "interrupted; finished rows are saved")
               : error->status;
}

/* Writes the first line of a new file, or adds the rows of an old one. */
static enum cs_status begin(struct cs_parameter_sweep *sweep, struct cs_sweep_rows *rows,
                            struct cs_error *error) {
    cs_sweep_add_names(sweep, &rows->names);
    if (cs_sweep_rows_reserve(rows, sweep->counts.cells, error) ||
        cs_row_table_lock(&rows->table, error))
        return error->status;
    if (!sweep->overwrite)
        cs_sweep_rows_read(rows, sweep->folder, error);
    if (sweep->retry_failed)
        cs_sweep_rows_drop_failed(rows, sweep->n_keys);
    if (!error->status)
        cs_sweep_rows_write(rows, error);
    cs_row_table_unlock(&rows->table);
    sweep->counts.reused = cs_sweep_rows_count(rows);
    if (!error->status && rows->n > sweep->counts.cells)
        cs_fail(error, CS_ERR_USAGE,
                "%s belongs to a different sweep; choose another folder with --out, or "
                "--overwrite to replace it",
                rows->table.path);
    return error->status;
}

/* Counts the rows by their outcomes, and describes the first failed ones. */
static void count_rows(struct cs_parameter_sweep *sweep, const struct cs_sweep_rows *rows) {
    enum { SHOWN = 10 };
    struct cs_parameter_sweep_counts *counts = &sweep->counts;
    counts->done = cs_sweep_rows_count(rows);
    for (uint32_t k = 0; k < rows->n; k++) {
        struct cs_sweep_fields fields;
        char *line = rows->lines[k] ? strdup(rows->lines[k]) : NULL;
        if (line && cs_sweep_row_cut(line, sweep->n_keys, &fields)) {
            counts->blown_up += !strncmp(fields.outcome, "blew up", 7);
            if (!strcmp(fields.outcome, "refused") && !counts->refused++)
                snprintf(counts->first_refusal, sizeof counts->first_refusal, "%s",
                         fields.note);
            if (!strcmp(fields.outcome, "failed") && ++counts->failed <= SHOWN) {
                cs_text_add(&sweep->failed, "failed: cell %u (", k);
                for (uint32_t v = 0; v < sweep->n_keys; v++)
                    cs_text_add(&sweep->failed, "%s%s=%s", v ? ", " : "", sweep->keys[v].path,
                                fields.values[v]);
                cs_text_add(&sweep->failed, "%s%s): %s\n",
                            sweep->n_keys && *fields.method ? ", " : "", fields.method,
                            fields.note);
            }
        }
        free(line);
    }
    if (counts->failed > SHOWN)
        cs_text_add(&sweep->failed, "failed: %u more\n", counts->failed - SHOWN);
}

/* Adds what this and other processes have appended since; the rows are written in order when
 * all are there. */
static enum cs_status end(struct cs_parameter_sweep *sweep, struct cs_sweep_rows *rows,
                          struct cs_error *error) {
    if (cs_row_table_lock(&rows->table, error))
        return error->status;
    cs_sweep_rows_read(rows, sweep->folder, error);
    count_rows(sweep, rows);
    if (!error->status && sweep->counts.done == sweep->counts.cells)
        cs_sweep_rows_write(rows, error);
    cs_row_table_unlock(&rows->table);
    return error->status;
}

static enum cs_status count(struct cs_parameter_sweep *sweep, struct cs_error *error) {
    double cells = sweep->n_methods ? sweep->n_methods : 1;
    for (uint32_t k = 0; k < sweep->n_keys; k++)
        cells *= sweep->keys[k].n;
    if (cells > CS_PARAMETER_SWEEP_CELLS_MAX)
        return cs_fail(error, CS_ERR_USAGE, "%.0f cells, expected at most %d", cells,
                       CS_PARAMETER_SWEEP_CELLS_MAX);
    sweep->counts = (struct cs_parameter_sweep_counts){.cells = (uint32_t)cells};
    return CS_OK;
}

/* Reads the scene with one key set or with none, by a method; a refusal by the scene is left in
 * *refusal. */
static enum cs_status try_override(const struct cs_parameter_sweep *sweep,
                                   const struct cs_override *key, const char *method,
                                   struct cs_error *refusal, struct cs_error *error) {
    struct cs_session_settings asked = sweep->session;
    struct cs_session session = {0};
    asked.overrides = key;
    asked.n_overrides = key != NULL;
    asked.integrator = method;
    *refusal = (struct cs_error){0};
    if (cs_session_open_plan(&session, &asked, refusal) && refusal->status != CS_ERR_SCENE)
        cs_fail(error, refusal->status, "%s", refusal->message);
    cs_session_close(&session);
    return error->status;
}

/* In a process of its own: refuses a key that the scene takes with none of its values: it is
 * misspelt, or its values are; and a method that cannot be loaded. Of a scene that is refused
 * by itself nothing can be said. */
static enum cs_status check_keys(void *ctx, struct cs_error *error) {
    const struct cs_parameter_sweep *sweep = ctx;
    const char *method = sweep->n_methods ? sweep->methods[0] : NULL;
    struct cs_error refusal;
    for (uint32_t k = sweep->n_methods; k-- > 1 && !error->status;)
        try_override(sweep, NULL, sweep->methods[k], &refusal, error);
    if (error->status || try_override(sweep, NULL, method, &refusal, error) || refusal.status)
        return error->status;
    for (uint32_t k = 0; k < sweep->n_keys && !error->status; k++) {
        const struct cs_parameter_axis *key = sweep->keys + k;
        bool taken = false;
        for (uint32_t v = 0; v < key->n && !error->status; v++) {
            try_override(sweep, &(struct cs_override){key->path, key->values[v]}, method,
                         &refusal, error);
            taken |= !refusal.status;
        }
        if (!taken && !error->status)
            cs_fail(error, refusal.status, "%s", refusal.message);
    }
    return error->status;
}

/* Runs a check that may load modules in a process of its own. */
static enum cs_status check_apart(const struct cs_parameter_sweep *sweep,
                                  enum cs_status (*check)(void *ctx, struct cs_error *error),
                                  void *ctx, struct cs_error *error) {
    const struct cs_isolate isolate = {.seconds = sweep->call_seconds,
                                       .stop_seconds = 0.5,
                                       .is_cell = true,
                                       .task = check,
                                       .ctx = ctx,
                                       .stop = sweep->session.run.stop};
    return cs_isolate_run(&isolate, error);
}

/* Standard input is read once, and processes begun later have it too. */
static void read_input(const struct cs_parameter_sweep *sweep) {
    struct cs_scene scene;
    struct cs_error unseen = {0};
    if (!strcmp(sweep->session.scene, "-") &&
        !cs_scene_read(&scene, sweep->session.scene, NULL, 0, &unseen))
        cs_scene_finish(&scene);
}

enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *sweep,
                                      struct cs_error *error) {
    read_input(sweep);
    struct cs_sweep_rows rows = {0};
    struct sweep_work work = {.sweep = sweep, .rows = &rows};
    if (count(sweep, error) || check_apart(sweep, check_keys, sweep, error))
        return error->status;
    if (!cs_sweep_rows_open(&rows, sweep->folder, error) && !begin(sweep, &rows, error) &&
        !(sweep->counts.reused && check_apart(sweep, verify_rows, &work, error)) &&
        !run_cells(&work, error))
        end(sweep, &rows, error);
    cs_sweep_rows_finish(&rows);
    return error->status;
}

enum cs_status cs_parameter_sweep_count(struct cs_parameter_sweep *sweep,
                                        struct cs_error *error) {
    struct cs_sweep_rows rows = {0};
    cs_sweep_add_names(sweep, &rows.names);
    if (!count(sweep, error) && !access(sweep->folder, F_OK) &&
        !cs_sweep_rows_reserve(&rows, sweep->counts.cells, error) &&
        !cs_sweep_rows_open(&rows, sweep->folder, error) &&
        !cs_sweep_rows_read(&rows, sweep->folder, error)) {
        count_rows(sweep, &rows);
        for (uint32_t k = 0; k < sweep->counts.cells; k++)
            sweep->counts.running += cs_sweep_rows_is_locked(&rows, k);
    }
    cs_sweep_rows_finish(&rows);
    return error->status;
}

enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, bool unchecked, uint32_t *n,
                                        struct cs_error *error) {
    struct cs_sweep_rows rows = {0};
    cs_sweep_rows_open(&rows, out, error);
    rows.unchecked = unchecked;
    if (!error->status)
        cs_sweep_rows_read(&rows, out, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++)
        cs_sweep_rows_read(&rows, folders[k], error);
    *n = cs_sweep_rows_count(&rows);
    if (!error->status && rows.names.length)
        cs_sweep_rows_write(&rows, error);
    cs_sweep_rows_finish(&rows);
    return error->status;
}
