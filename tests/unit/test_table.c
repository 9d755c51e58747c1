/* Rows of tables read back as they were written, by however many processes. */
#include "base/file.h"
#include "session/table.h"
#include "unit.h"

#include <math.h>
#include <stdbool.h>
#include <sys/wait.h>

struct row {
    char name[8];
    double value;
    bool found;
};
static const struct cs_column columns[] = {
    {"name", CS_CELL_TEXT, "", "", false, offsetof(struct row, name), sizeof(char[8])},
    {"value", CS_CELL_NUMBER, "1", "", false, offsetof(struct row, value), sizeof(double)},
    {"found", CS_CELL_FLAG, "", "", false, offsetof(struct row, found), sizeof(bool)},
};

TEST(rows_read_back) {
    const struct row rows[] = {{"a,\"b\"\nc", 0.1, true}, {"d", (double)NAN, false}};
    struct row back[2];
    struct cs_text text = {0};
    cs_columns_print_names(columns, 3, &text);
    for (int k = 0; k < 2; k++)
        cs_columns_print_row(columns, 3, rows + k, &text);
    struct cs_error error = {0};
    struct cs_rows table;
    cs_file_write("rows", text.bytes, text.length, &error);
    cs_rows_open(&table, "rows", 0, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_str_eq(cs_rows_next(&table), "name,value,found");
    char *fields[3];
    for (int k = 0; k < 2; k++) {
        char *line = cs_rows_next(&table);
        ck_assert_str_eq(line, k ? "d,,0" : "\"a,\"\"b\"\" c\",0.1,1");
        ck_assert_uint_eq(cs_csv_cut(line, ',', fields, 3), 3);
        for (int c = 0; c < 3; c++)
            cs_column_parse(columns + c, back + k, fields[c]);
    }
    cs_rows_close(&table);
    // a text is cut to its member
    ck_assert_str_eq(back[0].name, "a,\"b\" c");
    ck_assert(back[0].value == 0.1 && back[0].found);
    ck_assert_str_eq(back[1].name, "d");
    ck_assert(isnan(back[1].value) && !back[1].found);
    cs_text_finish(&text);
}

/* Reads a table with two rows and one byte changed: it is refused, or its rows are there as
 * they were, but for the last one, which is none without its end. */
static void try_changed_byte(const struct cs_text *text, const char rows[2][32]) {
    struct cs_error error = {0};
    struct cs_rows table;
    cs_file_write("changed", text->bytes, text->length, &error);
    UNIT_ASSERT_OK(&error);
    if (cs_rows_open(&table, "changed", 0, &error)) {
        ck_assert_int_eq(error.status, CS_ERR_FILE);
        return;
    }
    // without the name of the last column it is a table that has no checks
    const bool checked = table.checked;
    const char *line = cs_rows_next(&table);
    for (int k = 0; k < 2 && (line = cs_rows_next(&table)); k++)
        ck_assert(!strncmp(line, rows[k], strlen(rows[k])) &&
                  (!checked || strlen(line) == strlen(rows[k])));
    cs_rows_close(&table);
}

TEST(a_table_without_checks_is_told) {
    struct cs_error error = {0};
    struct cs_rows table;
    cs_file_write("plain", "a,b\n1,2\n", 8, &error);
    ck_assert(!cs_rows_open(&table, "plain", 0, &error));
    cs_rows_refuse_unchecked(&table, "plain", &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "plain: it has no column \"check\"");
    cs_rows_close(&table);
}

TEST(changed_bytes_are_found) {
    const struct row rows[] = {{"a", 0.1, true}, {"bc", 2, false}};
    struct cs_text text = {0};
    cs_columns_print_names(columns, 3, &text);
    for (int k = 0; k < 2; k++)
        cs_columns_print_row(columns, 3, rows + k, &text);
    // the names of the columns but the last, and all that follows
    const size_t names = sizeof "name,value,found" - 1;
    for (size_t at = 0; at < text.length; at++)
        for (int bit = 0; bit < 8; bit++) {
            text.bytes[at] ^= (char)(1 << bit);
            if (at < names || at > names + sizeof ",check" - 1)
                try_changed_byte(&text, (const char[2][32]){"a,0.1,1", "bc,2,0"});
            text.bytes[at] ^= (char)(1 << bit);
        }
    cs_text_finish(&text);
}

TEST(fields_are_cut) {
    char quoted[] = "\"a\"\"b\",,\"c,d\",e", plain[] = "\"a,\tb", *fields[4];
    ck_assert_uint_eq(cs_csv_cut(quoted, ',', fields, 3), 3);
    ck_assert_str_eq(fields[0], "a\"b");
    ck_assert_str_eq(fields[1], "");
    ck_assert_str_eq(fields[2], "c,d");
    ck_assert_uint_eq(cs_csv_cut(plain, '\t', fields, 4), 2);
    ck_assert_str_eq(fields[0], "\"a,");
    ck_assert_str_eq(fields[1], "b");
}

/* Fails unless the rows of a file, one after the other, are the expected text. */
static void assert_rows(const char *path, size_t row_bytes, const char *expected) {
    struct cs_error error = {0};
    struct cs_rows rows;
    struct cs_text found = {0};
    cs_rows_open(&rows, path, row_bytes, &error);
    UNIT_ASSERT_OK(&error);
    for (const char *row; (row = cs_rows_next(&rows));)
        cs_text_add(&found, "%.*s", (int)(row_bytes ? row_bytes : strlen(row)), row);
    cs_rows_close(&rows);
    ck_assert_str_eq(cs_text_get(&found), expected);
    cs_text_finish(&found);
}

TEST(cut_off_rows_are_none) {
    struct cs_error error = {0};
    struct cs_row_table table;
    cs_row_table_open(&table, "a/b", "lines", ".lock", 0, &error);
    cs_file_write(table.path, "1\n2\n3", 5, &error);
    assert_rows(table.path, 0, "12");
    cs_row_table_append(&table, "4\n", 2, &error);
    assert_rows(table.path, 0, "124");
    cs_row_table_open(&table, "a", "records", "records", 3, &error);
    cs_file_write(table.path, "abcde", 5, &error);
    assert_rows(table.path, 3, "abc");
    cs_row_table_append(&table, "fgh", 3, &error);
    assert_rows(table.path, 3, "abcfgh");
    UNIT_ASSERT_OK(&error);
    struct cs_rows rows;
    ck_assert_int_eq(cs_rows_open(&rows, "a/none", 0, &error), CS_ERR_FILE);
    cs_rows_close(&rows);
}

/* Each adds rows of another length; no row is lost, none is in another one. */
TEST(processes_append_whole_rows) {
    enum { PROCESSES = 4, ROWS = 100 };
    struct cs_error error = {0};
    struct cs_row_table table;
    uint32_t n[PROCESSES] = {0};
    cs_row_table_open(&table, ".", "shared", "shared", 0, &error);
    for (int p = 0; p < PROCESSES; p++)
        if (!fork()) {
            char row[] = "aaaaaaaa\n";
            memset(row, 'a' + p, 8);
            for (int k = 0; k < ROWS; k++)
                cs_row_table_append(&table, row + p, 9 - (size_t)p, &error);
            _exit(error.status);
        }
    for (int status, p = 0; p < PROCESSES; p++) {
        wait(&status);
        ck_assert_int_eq(status, 0);
    }
    struct cs_rows rows;
    cs_rows_open(&rows, "shared", 0, &error);
    UNIT_ASSERT_OK(&error);
    for (const char *row; (row = cs_rows_next(&rows));) {
        const int p = *row - 'a';
        ck_assert(p >= 0 && p < PROCESSES && strlen(row) == 8 - (size_t)p);
        n[p]++;
    }
    cs_rows_close(&rows);
    for (int p = 0; p < PROCESSES; p++)
        ck_assert_uint_eq(n[p], ROWS);
}

TEST(lock_is_waited_for) {
    struct cs_error error = {0};
    struct cs_row_table table;
    int done[2];
    char byte = 0;
    ck_assert_int_eq(pipe(done), 0);
    cs_row_table_open(&table, ".", "table", ".lock", 0, &error);
    cs_row_table_lock(&table, &error);
    const pid_t child = fork();
    if (!child) {
        // of the two descriptors of the lock the parent's stays
        cs_row_table_unlock(&table);
        cs_row_table_append(&table, "child\n", 6, &error);
        _exit(write(done[1], &byte, 1) != 1);
    }
    usleep(50000);
    cs_file_write(table.path, "parent\n", 7, &error);
    cs_row_table_unlock(&table);
    ck_assert_int_eq(read(done[0], &byte, 1), 1);
    waitpid(child, NULL, 0);
    assert_rows(table.path, 0, "parentchild");
    UNIT_ASSERT_OK(&error);
}
