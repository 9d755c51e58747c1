/* Prints and cuts rows of tables; reads and appends them, one process at a time. */
#include "session/table.h"

#include "base/file.h"
#include "base/hash.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

enum { FILE_BYTES_MAX = 1 << 30, CHECK_DIGITS = 16 };
static const char CHECK[] = ",check";

/* A comma, unless the line is empty. */
static void add_comma(struct cs_text *out) {
    if (out->length && out->bytes[out->length - 1] != '\n')
        cs_text_add(out, ",");
}

void cs_csv_add_text(struct cs_text *out, const char *text) {
    struct cs_text plain = {0};
    const bool quoted = strpbrk(text, ",\"\r\n");
    cs_text_add_lines(&plain, text);
    add_comma(out);
    cs_text_add(out, "%s", quoted ? "\"" : "");
    for (const char *c = cs_text_get(&plain); *c; c++)
        cs_text_add(out, "%s%c", quoted && *c == '"' ? "\"" : "", *c == '\n' ? ' ' : *c);
    cs_text_add(out, "%s", quoted ? "\"" : "");
    out->failed |= plain.failed;
    cs_text_finish(&plain);
}

void cs_csv_add_number(struct cs_text *out, double value) {
    add_comma(out);
    if (isfinite(value))
        cs_text_add_real(out, value);
}

/* Hash of two texts, one after the other. */
static void find_check(const char *names, size_t names_length, const char *row, size_t length,
                       char digits[CS_HASH_DIGITS]) {
    char both[2 * CS_HASH_DIGITS];
    cs_hash_bytes(names, names_length, both);
    cs_hash_bytes(row, length, both + CS_HASH_DIGITS);
    cs_hash_bytes(both, sizeof both, digits);
}

void cs_csv_end_names(struct cs_text *out) {
    cs_text_add(out, "%s\n", CHECK);
}

void cs_csv_end_row(struct cs_text *out, size_t from, const char *names) {
    char digits[CS_HASH_DIGITS];
    if (out->failed)
        return;
    find_check(names, strlen(names), out->bytes + from, out->length - from, digits);
    cs_text_add(out, ",%.*s\n", CHECK_DIGITS, digits);
}

void cs_column_print_label(const struct cs_column *column, char *label, size_t size) {
    const bool measured = *column->unit && strcmp(column->unit, "1") != 0;
    snprintf(label, size, "%s%s%s", column->help, measured ? " in " : "",
             measured ? column->unit : "");
}

void cs_columns_add_names(const struct cs_column *columns, uint32_t n, struct cs_text *out) {
    for (uint32_t c = 0; c < n; c++)
        cs_csv_add_text(out, columns[c].name);
}

void cs_columns_print_names(const struct cs_column *columns, uint32_t n, struct cs_text *out) {
    cs_columns_add_names(columns, n, out);
    cs_csv_end_names(out);
}

static void add_fields(const struct cs_column *columns, uint32_t n, const void *row,
                       struct cs_text *out) {
    for (uint32_t c = 0; c < n; c++) {
        const char *member = (const char *)row + columns[c].offset;
        double value;
        if (columns[c].type == CS_CELL_NUMBER) {
            memcpy(&value, member, sizeof value);
            cs_csv_add_number(out, value);
        } else if (columns[c].type == CS_CELL_FLAG)
            cs_csv_add_text(out, *(const bool *)member ? "1" : "0");
        else
            cs_csv_add_text(out, member);
    }
}

void cs_columns_print_row(const struct cs_column *columns, uint32_t n, const void *row,
                          struct cs_text *out) {
    struct cs_text names = {0};
    const size_t from = out->length;
    cs_columns_add_names(columns, n, &names);
    add_fields(columns, n, row, out);
    out->failed |= names.failed;
    cs_csv_end_row(out, from, cs_text_get(&names));
    cs_text_finish(&names);
}

void cs_column_parse(const struct cs_column *column, void *row, const char *field) {
    char *member = (char *)row + column->offset;
    double value = (double)NAN;
    if (column->type == CS_CELL_TEXT)
        snprintf(member, column->size, "%s", field);
    else if (column->type == CS_CELL_FLAG)
        *(bool *)member = !strcmp(field, "1");
    else {
        cs_parse_real(field, &value);
        memcpy(member, &value, sizeof value);
    }
}

uint32_t cs_csv_cut(char *line, char separator, char **fields, uint32_t max) {
    for (uint32_t n = 0;; line++) {
        /* in place: a field without its quotes is never longer */
        char *out = line;
        const bool quoted = *line == '"' && separator == ',';
        if (n < max)
            fields[n++] = out;
        if (quoted)
            line++;
        while (*line && (quoted ? *line != '"' || line[1] == '"' : *line != separator)) {
            if (quoted && *line == '"')
                line++;
            *out++ = *line++;
        }
        if (quoted && *line == '"')
            line++;
        const char end = *line;
        *out = 0;
        if (end != separator)
            return n;
    }
}

enum cs_status cs_row_table_open(struct cs_row_table *table, const char *folder,
                                 const char *name, const char *lock, size_t row_bytes,
                                 struct cs_error *error) {
    *table = (struct cs_row_table){.row_bytes = row_bytes};
    snprintf(table->path, sizeof table->path, "%s/%s", folder, name);
    snprintf(table->lock_path, sizeof table->lock_path, "%s/%s", folder, lock);
    return cs_folder_create(folder, error);
}

/* Returns the descriptor of a lock that is held; a negative number after failure. A signal
 * interrupts the wait and not the lock, so the wait goes on: no owner keeps it long. On a file
 * system without locks there is no wait. */
static int take_lock(const char *path, struct cs_error *error) {
    const int lock = cs_file_open_shared(path, O_CREAT, error);
    while (lock >= 0 && flock(lock, LOCK_EX) && errno == EINTR)
        ;
    return lock;
}

enum cs_status cs_row_table_lock(struct cs_row_table *table, struct cs_error *error) {
    table->lock = take_lock(table->lock_path, error) + 1;
    return error->status;
}

void cs_row_table_unlock(struct cs_row_table *table) {
    if (table->lock)
        close(table->lock - 1);
    table->lock = 0;
}

/* Offset at which the last whole row ends; a negative number, with errno, if that cannot be
 * found. */
static off_t end_of_rows(int file, size_t row_bytes) {
    off_t end = lseek(file, 0, SEEK_END);
    if (end > 0 && row_bytes)
        return end - end % (off_t)row_bytes;
    for (char last; end > 0 && pread(file, &last, 1, end - 1) == 1 && last != '\n';)
        end--;
    return end;
}

enum cs_status cs_row_table_append(const struct cs_row_table *table, const void *rows,
                                   size_t length, struct cs_error *error) {
    const int lock = take_lock(table->lock_path, error);
    if (lock < 0)
        return error->status;
    const int file = cs_file_open_shared(table->path, O_CREAT, error);
    const off_t end = file >= 0 ? end_of_rows(file, table->row_bytes) : -1;
    const bool wrote =
        end >= 0 && !ftruncate(file, end) && pwrite(file, rows, length, end) == (ssize_t)length;
    if ((file >= 0 && close(file)) || !wrote)
        cs_fail(error, CS_ERR_FILE, "cannot write %s: %s", table->path, strerror(errno));
    close(lock);
    return error->status;
}

/* Length of a line without its check; its whole length if it has none. */
static size_t find_check_start(const char *line, size_t length) {
    const char *comma = memrchr(line, ',', length);
    return comma ? (size_t)(comma - line) : length;
}

/* True if a line ends with the check of its fields. */
static bool is_as_written(const char *names, size_t names_length, const char *line,
                          size_t length) {
    char digits[CS_HASH_DIGITS];
    const size_t fields = find_check_start(line, length);
    find_check(names, names_length, line, fields, digits);
    return length == fields + 1 + CHECK_DIGITS &&
           !memcmp(line + fields + 1, digits, CHECK_DIGITS);
}

/* Checks all whole lines of a table whose first line ends with "check". */
static enum cs_status check_lines(struct cs_rows *rows, const char *path,
                                  struct cs_error *error) {
    const char *names = rows->bytes, *end = names + rows->length, *line = names, *stop;
    size_t names_length = 0;
    for (uint32_t k = 1; (stop = memchr(line, '\n', (size_t)(end - line)));
         line = stop + 1, k++) {
        const size_t length = (size_t)(stop - line);
        if (k == 1) {
            names_length = length - (sizeof CHECK - 1);
            rows->checked = length >= sizeof CHECK &&
                            !memcmp(names + names_length, CHECK, sizeof CHECK - 1);
            if (!rows->checked)
                return CS_OK;
        } else if (!is_as_written(names, names_length, line, length))
            return cs_fail(error, CS_ERR_FILE,
                           "%s: line %u, or the first, is not as it was written; a row that is "
                           "removed is computed again",
                           path, k);
    }
    return CS_OK;
}

enum cs_status cs_rows_open(struct cs_rows *rows, const char *path, size_t row_bytes,
                            struct cs_error *error) {
    *rows = (struct cs_rows){.row_bytes = row_bytes};
    if (cs_file_read(path, FILE_BYTES_MAX, &rows->bytes, &rows->length, error))
        return error->status;
    for (size_t k = 0; k < rows->length; k++)
        rows->n += rows->bytes[k] == '\n';
    if (!row_bytes && check_lines(rows, path, error))
        cs_rows_close(rows);
    return error->status;
}

enum cs_status cs_rows_refuse_unchecked(const struct cs_rows *rows, const char *path,
                                        struct cs_error *error) {
    return rows->checked || !rows->n
               ? CS_OK
               : cs_fail(error, CS_ERR_FILE,
                         "%s: it has no column \"check\", by which changed rows are found; "
                         "clothsim merge --unchecked takes its rows as they are",
                         path);
}

char *cs_rows_next(struct cs_rows *rows) {
    const size_t left = rows->length - rows->at;
    char *row = rows->bytes + rows->at;
    size_t length = rows->row_bytes;
    if (!length) {
        char *end = left ? memchr(row, '\n', left) : NULL;
        if (!end)
            return NULL;
        length = (size_t)(end - row) + 1;
        row[rows->checked ? find_check_start(row, length - 1) : length - 1] = 0;
    }
    if (length > left)
        return NULL;
    rows->at += length;
    return row;
}

void cs_rows_close(struct cs_rows *rows) {
    free(rows->bytes);
    *rows = (struct cs_rows){0};
}
