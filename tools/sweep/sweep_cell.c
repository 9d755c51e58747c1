/* sweep_cell.c - one cell of a sweep: its values, its key, its run, its row; and the rows of
 * sweep.csv. */
#include "sweep/sweep_cell.h"

#include "base/file.h"
#include "session/provenance_write.h"
#include "session/session.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const NAME = "sweep.csv";

enum cs_status cs_sweep_rows_open(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error) {
    char path[4200];
    if (cs_row_table_open(&rows->table, folder, NAME, ".lock", 0, error))
        return error->status;
    snprintf(path, sizeof path, "%s/.cells", folder);
    rows->cell_locks = cs_file_open_shared(path, O_CREAT, error);
    return error->status;
}

void cs_sweep_rows_finish(struct cs_sweep_rows *rows) {
    for (uint32_t k = 0; k < rows->n; k++)
        free(rows->lines[k]);
    free(rows->lines);
    if (rows->cell_locks > 0)
        close(rows->cell_locks);
    cs_text_finish(&rows->names);
}

enum cs_status cs_sweep_rows_reserve(struct cs_sweep_rows *rows, uint32_t n,
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

const char *cs_sweep_row_key(const char *line) {
    const char *comma = strrchr(line, ',');
    return comma ? comma + 1 : "";
}

bool cs_sweep_row_cut(char *line, uint32_t n_keys, struct cs_sweep_fields *fields) {
    /* the columns after the values: method and outcome first, note and key last */
    enum { METHOD, OUTCOME, NOTE = 15, KEY };
    char *cut[1 + CS_PARAMETER_AXES_MAX + KEY + 1];
    if (cs_csv_cut(line, ',', cut, sizeof cut / sizeof *cut) < 1 + n_keys + KEY + 1)
        return false;
    memcpy(fields->values, cut + 1, n_keys * sizeof *cut);
    fields->method = cut[1 + n_keys + METHOD];
    fields->outcome = cut[1 + n_keys + OUTCOME];
    fields->note = cut[1 + n_keys + NOTE];
    return true;
}

void cs_sweep_rows_drop_failed(struct cs_sweep_rows *rows, uint32_t n_keys) {
    for (uint32_t k = 0; k < rows->n; k++) {
        struct cs_sweep_fields fields;
        char *copy = rows->lines[k] ? strdup(rows->lines[k]) : NULL;
        if (copy && cs_sweep_row_cut(copy, n_keys, &fields) &&
            !strcmp(fields.outcome, "failed")) {
            free(rows->lines[k]);
            rows->lines[k] = NULL;
        }
        free(copy);
    }
}

/* Size of the table; 0 if there is none. */
static long long bytes_of(const struct cs_sweep_rows *rows) {
    struct stat info;
    return stat(rows->table.path, &info) ? 0 : (long long)info.st_size;
}

/* Sets or asks for the lock of a cell, of the whole process and not of one descriptor. */
static int set_lock(const struct cs_sweep_rows *rows, uint32_t cell, int command,
                    struct flock *lock) {
    *lock = (struct flock){.l_type = command == F_UNLCK ? F_UNLCK : F_WRLCK,
                           .l_whence = SEEK_SET,
                           .l_start = (off_t)cell,
                           .l_len = 1};
    return fcntl(rows->cell_locks, command == F_UNLCK ? F_SETLK : command, lock);
}

bool cs_sweep_rows_lock_cell(struct cs_sweep_rows *rows, uint32_t cell, const char *folder,
                             struct cs_error *error) {
    struct flock lock;
    if (set_lock(rows, cell, F_SETLK, &lock) && (errno == EACCES || errno == EAGAIN))
        return false;
    if (bytes_of(rows) != rows->bytes)
        cs_sweep_rows_read(rows, folder, error);
    if (!rows->lines[cell] && !error->status)
        return true;
    cs_sweep_rows_unlock_cell(rows, cell);
    return false;
}

void cs_sweep_rows_unlock_cell(const struct cs_sweep_rows *rows, uint32_t cell) {
    struct flock lock;
    set_lock(rows, cell, F_UNLCK, &lock);
}

bool cs_sweep_rows_is_locked(const struct cs_sweep_rows *rows, uint32_t cell) {
    struct flock lock;
    return !set_lock(rows, cell, F_GETLK, &lock) && lock.l_type != F_UNLCK;
}

/* Stores a line under its cell; a text that is no row is skipped. Two different keys for one
 * cell mean two different sweeps. */
static enum cs_status store_line(struct cs_sweep_rows *rows, const char *line, const char *path,
                                 struct cs_error *error) {
    char *end;
    const unsigned long cell = strtoul(line, &end, 10);
    if (end == line || *end != ',' || cell >= CS_PARAMETER_SWEEP_CELLS_MAX)
        return CS_OK;
    if (cs_sweep_rows_reserve(rows, (uint32_t)cell + 1, error))
        return error->status;
    char **stored = rows->lines + cell;
    if (*stored && strcmp(cs_sweep_row_key(*stored), cs_sweep_row_key(line)) != 0)
        return cs_fail(error, CS_ERR_USAGE, "%s belongs to a different sweep: cell %lu differs",
                       path, cell);
    if (!*stored && !(*stored = strdup(line)))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the rows of %s", path);
    return error->status;
}

enum cs_status cs_sweep_rows_append(struct cs_sweep_rows *rows, uint32_t cell,
                                    const struct cs_text *line, struct cs_error *error) {
    const char *end = line->length ? strrchr(line->bytes, ',') : NULL;
    if (line->failed || !end ||
        !(rows->lines[cell] = strndup(line->bytes, (size_t)(end - line->bytes))))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    if (!cs_row_table_append(&rows->table, line->bytes, line->length, error))
        rows->bytes += (long long)line->length;
    return error->status;
}

enum cs_status cs_sweep_rows_read(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error) {
    struct cs_rows found;
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, NAME);
    if (access(path, F_OK) || cs_rows_open(&found, path, 0, error))
        return error->status;
    rows->bytes = (long long)found.length;
    if (!rows->unchecked)
        cs_rows_refuse_unchecked(&found, path, error);
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

/* Adds a row without its check, and the check. */
static void add_line(const struct cs_sweep_rows *rows, const char *line, struct cs_text *out) {
    const size_t from = out->length;
    cs_text_add(out, "%s", line);
    cs_csv_end_row(out, from, cs_text_get(&rows->names));
}

enum cs_status cs_sweep_rows_write(struct cs_sweep_rows *rows, struct cs_error *error) {
    struct cs_text out = {.failed = rows->names.failed};
    cs_text_add(&out, "%s", cs_text_get(&rows->names));
    cs_csv_end_names(&out);
    for (uint32_t k = 0; k < rows->n; k++)
        if (rows->lines[k])
            add_line(rows, rows->lines[k], &out);
    rows->bytes = (long long)out.length;
    return cs_file_write_text(rows->table.path, &out, error);
}

uint32_t cs_sweep_rows_count(const struct cs_sweep_rows *rows) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < rows->n; k++)
        n += rows->lines[k] != NULL;
    return n;
}

static void choose_values(struct cs_sweep_cell *cell, const struct cs_parameter_sweep *sweep) {
    uint32_t rest = cell->number;
    for (uint32_t k = sweep->n_keys; k-- > 0;) {
        const struct cs_parameter_axis *key = sweep->keys + k;
        cell->overrides[k] = (struct cs_override){key->path, key->values[rest % key->n]};
        rest /= key->n;
    }
    cell->method = sweep->n_methods ? sweep->methods[rest] : NULL;
}

/* Adds hashes of scene and module, which identify equal cells whatever their text. */
static void add_meaning(struct cs_sweep_cell *cell, struct cs_text *all,
                        struct cs_error *error) {
    struct cs_session *session = &cell->session;
    const struct cs_registry_entry *found;
    char scene[CS_HASH_DIGITS] = "", module[CS_HASH_DIGITS] = "";
    if (cs_scene_hash(session->scene, &session->method.table, session->method.options, scene,
                      error) ||
        cs_registry_find(&session->registry, session->method.integrator->name, &found, error) ||
        cs_hash_file(found->file, NULL, module, error))
        return;
    cs_text_add(all, "|%s|%s", scene, module);
}

static void add_refusal(const struct cs_sweep_cell *cell, uint32_t n_keys,
                        struct cs_text *all) {
    cs_text_add(all, "|%s|%s", cell->method ? cell->method : "", cell->refusal.message);
    for (uint32_t k = 0; k < n_keys; k++)
        cs_text_add(all, "|%s=%s", cell->overrides[k].path, cell->overrides[k].value);
}

static enum cs_status make_key(struct cs_sweep_cell *cell,
                               const struct cs_parameter_sweep *sweep, struct cs_error *error) {
    struct cs_text all = {0};
    cs_text_add(&all, "%s|%u", CS_VERSION, sweep->frames);
    if (cell->refusal.status)
        add_refusal(cell, sweep->n_keys, &all);
    else
        add_meaning(cell, &all, error);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the key of a cell");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, cell->key);
    cs_text_finish(&all);
    return error->status;
}

enum cs_status cs_sweep_cell_open(struct cs_sweep_cell *cell,
                                  const struct cs_parameter_sweep *sweep, uint32_t number,
                                  struct cs_error *error) {
    struct cs_session_settings asked = sweep->session;
    *cell = (struct cs_sweep_cell){.number = number};
    choose_values(cell, sweep);
    asked.overrides = cell->overrides;
    asked.n_overrides = sweep->n_keys;
    asked.integrator = cell->method;
    cs_session_open_plan(&cell->session, &asked, &cell->refusal);
    return make_key(cell, sweep, error);
}

void cs_sweep_cell_close(struct cs_sweep_cell *cell) {
    cs_session_close(&cell->session);
}

const struct cs_column cs_parameter_sweep_columns[] = {
    CS_TEXT_COLUMN("integrator", "method, with its options as given"),
    CS_TEXT_COLUMN("outcome", "finished, blew up, gave up, refused (by the scene) or failed"),
    CS_NUMBER_COLUMN("frames", "1", "simulated frames"),
    CS_NUMBER_COLUMN("time", "s", "simulated time that was reached"),
    CS_NUMBER_COLUMN("steps", "1", "steps"),
    CS_NUMBER_COLUMN("evals", "1", "force evaluations"),
    CS_NUMBER_COLUMN("iterations", "1", "iterations of the linear solver"),
    CS_NUMBER_COLUMN("kinetic", "J", "kinetic energy at the end"),
    CS_NUMBER_COLUMN("elastic", "J", "elastic energy at the end"),
    CS_NUMBER_COLUMN("energy", "J", "energy at the end: all kinds"),
    CS_NUMBER_COLUMN("strain", "1", "largest strain at the end"),
    CS_TEXT_COLUMN("hash", "hash of the state at the end, as of clothsim run --hash"),
    CS_NUMBER_COLUMN("cpu", "s", "processor time of the frames"),
    CS_TEXT_COLUMN("machine", "machine that ran the cell"),
    CS_TEXT_COLUMN("version", "version of clothsim that ran it"),
    CS_TEXT_COLUMN("note", "why the cell was refused, failed or gave up"),
    CS_TEXT_COLUMN("key", "hash of everything that the row depends on, but for the machine"),
};
const uint32_t cs_parameter_sweep_n_columns =
    sizeof cs_parameter_sweep_columns / sizeof *cs_parameter_sweep_columns;

void cs_sweep_add_names(const struct cs_parameter_sweep *sweep, struct cs_text *out) {
    cs_text_add(out, "cell");
    for (uint32_t k = 0; k < sweep->n_keys; k++)
        cs_csv_add_text(out, sweep->keys[k].path);
    cs_columns_add_names(cs_parameter_sweep_columns, cs_parameter_sweep_n_columns, out);
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

/* Adds the columns of a cell without a result. */
static void add_failure(const struct cs_error *failure, struct cs_text *out) {
    cs_csv_add_text(out, failure->status == CS_ERR_SCENE ? "refused" : "failed");
    cs_text_add(out, ",,,,,,,,,,,");
}

/* Runs from the plan to the last frame. Returns the processor time in s of the frames. */
static double run_frames(struct cs_sweep_cell *cell, uint32_t frames) {
    struct cs_session *session = &cell->session;
    struct cs_error *failure = &cell->refusal;
    struct cs_follow follow = {.run = &session->run, .last = frames};
    if (!failure->status && !cs_session_build(session, failure) &&
        !cs_session_begin(session, NULL, failure))
        cs_follow_next(&follow, failure);
    return follow.cpu;
}

static void add_begin(const struct cs_sweep_cell *cell, const struct cs_parameter_sweep *sweep,
                      struct cs_text *out) {
    cs_text_add(out, "%u", cell->number);
    for (uint32_t k = 0; k < sweep->n_keys; k++)
        cs_csv_add_text(out, cell->overrides[k].value);
}

static void add_end(const char *note, const char *key, const char *names, struct cs_text *out) {
    char machine[CS_MACHINE_NAME];
    cs_machine_name(machine);
    cs_csv_add_text(out, machine);
    cs_csv_add_text(out, CS_VERSION);
    cs_csv_add_text(out, note);
    cs_csv_add_text(out, key);
    cs_csv_end_row(out, 0, names);
}

enum cs_status cs_sweep_cell_run(struct cs_sweep_cell *cell,
                                 const struct cs_parameter_sweep *sweep, const char *names,
                                 struct cs_text *out, struct cs_error *error) {
    const struct cs_session *session = &cell->session;
    add_begin(cell, sweep, out);
    const double cpu = run_frames(cell, sweep->frames);
    const struct cs_integrator *integrator = session->method.integrator;
    cs_csv_add_text(out, cell->method ? cell->method : integrator ? integrator->name : "");
    cs_follow_check(&session->run, "; finished rows are saved", error);
    if (cell->refusal.status)
        add_failure(&cell->refusal, out);
    else if (!error->status)
        add_result(session, cs_outcome_text(session->run.outcome), cpu, out);
    add_end(session->run.reason ? session->run.reason : cell->refusal.message, cell->key, names,
            out);
    return out->failed ? cs_fail(error, CS_ERR_MEMORY, "out of memory for a row")
                       : error->status;
}

void cs_sweep_cell_add_lost(uint32_t number, const struct cs_parameter_sweep *sweep,
                            const char *note, const char *key, const char *names,
                            struct cs_text *out) {
    struct cs_sweep_cell cell = {.number = number};
    choose_values(&cell, sweep);
    add_begin(&cell, sweep, out);
    cs_csv_add_text(out, cell.method ? cell.method : "");
    add_failure(&(struct cs_error){.status = CS_ERR_MODULE}, out);
    add_end(note, key, names, out);
}
