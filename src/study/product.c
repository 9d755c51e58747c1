/* Runs the Cartesian product of values and methods, and keeps a row a cell. */
#include "study/product.h"

#include "base/clock.h"
#include "base/csv.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/lock.h"
#include "io/input.h"
#include "model/force/measure.h"
#include "sim/folders.h"
#include "study/machine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_BYTES_MAX = 1 << 30, FIELDS = CS_PRODUCT_KEYS + 32 };

/* Lines of a table by cell; each begins with the number of its cell and ends with its key. */
struct table {
    char path[4096], lock[4096];
    char *head;
    char **lines; /* (n) owned, with their line breaks; NULL: not there */
    uint32_t n;
};

static void finish_table(struct table *table) {
    for (uint32_t k = 0; k < table->n; k++)
        free(table->lines[k]);
    free(table->lines);
    free(table->head);
    *table = (struct table){0};
}

static enum cs_status grow(struct table *table, uint32_t n, struct cs_error *error) {
    if (n <= table->n)
        return CS_OK;
    char **lines = realloc(table->lines, n * sizeof *lines);
    if (!lines)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u rows", n);
    memset(lines + table->n, 0, (n - table->n) * sizeof *lines);
    table->lines = lines;
    table->n = n;
    return CS_OK;
}

static const char *key_of(const char *line) {
    const char *comma = strrchr(line, ',');
    return comma ? comma + 1 : "";
}

/* Takes one line over; one that is no row is passed over. */
static enum cs_status take_line(struct table *table, const char *line, const char *path,
                                struct cs_error *error) {
    char *end;
    const unsigned long cell = strtoul(line, &end, 10);
    if (end == line || *end != ',' || cell >= CS_PRODUCT_CELLS)
        return CS_OK;
    if (grow(table, (uint32_t)cell + 1, error))
        return error->status;
    char **place = table->lines + cell;
    if (*place && strcmp(key_of(*place), key_of(line)) != 0)
        return cs_fail(error, CS_ERR_USAGE, "%s is of another sweep: cell %lu differs", path,
                       cell);
    if (!*place && !(*place = strdup(line)))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the rows of %s", path);
    return error->status;
}

/* The rows of a file; what was cut off is passed over. Its first line is to be the table's. */
static enum cs_status read_table(struct table *table, const char *path,
                                 struct cs_error *error) {
    char *bytes;
    size_t length;
    if (access(path, F_OK))
        return CS_OK;
    if (cs_file_read(path, FILE_BYTES_MAX, &bytes, &length, error))
        return error->status;
    char *rest = bytes, *end = strchr(bytes, '\n');
    for (bool head = true; end && !error->status; head = false) {
        const char kept = end[1];
        end[1] = 0;
        if (!head)
            take_line(table, rest, path, error);
        else if (!table->head && !(table->head = strdup(rest)))
            cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", path);
        else if (strcmp(table->head, rest) != 0)
            cs_fail(error, CS_ERR_USAGE, "%s is of another sweep: its columns differ", path);
        end[1] = kept;
        rest = end + 1;
        end = strchr(rest, '\n');
    }
    free(bytes);
    return error->status;
}

static enum cs_status write_table(const struct table *table, struct cs_error *error) {
    struct cs_text out = {0};
    cs_text_add(&out, "%s", table->head);
    for (uint32_t k = 0; k < table->n; k++)
        if (table->lines[k])
            cs_text_add(&out, "%s", table->lines[k]);
    if (out.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", table->path);
    else
        cs_file_write(table->path, cs_text_get(&out), out.length, error);
    cs_text_finish(&out);
    return error->status;
}

static enum cs_status open_table(struct table *table, const char *folder,
                                 struct cs_error *error) {
    *table = (struct table){0};
    snprintf(table->path, sizeof table->path, "%s/sweep.csv", folder);
    snprintf(table->lock, sizeof table->lock, "%s/.lock", folder);
    return cs_folder_make(folder, error);
}

/* --- one cell --- */

/* What a cell is: its overrides, the last key changing first, and its method. */
struct cell {
    uint32_t number;
    struct cs_override overrides[CS_PRODUCT_KEYS];
    const char *method; /* NULL: the scene's own */
    char key[CS_HASH_DIGITS];
};

static enum cs_status make_cell(const struct cs_product *product, const char *scene,
                                uint32_t number, struct cell *cell, struct cs_error *error) {
    struct cs_text all = {0};
    uint32_t rest = number;
    *cell = (struct cell){.number = number};
    for (uint32_t k = product->n_keys; k-- > 0;) {
        const struct cs_product_key *key = product->keys + k;
        cell->overrides[k] = (struct cs_override){key->path, key->values[rest % key->n]};
        rest /= key->n;
    }
    cell->method = product->n_methods ? product->methods[rest] : NULL;
    cs_text_add(&all, "%s|%s|%u|%s", CS_VERSION, scene, product->frames,
                cell->method ? cell->method : "");
    for (uint32_t k = 0; k < product->n_keys; k++)
        cs_text_add(&all, "|%s=%s", cell->overrides[k].path, cell->overrides[k].value);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the key of a cell");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, cell->key);
    cs_text_finish(&all);
    return error->status;
}

static void add_real(struct cs_text *out, double value) {
    cs_text_add(out, ",");
    if (isfinite(value))
        cs_text_add_real(out, value);
}

static void add_text(struct cs_text *out, const char *text) {
    cs_text_add(out, ",");
    cs_csv_add_field(out, text);
}

static void add_head(const struct cs_product *product, struct cs_text *out) {
    cs_text_add(out, "cell");
    for (uint32_t k = 0; k < product->n_keys; k++)
        add_text(out, product->keys[k].path);
    cs_text_add(out, ",integrator,outcome,frames,time,steps,evals,iterations,kinetic,elastic,"
                     "energy,strain,hash,cpu,machine,version,note,key\n");
}

/* What came of it, for the columns behind the method's. */
static void add_result(const struct cs_session *session, const char *outcome, double cpu,
                       struct cs_text *out) {
    const struct cs_run *run = &session->run;
    const struct cs_energy energy = cs_measure_energy(run->system, run->t, run->x, run->v);
    char hash[CS_HASH_DIGITS];
    cs_hash_doubles(run->x, 6 * (size_t)session->system.view.n, hash);
    add_text(out, outcome);
    cs_text_add(out, ",%u", run->frame);
    add_real(out, run->t);
    cs_text_add(out, ",%llu,%llu,%llu", (unsigned long long)run->counts.steps,
                (unsigned long long)run->counts.forces,
                (unsigned long long)run->counts.solve_iterations);
    add_real(out, energy.kinetic);
    add_real(out, energy.elastic);
    add_real(out, cs_energy_whole(&energy));
    add_real(out, cs_measure_strain(run->system, run->x));
    add_text(out, hash);
    add_real(out, cpu);
}

/* A scene or a method that refuses is a row; what the command line has wrong is none. */
static enum cs_status add_failure(struct cs_product *product, struct cs_error *failure,
                                  struct cs_text *out, struct cs_error *error) {
    if (failure->status != CS_ERR_SCENE && failure->status != CS_ERR_MODULE)
        return cs_fail(error, failure->status, "%s", failure->message);
    if (!product->refused++)
        product->why = *failure;
    add_text(out, failure->status == CS_ERR_SCENE ? "refused" : "failed");
    cs_text_add(out, ",,,,,,,,,,,");
    return CS_OK;
}

static enum cs_status run_cell(struct cs_product *product, const struct cell *cell,
                               struct cs_text *out, struct cs_error *error) {
    struct cs_session session = {0};
    struct cs_session_settings asked = product->session;
    struct cs_error failure = {0};
    char machine[CS_MACHINE_NAME];
    asked.overrides = cell->overrides;
    asked.n_overrides = product->n_keys;
    asked.integrator = cell->method;
    cs_text_add(out, "%u", cell->number);
    for (uint32_t k = 0; k < product->n_keys; k++)
        add_text(out, cell->overrides[k].value);
    if (!cs_session_open(&session, &asked, &failure)) {
        const double begin = cs_clock_cpu();
        while (session.run.frame < product->frames && session.run.outcome == CS_RUNNING &&
               !cs_run_frame(&session.run, &failure))
            ;
        add_text(out, cell->method ? cell->method : session.method.integrator->name);
        if (session.run.outcome == CS_INTERRUPTED)
            cs_fail(error, CS_ERR_INTERRUPT, "interrupted; finished rows were kept");
        else if (failure.status)
            add_failure(product, &failure, out, error);
        else
            add_result(&session, cs_outcome_text(session.run.outcome), cs_clock_cpu() - begin,
                       out);
    } else {
        add_text(out, cell->method ? cell->method : "");
        add_failure(product, &failure, out, error);
    }
    cs_session_close(&session);
    cs_machine_name(machine);
    add_text(out, machine);
    add_text(out, CS_VERSION);
    add_text(out, failure.message);
    cs_text_add(out, ",%s\n", cell->key);
    if (out->failed && !error->status)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    return error->status;
}

/* --- all of them --- */

static enum cs_status keep(struct table *table, uint32_t number, const struct cs_text *line,
                           struct cs_error *error) {
    struct cs_lock lock;
    table->lines[number] = strdup(line->bytes);
    if (!table->lines[number])
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    if (cs_lock_take(&lock, table->lock, error))
        return error->status;
    cs_file_append(table->path, line->bytes, line->length, error);
    cs_lock_give(&lock);
    return error->status;
}

static enum cs_status do_cell(struct cs_product *product, struct table *table,
                              const char *scene, uint32_t number, struct cs_error *error) {
    struct cell cell;
    struct cs_text line = {0};
    char key[CS_HASH_DIGITS + 1];
    if (make_cell(product, scene, number, &cell, error))
        return error->status;
    snprintf(key, sizeof key, "%s\n", cell.key);
    if (table->lines[number] && strcmp(key_of(table->lines[number]), key) != 0)
        return cs_fail(error, CS_ERR_USAGE,
                       "%s is of another sweep: give another folder with --out", table->path);
    if (table->lines[number])
        product->taken++;
    else if (cs_shard_holds(&product->shard, number) && !run_cell(product, &cell, &line, error))
        keep(table, number, &line, error);
    cs_text_finish(&line);
    return error->status;
}

/* Makes the first line of a new file, or checks that of an old one, and takes its rows over. */
static enum cs_status begin(struct cs_product *product, struct table *table,
                            struct cs_error *error) {
    struct cs_text head = {0};
    struct cs_lock lock;
    add_head(product, &head);
    table->head = head.failed ? NULL : strdup(cs_text_get(&head));
    cs_text_finish(&head);
    if (!table->head)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the columns");
    if (grow(table, product->cells, error) || cs_lock_take(&lock, table->lock, error))
        return error->status;
    if (access(table->path, F_OK))
        write_table(table, error);
    else
        read_table(table, table->path, error);
    cs_lock_give(&lock);
    if (!error->status && table->n > product->cells)
        cs_fail(error, CS_ERR_USAGE, "%s is of another sweep: give another folder with --out",
                table->path);
    return error->status;
}

/* With what others have added meanwhile; in order where nothing is left to do. */
static enum cs_status end(struct cs_product *product, struct table *table,
                          struct cs_error *error) {
    struct cs_lock lock;
    if (cs_lock_take(&lock, table->lock, error))
        return error->status;
    read_table(table, table->path, error);
    product->done = 0;
    for (uint32_t k = 0; k < product->cells && !error->status; k++)
        product->done += table->lines[k] != NULL;
    if (!error->status && product->done == product->cells)
        write_table(table, error);
    cs_lock_give(&lock);
    return error->status;
}

static enum cs_status count(struct cs_product *product, struct cs_error *error) {
    double cells = product->n_methods ? product->n_methods : 1;
    for (uint32_t k = 0; k < product->n_keys; k++)
        cells *= product->keys[k].n;
    if (cells > CS_PRODUCT_CELLS)
        return cs_fail(error, CS_ERR_USAGE, "%.0f cells are more than %d", cells,
                       CS_PRODUCT_CELLS);
    product->cells = (uint32_t)cells;
    return CS_OK;
}

/* of the bytes that the cells read: of a file, an installed one, or standard input */
static enum cs_status hash_scene(const char *path, char hash[CS_HASH_DIGITS],
                                 struct cs_error *error) {
    const bool given = strcmp(path, CS_INPUT_NAME) == 0;
    char installed[CS_DATA_PATH_MAX], *bytes = NULL;
    const char *text = NULL;
    size_t length = 0;
    if (given)
        cs_input_read(FILE_BYTES_MAX, &text, &length, error);
    else if (!cs_file_read(cs_data_find(path, installed, sizeof installed), FILE_BYTES_MAX,
                           &bytes, &length, error))
        text = bytes;
    if (!error->status)
        cs_hash_bytes(text, length, hash);
    free(bytes);
    return error->status;
}

enum cs_status cs_product_run(struct cs_product *product, struct cs_error *error) {
    struct table table = {0};
    char scene[CS_HASH_DIGITS];
    if (count(product, error) || hash_scene(product->session.scene, scene, error))
        return error->status;
    if (!open_table(&table, product->folder, error) && !begin(product, &table, error)) {
        for (uint32_t k = 0; k < product->cells && !error->status; k++) {
            do_cell(product, &table, scene, k, error);
            if (product->progress)
                product->progress(product->ctx, k + 1, product->cells);
        }
        if (!error->status)
            end(product, &table, error);
    }
    finish_table(&table);
    return error->status;
}

enum cs_status cs_product_merge(const char *const *folders, uint32_t n_folders, const char *out,
                                uint32_t *n, struct cs_error *error) {
    struct table table;
    char path[4096];
    if (open_table(&table, out, error))
        return error->status;
    read_table(&table, table.path, error);
    for (uint32_t k = 0; k < n_folders && !error->status; k++) {
        snprintf(path, sizeof path, "%s/sweep.csv", folders[k]);
        read_table(&table, path, error);
    }
    *n = 0;
    for (uint32_t k = 0; k < table.n; k++)
        *n += table.lines[k] != NULL;
    if (!error->status && table.head)
        write_table(&table, error);
    finish_table(&table);
    return error->status;
}
