/* table.h - the figures of one section: aligned for a terminal, or as CSV. */
#ifndef BENCH_TABLE_H
#define BENCH_TABLE_H

#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

struct bench_section;
struct bench_settings;

struct bench_table {
    const struct bench_section *section; /* its name and columns */
    struct cs_text lines;                /* rows, cells between commas; owned */
};

/* Adds a row: as many cells as there are columns, with commas between; a cell may be empty. */
void bench_table_add(struct bench_table *table, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Adds the table with a line of names, numbers to the right. */
void bench_table_print(const struct bench_table *table, struct cs_text *out);

/* Writes folder/NAME.csv: lines of "# key: value" that say where, when and with what the
 * figures were measured, and which columns name a case; then names; then rows. */
enum cs_status bench_table_write(const struct bench_table *table,
                                 const struct bench_settings *settings, const char *folder,
                                 struct cs_error *error);

void bench_table_finish(struct bench_table *table);

#endif
