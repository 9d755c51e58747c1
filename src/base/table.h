/* table.h - the rows of a table in a file that several processes fill, so that an interrupted
 * study goes on with the rows that are there.
 *
 *   open -> lock, read what is there, write it in order -> append rows as they come
 *
 * A row is a line of fields (RFC 4180), the first of which names the columns, or a record of a
 * fixed size.
 */
#ifndef CS_ROW_TABLE_H
#define CS_ROW_TABLE_H

#include "base/status.h"
#include "base/text.h"

#include <stdbool.h>
#include <stdint.h>

/* Adds a field, after a comma where it is not the first of its line, which must not be empty. A
 * text is in quotes where it must be, and its line breaks become blanks, because a row is a
 * line. A number that is not finite is an empty field; others read back the same. */
void cs_csv_add_text(struct cs_text *out, const char *text);
void cs_csv_add_number(struct cs_text *out, double value);

/* The kind of a member: char[size], double, bool. */
enum cs_cell_type { CS_CELL_TEXT, CS_CELL_NUMBER, CS_CELL_FLAG };

/* A column of a table: a member of the struct that is a row. */
struct cs_column {
    const char *name;  /* as in the file */
    const char *label; /* of an axis, with its unit; NULL: cannot be drawn */
    enum cs_cell_type type;
    size_t offset, size;
};

/* Add a line: the names of n columns, or the fields of a row. */
void cs_columns_print_names(const struct cs_column *columns, uint32_t n, struct cs_text *out);
void cs_columns_print_row(const struct cs_column *columns, uint32_t n, const void *row,
                          struct cs_text *out);
/* Sets the member of a row: a text is cut to its size, a number that cannot be read is NAN. */
void cs_column_parse(const struct cs_column *column, void *row, const char *field);

/* Cuts a line into its fields in place, without their quotes. Returns their number; those after
 * the first (max) are passed over. Quotes stand for themselves in tables with another separator
 * than a comma. */
uint32_t cs_csv_cut(char *line, char separator, char **fields, uint32_t max);

struct cs_row_table {
    char path[4200], lock_path[4200];
    size_t row_bytes; /* of a record; 0: rows are lines */
    int lock;         /* descriptor, above 0: taken */
};

/* Makes the folder and names the files FOLDER/NAME and FOLDER/LOCK; reads nothing. A table that
 * is never written anew may be its own lock. CS_ERR_FILE. */
enum cs_status cs_row_table_open(struct cs_row_table *table, const char *folder,
                                 const char *name, const char *lock, size_t row_bytes,
                                 struct cs_error *error);

/* Waits until no other process holds the lock, which the end of a process releases.
 * CS_ERR_FILE. */
enum cs_status cs_row_table_lock(struct cs_row_table *table, struct cs_error *error);
/* Safe on a zeroed table. */
void cs_row_table_unlock(struct cs_row_table *table);

/* Adds whole rows to the end, under the lock. What a killed process has left of its last row is
 * removed first. CS_ERR_FILE. */
enum cs_status cs_row_table_append(const struct cs_row_table *table, const void *rows,
                                   size_t length, struct cs_error *error);

/* The rows of a file, one after the other. Zeroed: none. */
struct cs_rows {
    char *bytes; /* (length + 1) owned; rows point into it */
    size_t length, at, row_bytes;
    uint32_t n; /* lines, with the names of the columns */
};

/* Reads a file; (rows) is zeroed where it fails. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_rows_open(struct cs_rows *rows, const char *path, size_t row_bytes,
                            struct cs_error *error);
/* The next line, without its end, or the next record; NULL: there is no other. A last row that
 * was cut off is none. */
char *cs_rows_next(struct cs_rows *rows);
void cs_rows_close(struct cs_rows *rows);

/* Which of the rows of a study one process makes: the number-th of so many shares, from 1 on;
 * zeroed: all. */
struct cs_shard {
    uint32_t index, count;
};

static inline bool cs_shard_holds(const struct cs_shard *shard, uint32_t row) {
    return shard->count == 0 || row % shard->count == shard->index - 1;
}

#endif
