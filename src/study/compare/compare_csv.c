/* Writes the cells of a comparison as CSV (RFC 4180), and reads them back. */
#include "study/compare/compare_csv.h"

#include "base/csv.h"
#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_BYTES_MAX = 1 << 28, FIELDS_MAX = 128 };

void cs_csv_add_head(struct cs_text *out) {
    for (uint32_t c = 0; c < cs_n_columns; c++)
        cs_text_add(out, "%s%s", c ? "," : "", cs_columns[c].name);
    cs_text_add(out, "\n");
}

void cs_csv_add_cell(struct cs_text *out, const struct cs_cell *cell) {
    for (uint32_t c = 0; c < cs_n_columns; c++) {
        const struct cs_column *column = cs_columns + c;
        const char *field = (const char *)cell + column->offset;
        if (c)
            cs_text_add(out, ",");
        if (column->type == CS_CELL_TEXT)
            cs_csv_add_field(out, field);
        else if (column->type == CS_CELL_FLAG)
            cs_text_add(out, "%d", *(const bool *)field);
        else if (isfinite(cs_cell_number(cell, column)))
            cs_text_add_real(out, cs_cell_number(cell, column));
    }
    cs_text_add(out, "\n");
}

static void set_field(struct cs_cell *cell, const struct cs_column *column, const char *text) {
    char *field = (char *)cell + column->offset;
    double value = (double)NAN;
    if (column->type == CS_CELL_TEXT)
        snprintf(field, column->size, "%s", text);
    else if (column->type == CS_CELL_FLAG)
        *(bool *)field = !strcmp(text, "1");
    else if (cs_parse_real(text, &value))
        memcpy(field, &value, sizeof value);
}

static enum cs_status read_rows(const char *path, char *rest, struct cs_cell *cells,
                                uint32_t *n, struct cs_error *error) {
    const struct cs_column *columns[FIELDS_MAX];
    char *fields[FIELDS_MAX];
    uint32_t n_columns, n_fields;
    rest = cs_csv_cut_line(rest, fields, FIELDS_MAX, &n_columns);
    for (uint32_t c = 0; c < n_columns; c++)
        columns[c] = cs_column_find(fields[c]);
    if (!rest || !cs_column_find(fields[0]))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: the first line does not name the columns of a comparison", path);
    while (*rest) {
        struct cs_cell *cell = cells + *n;
        rest = cs_csv_cut_line(rest, fields, FIELDS_MAX, &n_fields);
        // a line that was cut off is as good as none
        if (!rest)
            break;
        cs_cell_init(cell, "");
        for (uint32_t c = 0; c < n_fields && c < n_columns; c++)
            if (columns[c])
                set_field(cell, columns[c], fields[c]);
        // files of before there were series
        if (!*cell->series)
            memcpy(cell->series, cell->method, sizeof cell->method);
        *n += n_fields == n_columns;
    }
    return CS_OK;
}

enum cs_status cs_csv_read(const char *path, struct cs_cell **cells, uint32_t *n,
                           struct cs_error *error) {
    char *text;
    size_t length, lines = 1;
    *cells = NULL;
    *n = 0;
    if (cs_file_read(path, FILE_BYTES_MAX, &text, &length, error))
        return error->status;
    for (size_t k = 0; k < length; k++)
        lines += text[k] == '\n';
    *cells = calloc(lines, sizeof **cells);
    if (!*cells)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu cells", lines);
    else if (read_rows(path, text, *cells, n, error)) {
        free(*cells);
        *cells = NULL;
    }
    free(text);
    return error->status;
}
