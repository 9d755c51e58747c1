/* Appends the results of a map to a file as binary records, and reads them back. */
#include "borders/stability_state.h"

#include "base/file.h"
#include "base/hash.h"
#include "session/session.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#define ENDING ".partial"

/* Values of record.kind. They are in files: new kinds go to the end. */
enum kind { REFERENCE, CELL, BORDER };

/* One result. A record with the key of a different map is skipped. One that is not as it was
 * written is skipped too: its cell is computed again. Its layout is that of the machine; the
 * size of a record is a part of the key. */
struct record {
    char check[CS_HASH_DIGITS]; /* hash of the rest */
    char key[CS_HASH_DIGITS];
    uint32_t kind, column, row;
    union {
        struct cs_reference reference;
        struct cs_stability_cell cell;
        double border;
    } of;
};

/* Hash of everything a result depends on: version, scene with the method's options, start
 * state, record size, axis, times, steps and values. */
static enum cs_status make_key(const struct cs_stability *stability, char key[CS_HASH_DIGITS],
                               struct cs_error *error) {
    const struct cs_stability_settings *settings = stability->settings;
    const struct cs_session *session = &stability->session;
    char scene[CS_HASH_DIGITS], start[CS_HASH_DIGITS];
    struct cs_text all = {0};
    if (cs_scene_hash(session->scene, &session->method.table, session->method.options, scene,
                      error))
        return error->status;
    cs_hash_doubles(session->system.state, 6 * (size_t)session->system.view.n, start);
    cs_text_add(&all, "%s|%s|%s|%zu|%d|", CS_VERSION, scene, start, sizeof(struct record),
                (int)settings->axis);
    cs_text_add(&all, "%.17g|%.17g", settings->seconds, settings->budget);
    for (uint32_t r = 0; r < stability->n_rows; r++)
        cs_text_add(&all, "|%.17g", stability->dt[r]);
    for (uint32_t c = 0; c < stability->n_columns; c++)
        cs_text_add(&all, "|%.17g", stability->columns[c].value);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the key of a map");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, key);
    cs_text_finish(&all);
    return error->status;
}

static void find_check(const struct record *record, char check[CS_HASH_DIGITS]) {
    cs_hash_bytes(record->key, sizeof *record - offsetof(struct record, key), check);
}

/* Stores one record in the map. Records beyond its columns or rows, with another key, or
 * damaged, are ignored. */
static void store_record(struct cs_stability *stability, const struct record *record) {
    char check[CS_HASH_DIGITS];
    find_check(record, check);
    if (memcmp(record->check, check, sizeof check) != 0 ||
        record->column >= stability->n_columns || record->row >= stability->n_rows ||
        strncmp(record->key, stability->journal.key, sizeof record->key) != 0)
        return;
    struct cs_stability_column *column = stability->columns + record->column;
    if (record->kind == REFERENCE) {
        column->reference = record->of.reference;
        column->has_reference = true;
    } else if (record->kind == CELL)
        column->cells[record->row] = record->of.cell;
    else if (record->kind == BORDER) {
        column->boundary = record->of.border;
        column->has_boundary = true;
    }
}

/* Reads all records under the lock of the table. A missing file is an empty one. */
static enum cs_status read_back(struct cs_stability *stability, struct cs_error *error) {
    struct cs_rows rows;
    struct record record;
    if (cs_rows_open(&rows, stability->journal.table.path, sizeof record, error))
        return error->status;
    for (const char *row; (row = cs_rows_next(&rows));) {
        memcpy(&record, row, sizeof record);
        store_record(stability, &record);
    }
    cs_rows_close(&rows);
    return CS_OK;
}

enum cs_status cs_journal_open(struct cs_stability *stability, struct cs_error *error) {
    struct cs_row_table *table = &stability->journal.table;
    char name[CS_SERIES_BYTES], file[CS_SERIES_BYTES + sizeof ENDING];
    if (!stability->settings->folder)
        return CS_OK;
    cs_series_file_name(stability->series, name);
    snprintf(file, sizeof file, "%s%s", name, ENDING);
    if (!make_key(stability, stability->journal.key, error) &&
        !cs_row_table_open(table, stability->settings->folder, file, file,
                           sizeof(struct record), error) &&
        !cs_row_table_lock(table, error)) {
        read_back(stability, error);
        cs_row_table_unlock(table);
    }
    return error->status;
}

/* Appends one record with the key of the map; nothing without a journal. */
static enum cs_status append(const struct cs_stability *stability, struct record *record,
                             struct cs_error *error) {
    if (!*stability->journal.table.path)
        return CS_OK;
    memcpy(record->key, stability->journal.key, sizeof record->key);
    find_check(record, record->check);
    return cs_row_table_append(&stability->journal.table, record, sizeof *record, error);
}

enum cs_status cs_journal_append_reference(const struct cs_stability *stability,
                                           uint32_t column, struct cs_error *error) {
    struct record record = {.kind = REFERENCE, .column = column};
    record.of.reference = stability->columns[column].reference;
    return append(stability, &record, error);
}

enum cs_status cs_journal_append_cell(const struct cs_stability *stability, uint32_t column,
                                      uint32_t row, struct cs_error *error) {
    struct record record = {.kind = CELL, .column = column, .row = row};
    record.of.cell = stability->columns[column].cells[row];
    return append(stability, &record, error);
}

enum cs_status cs_journal_append_boundary(const struct cs_stability *stability, uint32_t column,
                                          struct cs_error *error) {
    struct record record = {.kind = BORDER, .column = column};
    record.of.border = stability->columns[column].boundary;
    return append(stability, &record, error);
}

enum cs_status cs_journal_remove(const struct cs_stability *stability, struct cs_error *error) {
    return *stability->journal.table.path ? cs_file_remove(stability->journal.table.path, error)
                                          : CS_OK;
}

/* True for a file name with the ending of journals and a stem. */
static bool is_journal(const char *name) {
    const size_t length = strlen(name);
    return length >= sizeof ENDING && !strcmp(name + length + 1 - sizeof ENDING, ENDING);
}

/* Each record names its map and cell, so records of several files can be concatenated. The last
 * record is dropped if it is incomplete. */
static enum cs_status append_file(const char *folder, const char *name, const char *out,
                                  struct cs_error *error) {
    struct cs_row_table table;
    struct cs_rows rows;
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (!cs_row_table_open(&table, out, name, name, sizeof(struct record), error) &&
        !cs_rows_open(&rows, path, sizeof(struct record), error)) {
        cs_row_table_append(&table, rows.bytes,
                            rows.length - rows.length % sizeof(struct record), error);
        cs_rows_close(&rows);
    }
    return error->status;
}

enum cs_status cs_journal_merge(const char *const *folders, uint32_t n_folders, const char *out,
                                uint32_t *n, struct cs_error *error) {
    *n = 0;
    for (uint32_t k = 0; k < n_folders && !error->status; k++) {
        DIR *directory = opendir(folders[k]);
        if (!directory)
            return cs_fail(error, cs_file_status(errno), "cannot open %s: %s", folders[k],
                           strerror(errno));
        for (const struct dirent *entry; !error->status && (entry = readdir(directory));)
            if (is_journal(entry->d_name) &&
                !append_file(folders[k], entry->d_name, out, error))
                ++*n;
        closedir(directory);
    }
    return error->status;
}
