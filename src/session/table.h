/* table.h - rows of a table in a file that several processes fill. An interrupted study
 * continues with the rows that are there.
 *
 *   open -> lock, read the rows, write them in order -> append rows as they are computed
 *
 * A row is a line of fields (RFC 4180), with column names in the first line, or a record of a
 * fixed size. The last field of a line is its check: a hash of the first line and of the fields
 * before it, so that a changed byte is found, and rows can still be appended one by one. */
#ifndef CS_ROW_TABLE_H
#define CS_ROW_TABLE_H

#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

/* Appends a field, after a comma unless it is the first of its line; the first field must not
 * be empty. A text is quoted where necessary, and its line breaks become blanks, because a row
 * is a line. A number that is not finite becomes an empty field; others read back exactly. */
void cs_csv_add_text(struct cs_text *out, const char *text);
void cs_csv_add_number(struct cs_text *out, double value);

/* End a line: the names of the columns, or the row that begins at `from`, under names as
 * returned by cs_rows_next, with its check. */
void cs_csv_end_names(struct cs_text *out);
void cs_csv_end_row(struct cs_text *out, size_t from, const char *names);

/* C type of a column's member: char[size], double, bool. */
enum cs_cell_type { CS_CELL_TEXT, CS_CELL_NUMBER, CS_CELL_FLAG };

/* A column: its description, and its member of the struct that is a row, if there is one. */
struct cs_column {
    const char *name; /* as in the file */
    enum cs_cell_type type;
    const char *unit; /* SI, "1" for a ratio; "" for none */
    const char *help; /* lower case, no full stop */
    bool drawn;       /* can be an axis of a diagram */
    size_t offset, size;
};

/* Columns of a table whose rows are no struct. */
#define CS_TEXT_COLUMN(name, help)                                                             \
    { name, CS_CELL_TEXT, "", help, false, 0, 0 }
#define CS_NUMBER_COLUMN(name, unit, help)                                                     \
    { name, CS_CELL_NUMBER, unit, help, false, 0, 0 }

/* Prints what an axis is called: the help, and the unit in words. */
void cs_column_print_label(const struct cs_column *column, char *label, size_t size);

/* Adds the names of n columns, after a comma unless they are the first of their line. */
void cs_columns_add_names(const struct cs_column *columns, uint32_t n, struct cs_text *out);
/* Append a line: the names of n columns, or the fields of a row; each with its end. */
void cs_columns_print_names(const struct cs_column *columns, uint32_t n, struct cs_text *out);
void cs_columns_print_row(const struct cs_column *columns, uint32_t n, const void *row,
                          struct cs_text *out);
/* Sets the member of a row from a field. A text is cut to its size; a number that cannot be
 * read is NAN. */
void cs_column_parse(const struct cs_column *column, void *row, const char *field);

/* Cuts a line into its fields in place, without their quotes. Returns the number of fields
 * stored; those after the first max are skipped. With another separator than a comma, quotes
 * are ordinary characters. */
uint32_t cs_csv_cut(char *line, char separator, char **fields, uint32_t max);

struct cs_row_table {
    char path[4200], lock_path[4200];
    size_t row_bytes; /* of a record; 0: rows are lines */
    int lock;         /* descriptor + 1; 0: not taken */
};

/* Makes the folder and sets the paths FOLDER/NAME and FOLDER/LOCK; reads nothing. A table that
 * is only ever appended to may be its own lock. CS_ERR_FILE. */
enum cs_status cs_row_table_open(struct cs_row_table *table, const char *folder,
                                 const char *name, const char *lock, size_t row_bytes,
                                 struct cs_error *error);

/* Waits until no other process holds the lock, and takes it. The end of a process releases it.
 * CS_ERR_FILE. */
enum cs_status cs_row_table_lock(struct cs_row_table *table, struct cs_error *error);
/* Safe on a zeroed table. */
void cs_row_table_unlock(struct cs_row_table *table);

/* Appends whole rows under the lock, after removing a partial last row that a killed process
 * left. CS_ERR_FILE. */
enum cs_status cs_row_table_append(const struct cs_row_table *table, const void *rows,
                                   size_t length, struct cs_error *error);

/* The rows of a file, read one by one. Zeroed: none. */
struct cs_rows {
    char *bytes; /* (length + 1) owned; rows point into it */
    size_t length, at, row_bytes;
    uint32_t n;   /* lines, with the names of the columns */
    bool checked; /* lines end with their checks */
};

/* Reads a file; *rows is zeroed on failure. A line that does not match its check is
 * CS_ERR_FILE. Tables of earlier versions, and those that others write, have no checks, and are
 * taken as they are: results are not built on them. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_rows_open(struct cs_rows *rows, const char *path, size_t row_bytes,
                            struct cs_error *error);
/* Refuses a table of lines without checks. CS_ERR_FILE. */
enum cs_status cs_rows_refuse_unchecked(const struct cs_rows *rows, const char *path,
                                        struct cs_error *error);
/* Returns the next line, without its check and its end, or the next record; NULL after the
 * last. A partial last row is skipped. */
char *cs_rows_next(struct cs_rows *rows);
void cs_rows_close(struct cs_rows *rows);

/* The rows of a study that one process computes: number `index` of `count` interleaved sets,
 * from 1 on. Zeroed: all rows. */
struct cs_shard {
    uint32_t index, count;
};

static inline bool cs_shard_holds(const struct cs_shard *shard, uint32_t row) {
    return shard->count == 0 || row % shard->count == shard->index - 1;
}

#endif
