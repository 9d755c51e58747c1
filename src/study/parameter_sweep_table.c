/* Keeps the rows of a sweep by their cells: lines of a file, as they are. */
#include "study/parameter_sweep_table.h"

#include "base/file.h"
#include "base/lock.h"
#include "study/parameter_sweep_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_BYTES_MAX = 1 << 30 };

void cs_product_table_finish(struct cs_parameter_sweep_table *table) {
    for (uint32_t k = 0; k < table->n; k++)
        free(table->lines[k]);
    free(table->lines);
    free(table->header);
    *table = (struct cs_parameter_sweep_table){0};
}

enum cs_status cs_product_table_grow(struct cs_parameter_sweep_table *table, uint32_t n,
                                     struct cs_error *error) {
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
static enum cs_status take_line(struct cs_parameter_sweep_table *table, const char *line,
                                const char *path, struct cs_error *error) {
    char *end;
    const unsigned long cell = strtoul(line, &end, 10);
    if (end == line || *end != ',' || cell >= CS_PARAMETER_SWEEP_CELLS_MAX)
        return CS_OK;
    if (cs_product_table_grow(table, (uint32_t)cell + 1, error))
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
enum cs_status cs_product_table_read(struct cs_parameter_sweep_table *table, const char *path,
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
        else if (!table->header && !(table->header = strdup(rest)))
            cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", path);
        else if (strcmp(table->header, rest) != 0)
            cs_fail(error, CS_ERR_USAGE, "%s is of another sweep: its columns differ", path);
        end[1] = kept;
        rest = end + 1;
        end = strchr(rest, '\n');
    }
    free(bytes);
    return error->status;
}

enum cs_status cs_product_table_write(const struct cs_parameter_sweep_table *table,
                                      struct cs_error *error) {
    struct cs_text out = {0};
    cs_text_add(&out, "%s", table->header);
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

enum cs_status cs_product_table_open(struct cs_parameter_sweep_table *table, const char *folder,
                                     struct cs_error *error) {
    *table = (struct cs_parameter_sweep_table){0};
    snprintf(table->path, sizeof table->path, "%s/sweep.csv", folder);
    snprintf(table->lock, sizeof table->lock, "%s/.lock", folder);
    return cs_folder_create(folder, error);
}

enum cs_status cs_parameter_sweep_table_store(struct cs_parameter_sweep_table *table,
                                              uint32_t cell, const char *line,
                                              struct cs_error *error) {
    struct cs_lock lock;
    table->lines[cell] = strdup(line);
    if (!table->lines[cell])
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    if (cs_lock_acquire(&lock, table->lock, error))
        return error->status;
    cs_file_append(table->path, line, strlen(line), error);
    cs_lock_release(&lock);
    return error->status;
}

bool cs_product_table_has(const struct cs_parameter_sweep_table *table, uint32_t cell,
                          const char *key) {
    const char *found = key_of(table->lines[cell]);
    const size_t length = strlen(key);
    return !strncmp(found, key, length) && !strcmp(found + length, "\n");
}
