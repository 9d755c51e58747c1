/* Runs the Cartesian product of values and methods, and stores one row per cell. */
#include "study/parameter_sweep.h"

#include "base/hash.h"
#include "model/force/diagnostics.h"
#include "scene/file/scene_read.h"
#include "sim/module.h"
#include "study/follow.h"
#include "study/provenance_write.h"
#include "study/sweep_rows.h"

#include <stdio.h>
#include <string.h>

/* One cell of a sweep: its values, its key, its run, its row.
 *
 * The number of a cell is a mixed-radix number: the last key is its fastest digit, the first
 * key a slow one, and the method the slowest. */

/* The last key changes first, and the method last. Zeroed: closed. */
struct cs_parameter_sweep_cell {
    uint32_t number;
    struct cs_override overrides[CS_PARAMETER_AXES_MAX];
    const char *method;        /* NULL: the scene's own */
    struct cs_session session; /* up to the plan, unless it was refused */
    struct cs_error refusal;   /* why it was */
    char key[CS_HASH_DIGITS];
};

/* True for errors that concern this cell only, which become a row. */
static bool is_own_fault(const struct cs_error *failure) {
    return failure->status == CS_ERR_SCENE || failure->status == CS_ERR_MODULE;
}

/* Splits the number of the cell into the indices of its values. */
static void choose_values(struct cs_parameter_sweep_cell *cell,
                          const struct cs_parameter_sweep *product) {
    uint32_t rest = cell->number;
    for (uint32_t k = product->n_keys; k-- > 0;) {
        const struct cs_parameter_axis *key = product->keys + k;
        cell->overrides[k] = (struct cs_override){key->path, key->values[rest % key->n]};
        rest /= key->n;
    }
    cell->method = product->n_methods ? product->methods[rest] : NULL;
}

/* Adds hashes of scene and module, which identify equal cells whatever their text. */
static void add_meaning(struct cs_parameter_sweep_cell *cell, struct cs_text *all,
                        struct cs_error *error) {
    struct cs_session *session = &cell->session;
    const struct cs_registry_entry *found;
    char scene[CS_HASH_DIGITS] = "", module[CS_HASH_DIGITS] = "";
    if (cs_scene_hash(&session->scene, &session->method.table, session->method.options, scene,
                      error) ||
        cs_registry_find(&session->registry, session->method.integrator->name, &found, error) ||
        cs_module_hash(found->file, module, error))
        return;
    cs_text_add(all, "|%s|%s", scene, module);
}

static void add_refusal(const struct cs_parameter_sweep_cell *cell, uint32_t n_keys,
                        struct cs_text *all) {
    cs_text_add(all, "|%s|%s", cell->method ? cell->method : "", cell->refusal.message);
    for (uint32_t k = 0; k < n_keys; k++)
        cs_text_add(all, "|%s=%s", cell->overrides[k].path, cell->overrides[k].value);
}

static enum cs_status make_key(struct cs_parameter_sweep_cell *cell,
                               const struct cs_parameter_sweep *product,
                               struct cs_error *error) {
    struct cs_text all = {0};
    cs_text_add(&all, "%s|%u", CS_VERSION, product->frames);
    if (cell->refusal.status)
        add_refusal(cell, product->n_keys, &all);
    else
        add_meaning(cell, &all, error);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the key of a cell");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, cell->key);
    cs_text_finish(&all);
    return error->status;
}

/* Reads the scene with the cell's values and computes its key: a hash of the resolved scene
 * with its mesh files, of method, options and module, of frames and version. The key of a
 * refused cell hashes the request and the reason. A refusal is no error here. CS_ERR_USAGE and
 * other errors that are not the cell's own; CS_ERR_MEMORY. */
static enum cs_status parameter_sweep_cell_open(struct cs_parameter_sweep_cell *cell,
                                                const struct cs_parameter_sweep *product,
                                                uint32_t number, struct cs_error *error) {
    struct cs_session_settings asked = product->session;
    *cell = (struct cs_parameter_sweep_cell){.number = number};
    choose_values(cell, product);
    asked.overrides = cell->overrides;
    asked.n_overrides = product->n_keys;
    asked.integrator = cell->method;
    if (cs_session_open_plan(&cell->session, &asked, &cell->refusal) &&
        !is_own_fault(&cell->refusal))
        return cs_fail(error, cell->refusal.status, "%s", cell->refusal.message);
    return make_key(cell, product, error);
}

/* Closes the cell's session. */
static void parameter_sweep_cell_close(struct cs_parameter_sweep_cell *cell) {
    cs_session_close(&cell->session);
}

/* Adds the names of the columns, without the end of the line. */
static void parameter_sweep_add_head(const struct cs_parameter_sweep *product,
                                     struct cs_text *out) {
    cs_text_add(out, "cell");
    for (uint32_t k = 0; k < product->n_keys; k++)
        cs_csv_add_text(out, product->keys[k].path);
    cs_text_add(out, ",integrator,outcome,frames,time,steps,evals,iterations,kinetic,elastic,"
                     "energy,strain,hash,cpu,machine,version,note,key");
}

/* Adds outcome, counts and figures of the run. */
static void add_result(const struct cs_session *session, const char *outcome, double cpu,
                       struct cs_text *out) {
    const struct cs_run *run = &session->run;
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    char hash[CS_HASH_DIGITS];
    cs_run_hash(run, hash);
    cs_csv_add_text(out, outcome);
    cs_text_add(out, ",%u", run->frame);
    cs_csv_add_number(out, run->t);
    cs_text_add(out, ",%llu,%llu,%llu", (unsigned long long)run->counts.steps,
                (unsigned long long)run->counts.forces,
                (unsigned long long)run->counts.solve_iterations);
    cs_csv_add_number(out, energy.kinetic);
    cs_csv_add_number(out, energy.elastic);
    cs_csv_add_number(out, cs_energy_total(&energy));
    cs_csv_add_number(out, cs_diagnostics_strain(run->system, run->x));
    cs_csv_add_text(out, hash);
    cs_csv_add_number(out, cpu);
}

/* Adds a refusal by scene or method as a row. Errors of the command line are passed on. */
static enum cs_status add_failure(struct cs_parameter_sweep *product,
                                  const struct cs_error *failure, struct cs_text *out,
                                  struct cs_error *error) {
    if (!is_own_fault(failure))
        return cs_fail(error, failure->status, "%s", failure->message);
    if (!product->n_refused++)
        product->first_refusal = *failure;
    cs_csv_add_text(out, failure->status == CS_ERR_SCENE ? "refused" : "failed");
    cs_text_add(out, ",,,,,,,,,,,");
    return CS_OK;
}

/* Runs from the plan to the last frame. Returns the processor time in s of the frames. */
static double run_frames(struct cs_parameter_sweep_cell *cell, uint32_t frames) {
    struct cs_session *session = &cell->session;
    struct cs_error *failure = &cell->refusal;
    struct cs_follow follow = {.run = &session->run, .last = frames};
    if (!failure->status && !cs_session_build(session, failure) &&
        !cs_session_begin(session, NULL, failure))
        cs_follow_next(&follow, failure);
    return follow.cpu;
}

/* Runs the cell and adds its row, under these names. A refusal by scene or method is a row, and
 * counted. CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
static enum cs_status parameter_sweep_cell_run(struct cs_parameter_sweep_cell *cell,
                                               struct cs_parameter_sweep *product,
                                               const char *names, struct cs_text *out,
                                               struct cs_error *error) {
    const struct cs_session *session = &cell->session;
    const struct cs_integrator *integrator = session->method.integrator;
    char machine[CS_MACHINE_NAME];
    cs_text_add(out, "%u", cell->number);
    for (uint32_t k = 0; k < product->n_keys; k++)
        cs_csv_add_text(out, cell->overrides[k].value);
    const double cpu = run_frames(cell, product->frames);
    cs_csv_add_text(out, cell->method ? cell->method : integrator ? integrator->name : "");
    cs_follow_check(&session->run, "; finished rows are saved", error);
    if (!error->status && cell->refusal.status)
        add_failure(product, &cell->refusal, out, error);
    else if (!error->status)
        add_result(session, cs_outcome_text(session->run.outcome), cpu, out);
    cs_machine_name(machine);
    cs_csv_add_text(out, machine);
    cs_csv_add_text(out, CS_VERSION);
    cs_csv_add_text(out, session->run.reason ? session->run.reason : cell->refusal.message);
    cs_csv_add_text(out, cell->key);
    cs_csv_end_row(out, 0, names);
    if (out->failed && !error->status)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    return error->status;
}

/* Runs one cell, unless its row exists or it belongs to another shard. */
static enum cs_status do_cell(struct cs_parameter_sweep *product,
                              const struct cs_sweep_rows *rows, uint32_t number,
                              struct cs_error *error) {
    struct cs_parameter_sweep_cell cell;
    struct cs_text line = {0};
    const char *taken = rows->lines[number];
    if (!taken && !cs_shard_holds(&product->shard, number))
        return CS_OK;
    if (parameter_sweep_cell_open(&cell, product, number, error))
        return error->status;
    product->n_reused += taken != NULL;
    if (taken && strcmp(cs_sweep_row_key(taken), cell.key) != 0)
        cs_fail(error, CS_ERR_USAGE,
                "%s belongs to a different sweep; choose another folder with --out, or "
                "--overwrite to replace it",
                rows->table.path);
    else if (!taken &&
             !parameter_sweep_cell_run(&cell, product, cs_text_get(&rows->names), &line, error))
        cs_row_table_append(&rows->table, line.bytes, line.length, error);
    cs_text_finish(&line);
    parameter_sweep_cell_close(&cell);
    return error->status;
}

/* Writes the first line of a new file, or adds the rows of an old one. */
static enum cs_status begin(struct cs_parameter_sweep *product, struct cs_sweep_rows *rows,
                            struct cs_error *error) {
    parameter_sweep_add_head(product, &rows->names);
    if (cs_sweep_rows_reserve(rows, product->cells, error) ||
        cs_row_table_lock(&rows->table, error))
        return error->status;
    if (product->overwrite || !cs_sweep_rows_read(rows, product->folder, error))
        cs_sweep_rows_write(rows, error);
    cs_row_table_unlock(&rows->table);
    if (!error->status && rows->n > product->cells)
        cs_fail(error, CS_ERR_USAGE,
                "%s belongs to a different sweep; choose another folder with --out, or "
                "--overwrite to replace it",
                rows->table.path);
    return error->status;
}

/* Adds what this and other processes have appended since; the rows are written in order when
 * all are there. */
static enum cs_status end(struct cs_parameter_sweep *product, struct cs_sweep_rows *rows,
                          struct cs_error *error) {
    if (cs_row_table_lock(&rows->table, error))
        return error->status;
    cs_sweep_rows_read(rows, product->folder, error);
    product->n_done = cs_sweep_rows_count(rows);
    if (!error->status && product->n_done == product->cells)
        cs_sweep_rows_write(rows, error);
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

/* Reads the scene with one key set, or with none; a refusal by the scene is left in *refusal.
 */
static enum cs_status try_override(const struct cs_parameter_sweep *product,
                                   const struct cs_override *key, struct cs_error *refusal,
                                   struct cs_error *error) {
    struct cs_session_settings asked = product->session;
    struct cs_session session = {0};
    asked.overrides = key;
    asked.n_overrides = key != NULL;
    asked.integrator = product->n_methods ? product->methods[0] : NULL;
    *refusal = (struct cs_error){0};
    if (cs_session_open_plan(&session, &asked, refusal) && !is_own_fault(refusal))
        cs_fail(error, refusal->status, "%s", refusal->message);
    cs_session_close(&session);
    return error->status;
}

/* Refuses a key that the scene takes with none of its values: it is misspelt, or its values
 * are. Of a scene that is refused by itself nothing can be said. */
static enum cs_status check_keys(const struct cs_parameter_sweep *product,
                                 struct cs_error *error) {
    struct cs_error refusal;
    if (try_override(product, NULL, &refusal, error) || refusal.status)
        return error->status;
    for (uint32_t k = 0; k < product->n_keys && !error->status; k++) {
        const struct cs_parameter_axis *key = product->keys + k;
        refusal.status = CS_ERR_SCENE;
        for (uint32_t v = 0; v < key->n && refusal.status && !error->status; v++)
            try_override(product, &(struct cs_override){key->path, key->values[v]}, &refusal,
                         error);
        if (refusal.status && !error->status)
            cs_fail(error, refusal.status, "%s", refusal.message);
    }
    return error->status;
}

enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *product,
                                      struct cs_error *error) {
    struct cs_sweep_rows rows = {0};
    if (count(product, error) || check_keys(product, error))
        return error->status;
    if (!cs_sweep_rows_open(&rows, product->folder, error) && !begin(product, &rows, error)) {
        for (uint32_t k = 0; k < product->cells && !error->status; k++) {
            do_cell(product, &rows, k, error);
            if (product->progress)
                product->progress(product->ctx, k + 1, product->cells);
        }
        if (!error->status)
            end(product, &rows, error);
    }
    cs_sweep_rows_finish(&rows);
    return error->status;
}

enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error) {
    struct cs_sweep_rows rows = {0};
    if (!cs_sweep_rows_open(&rows, out, error))
        cs_sweep_rows_read(&rows, out, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++)
        cs_sweep_rows_read(&rows, folders[k], error);
    *n = cs_sweep_rows_count(&rows);
    if (!error->status && rows.names.length)
        cs_sweep_rows_write(&rows, error);
    cs_sweep_rows_finish(&rows);
    return error->status;
}
