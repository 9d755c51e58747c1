/* Appends what is found of a map to a file, and reads it back. */
#include "study/stability/stability_journal.h"

#include "base/file.h"
#include "base/hash.h"
#include "scene/file/scene_hash.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_BYTES_MAX = 1 << 30 };
enum kind { REFERENCE, CELL, BORDER };

/* All records are of one size: one that was cut off, or is of another map, is passed over. */
struct record {
    char key[CS_HASH_DIGITS];
    uint32_t kind, column, row;
    union {
        struct cs_reference reference;
        struct cs_stability_cell cell;
        double border;
    } of;
};

static enum cs_status make_key(const struct cs_stability *map, char key[CS_HASH_DIGITS],
                               struct cs_error *error) {
    const struct cs_stability_settings *settings = map->settings;
    const struct cs_session *session = &map->session;
    char scene[CS_HASH_DIGITS], start[CS_HASH_DIGITS];
    struct cs_text all = {0};
    if (cs_scene_hash(&session->scene, &session->method.table, session->method.options, scene,
                      error))
        return error->status;
    cs_hash_doubles(session->system.state, 6 * (size_t)session->system.view.n, start);
    cs_text_add(&all, "%s|%s|%s|%zu|%d|", CS_VERSION, scene, start, sizeof(struct record),
                (int)settings->axis);
    cs_text_add(&all, "%.17g|%.17g", settings->seconds, settings->budget);
    for (uint32_t r = 0; r < map->n_rows; r++)
        cs_text_add(&all, "|%.17g", map->dt[r]);
    for (uint32_t c = 0; c < map->n_columns; c++)
        cs_text_add(&all, "|%.17g", map->columns[c].value);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the key of a map");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, key);
    cs_text_finish(&all);
    return error->status;
}

static void take(struct cs_stability *map, const struct record *record) {
    if (record->column >= map->n_columns || record->row >= map->n_rows ||
        strncmp(record->key, map->journal.key, sizeof record->key) != 0)
        return;
    struct cs_stability_column *column = map->columns + record->column;
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

static enum cs_status read_back(struct cs_stability *map, struct cs_error *error) {
    char *bytes;
    size_t length;
    struct cs_error unread = {0};
    struct record *record = malloc(sizeof *record);
    if (!record)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the records of a map");
    if (!cs_file_read(map->journal.path, FILE_BYTES_MAX, &bytes, &length, &unread)) {
        for (size_t at = 0; at + sizeof *record <= length; at += sizeof *record) {
            memcpy(record, bytes + at, sizeof *record);
            take(map, record);
        }
        free(bytes);
        // what was cut off is taken away, or all that follows would be out of step
        if (length % sizeof *record &&
            truncate(map->journal.path, (off_t)(length - length % sizeof *record)))
            cs_fail(error, CS_ERR_FILE, "cannot write %s: %s", map->journal.path,
                    strerror(errno));
    }
    free(record);
    return error->status;
}

enum cs_status cs_journal_open(struct cs_stability *map, struct cs_error *error) {
    struct cs_journal *journal = &map->journal;
    const char *folder = map->settings->folder;
    char name[CS_SERIES_BYTES];
    journal->descriptor = -1;
    if (!folder)
        return CS_OK;
    cs_series_file_name(map->series, name);
    snprintf(journal->path, sizeof journal->path, "%s/%s.partial", folder, name);
    if (cs_folder_create(folder, error) || make_key(map, journal->key, error) ||
        read_back(map, error))
        return error->status;
    journal->descriptor = open(journal->path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (journal->descriptor < 0)
        cs_fail(error, CS_ERR_FILE, "cannot open %s: %s", journal->path, strerror(errno));
    return error->status;
}

/* In one call: nothing of another process comes in between. */
static enum cs_status append(const struct cs_stability *map, struct record *record,
                             struct cs_error *error) {
    if (map->journal.descriptor < 0)
        return CS_OK;
    memcpy(record->key, map->journal.key, sizeof record->key);
    if (write(map->journal.descriptor, record, sizeof *record) != sizeof *record)
        cs_fail(error, CS_ERR_FILE, "cannot write %s: %s", map->journal.path, strerror(errno));
    return error->status;
}

enum cs_status cs_journal_append_reference(const struct cs_stability *map, uint32_t column,
                                           struct cs_error *error) {
    struct record record = {.kind = REFERENCE, .column = column};
    record.of.reference = map->columns[column].reference;
    return append(map, &record, error);
}

enum cs_status cs_journal_append_cell(const struct cs_stability *map, uint32_t column,
                                      uint32_t row, struct cs_error *error) {
    struct record record = {.kind = CELL, .column = column, .row = row};
    record.of.cell = map->columns[column].cells[row];
    return append(map, &record, error);
}

enum cs_status cs_journal_append_boundary(const struct cs_stability *map, uint32_t column,
                                          struct cs_error *error) {
    struct record record = {.kind = BORDER, .column = column};
    record.of.border = map->columns[column].boundary;
    return append(map, &record, error);
}

void cs_journal_close(struct cs_stability *map, bool complete) {
    if (map->journal.descriptor > 0)
        close(map->journal.descriptor);
    map->journal.descriptor = -1;
    if (complete && *map->journal.path)
        unlink(map->journal.path);
}
