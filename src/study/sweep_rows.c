/* Reads, joins and writes the rows of sweep.csv. */
#include "study/sweep_rows.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const NAME = "sweep.csv";

enum cs_status cs_sweep_rows_open(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error) {
    return cs_row_table_open(&rows->table, folder, NAME, ".lock", 0, error);
}

void cs_sweep_rows_finish(struct cs_sweep_rows *rows) {
    for (uint32_t k = 0; k < rows->n; k++)
        free(rows->lines[k]);
    free(rows->lines);
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

enum cs_status cs_sweep_rows_read(struct cs_sweep_rows *rows, const char *folder,
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

/* Adds a row without its check, and the check. */
static void add_line(const struct cs_sweep_rows *rows, const char *line, struct cs_text *out) {
    const size_t from = out->length;
    cs_text_add(out, "%s", line);
    cs_csv_end_row(out, from, cs_text_get(&rows->names));
}

enum cs_status cs_sweep_rows_write(const struct cs_sweep_rows *rows, struct cs_error *error) {
    struct cs_text out = {.failed = rows->names.failed};
    cs_text_add(&out, "%s", cs_text_get(&rows->names));
    cs_csv_end_names(&out);
    for (uint32_t k = 0; k < rows->n; k++)
        if (rows->lines[k])
            add_line(rows, rows->lines[k], &out);
    return cs_file_write_text(rows->table.path, &out, error);
}

uint32_t cs_sweep_rows_count(const struct cs_sweep_rows *rows) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < rows->n; k++)
        n += rows->lines[k] != NULL;
    return n;
}
