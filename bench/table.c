/* Prints the figures of a section as an aligned table, or as CSV. */
#include "table.h"

#include "base/file.h"
#include "bench.h"
#include "commit.h"
#include "session/provenance_write.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { COLUMNS_MAX = 16, GAP = 2 };

static uint32_t count_columns(const struct bench_table *table) {
    uint32_t n = 0;
    while (table->section->columns[n])
        n++;
    CS_ASSERT(n <= COLUMNS_MAX);
    return n;
}

void bench_table_add(struct bench_table *table, const char *format, ...) {
    char line[512];
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    CS_ASSERT(length >= 0 && (size_t)length < sizeof line);
    uint32_t cells = 1;
    for (const char *c = line; *c; c++)
        cells += *c == ',';
    CS_ASSERT(cells == count_columns(table));
    cs_text_add(&table->lines, "%s\n", line);
}

/* widths of the columns, names and cells */
static void measure(const struct bench_table *table, size_t widths[COLUMNS_MAX]) {
    const uint32_t n = count_columns(table);
    for (uint32_t c = 0; c < n; c++)
        widths[c] = strlen(table->section->columns[c]);
    uint32_t column = 0;
    for (const char *cell = cs_text_get(&table->lines); *cell;) {
        const size_t width = strcspn(cell, ",\n");
        widths[column] = width > widths[column] ? width : widths[column];
        column = cell[width] == ',' ? column + 1 : 0;
        cell += width + 1;
    }
}

/* names and words to the left, numbers to the right */
static void add_cell(struct cs_text *out, const char *cell, size_t length, size_t width,
                     bool key) {
    const int pad = (int)(width - length), size = (int)length;
    if (key)
        cs_text_add(out, "%.*s%*s", size, cell, pad + GAP, "");
    else
        cs_text_add(out, "%*s%.*s%*s", pad, "", size, cell, GAP, "");
}

static void end_line(struct cs_text *out) {
    while (out->length && out->bytes[out->length - 1] == ' ')
        out->bytes[--out->length] = 0;
    cs_text_add(out, "\n");
}

void bench_table_print(const struct bench_table *table, struct cs_text *out) {
    const struct bench_section *section = table->section;
    const uint32_t n = count_columns(table);
    size_t widths[COLUMNS_MAX];
    measure(table, widths);
    cs_text_add(out, "%s: %s\n", section->name, section->summary);
    for (uint32_t c = 0; c < n; c++)
        add_cell(out, section->columns[c], strlen(section->columns[c]), widths[c],
                 c < section->n_keys);
    end_line(out);
    uint32_t column = 0;
    for (const char *cell = cs_text_get(&table->lines); *cell;) {
        const size_t length = strcspn(cell, ",\n");
        add_cell(out, cell, length, widths[column], column < section->n_keys);
        /* a cell without a comma behind it is the last of its line */
        column = cell[length] == ',' ? column + 1 : 0;
        if (!column)
            end_line(out);
        cell += length + 1;
    }
    cs_text_add(out, "\n");
}

static void add_machine(const struct bench_section *section,
                        const struct bench_settings *settings, struct cs_text *out) {
    struct cs_machine machine;
    char date[32];
    const time_t now = time(NULL);
    struct tm utc;
    cs_machine_detect(&machine);
    strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", gmtime_r(&now, &utc));
    cs_text_add(out, "# section: %s\n# date: %s\n", section->name, date);
    cs_text_add(out, "# version: clothsim %s, commit %s\n", machine.version, BENCH_COMMIT);
    cs_text_add(out, "# machine: %s, %ld processors, load %.2f\n",
                *machine.processor ? machine.processor : "unknown", machine.processors,
                machine.load);
    cs_text_add(out, "# compiler: %s, %s\n", machine.compiler, machine.flags);
    cs_text_add(out, "# threads: %u\n# mode: %s\n", settings->threads,
                settings->quick ? "quick" : "full");
    cs_text_add(out, "# keys: %u\n# measured: %s\n", section->n_keys, section->measured);
}

enum cs_status bench_table_write(const struct bench_table *table,
                                 const struct bench_settings *settings, const char *folder,
                                 struct cs_error *error) {
    const struct bench_section *section = table->section;
    struct cs_text csv = {0}, path = {0};
    add_machine(section, settings, &csv);
    for (uint32_t c = 0; section->columns[c]; c++)
        cs_text_add(&csv, "%s%s", c ? "," : "", section->columns[c]);
    cs_text_add(&csv, "\n%s", cs_text_get(&table->lines));
    cs_text_add(&path, "%s/%s.csv", folder, section->name);
    if (csv.failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the table \"%s\"", section->name);
    else if (!cs_folder_create(folder, error))
        cs_file_write(path.bytes, csv.bytes, csv.length, error);
    cs_text_finish(&csv);
    cs_text_finish(&path);
    return error->status;
}

void bench_table_finish(struct bench_table *table) {
    cs_text_finish(&table->lines);
}
