/* Reads and writes the tables of golden files. */
#include "golden/golden_table.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FRAMES_MAX = 10000000 };

/* Cuts a line into fields, in place. */
static enum cs_status read_row(const struct cs_golden_table *table, struct cs_golden_row *row,
                               char *line, struct cs_error *error) {
    char *fields[CS_GOLDEN_IMAGE_FIELDS];
    const uint32_t n = cs_csv_cut(line, '\t', fields, table->n_fields);
    const char *found = n == table->n_fields ? fields[3] : "";
    const size_t digits = strspn(found, "0123456789");
    // more than eight digits are not read, so that none is lost
    const uint32_t frames =
        digits < 9 && !found[digits] ? (uint32_t)strtoul(found, NULL, 10) : 0;
    if (frames == 0 || frames > FRAMES_MAX)
        return cs_fail(error, CS_ERR_FILE,
                       "%s: a row has less than %u fields, or \"%.30s\" frames, expected 1 to "
                       "%d: %s",
                       table->path, table->n_fields, found, FRAMES_MAX, line);
    row->run = (struct cs_golden_run){fields[0], fields[1], fields[2], frames};
    row->image = n == CS_GOLDEN_IMAGE_FIELDS ? fields[4] : NULL;
    row->hash = fields[n - 2];
    row->note = fields[n - 1];
    // pictures are written beside it, which must not lead out of the folder
    return row->image && (!*row->image || strchr(row->image, '/'))
               ? cs_fail(error, CS_ERR_FILE,
                         "%s: found the image \"%.60s\", expected a name without a slash",
                         table->path, row->image)
               : CS_OK;
}

enum cs_status cs_golden_table_read(struct cs_golden_table *table, const char *folder,
                                    const char *name, bool may_lack, struct cs_error *error) {
    snprintf(table->path, sizeof table->path, "%s/%s", folder, name);
    if (may_lack && access(table->path, F_OK)) {
        table->rows = calloc(1, sizeof *table->rows);
        return table->rows ? CS_OK : cs_fail(error, CS_ERR_MEMORY, "out of memory");
    }
    if (cs_rows_open(&table->lines, table->path, 0, error))
        return error->status;
    // a table that was edited by hand may lack the end of its last line
    table->lines.bytes[table->lines.length++] = '\n';
    table->rows = calloc(table->lines.n + 1, sizeof *table->rows);
    if (!table->rows)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    char *line = cs_rows_next(&table->lines);
    if (strcmp(line, table->head) != 0)
        return cs_fail(
            error, CS_ERR_FILE,
            "%s: the first line is not the names of %u columns between tabs; move the "
            "file away, and `clothsim golden --add SCENE -n N` makes a new one",
            table->path, table->n_fields);
    while (!error->status && (line = cs_rows_next(&table->lines)))
        if (*line)
            read_row(table, table->rows + table->n++, line, error);
    return error->status;
}

/* Prints a row as a line of the table. */
static void add_line(const struct cs_golden_row *row, const char *hash, const char *note,
                     struct cs_text *text) {
    cs_text_add(text, "%s\t%s\t%s\t%u\t", row->run.scene, row->run.integrator,
                row->run.overrides, row->run.frames);
    if (row->image)
        cs_text_add(text, "%s\t", row->image);
    cs_text_add(text, "%s\t%s\n", hash, note);
}

enum cs_status cs_golden_table_write(const struct cs_golden_table *table,
                                     struct cs_error *error) {
    struct cs_text text = {0};
    cs_text_add(&text, "%s\n", table->head);
    for (uint32_t k = 0; k < table->n; k++) {
        add_line(table->rows + k, table->rows[k].hash, table->rows[k].note, &text);
        if (table->rows[k].added)
            add_line(table->rows + k, table->rows[k].finding.found,
                     table->rows[k].finding.library, &text);
    }
    return cs_file_write_text(table->path, &text, error);
}

void cs_golden_table_close(struct cs_golden_table *table) {
    for (uint32_t k = 0; k < table->n; k++)
        cs_text_finish(&table->rows[k].message);
    free(table->rows);
    cs_rows_close(&table->lines);
}

static bool is_same_run(const struct cs_golden_run *a, const struct cs_golden_run *b) {
    return a->frames == b->frames && !strcmp(a->scene, b->scene) &&
           !strcmp(a->integrator, b->integrator) && !strcmp(a->overrides, b->overrides);
}

bool cs_golden_table_has(const struct cs_golden_table *table, const struct cs_golden_row *row) {
    bool found = false;
    for (uint32_t k = 0; k < table->n; k++) {
        const struct cs_golden_row *other = table->rows + k;
        // of two rows of other versions the first adds the row of this one
        found |= is_same_run(&other->run, &row->run) &&
                 (other->added || !strcmp(other->note, row->finding.library));
    }
    return found;
}

/* Gives the row a picture's name that no other row has: the scene's, with a number if needed.
 */
static void name_image(const struct cs_golden_table *table, struct cs_golden_row *row) {
    const char *slash = strrchr(row->run.scene, '/'),
               *name = slash ? slash + 1 : row->run.scene;
    const int length = (int)strcspn(name, ".");
    bool taken = true;
    for (uint32_t number = 1; taken; number++) {
        snprintf(row->name, sizeof row->name, number > 1 ? "%.*s_%u" : "%.*s", length, name,
                 number);
        taken = false;
        for (uint32_t k = 0; k < table->n; k++)
            taken |= !strcmp(table->rows[k].image, row->name);
    }
    row->image = row->name;
}

struct cs_golden_row *cs_golden_table_add(struct cs_golden_table *table,
                                          const struct cs_golden_run *run) {
    for (uint32_t k = 0; k < table->n; k++)
        if (is_same_run(&table->rows[k].run, run))
            return table->rows + k;
    struct cs_golden_row *row = table->rows + table->n;
    *row = (struct cs_golden_row){.run = *run, .hash = "", .note = "any"};
    if (table->n_fields == CS_GOLDEN_IMAGE_FIELDS)
        name_image(table, row);
    table->n++;
    return row;
}
