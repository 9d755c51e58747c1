/* Reads and writes the tables of golden files. */
#include "golden/golden_table.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FRAMES_MAX = 10000000 };

/* Frames of a row; 0: none, or more than a run has. */
static uint32_t read_frames(const char *text) {
    const size_t digits = strspn(text, "0123456789");
    // more than eight digits are not read, so that none is lost
    const uint32_t frames = digits < 9 && !text[digits] ? (uint32_t)strtoul(text, NULL, 10) : 0;
    return frames > FRAMES_MAX ? 0 : frames;
}

double cs_golden_tolerance(const struct cs_golden_row *row) {
    double m = 0;
    return row->tolerance && cs_parse_real(row->tolerance, &m) ? m : 0;
}

/* Checks names of files, which must not lead out of the folder, and the tolerance. */
static enum cs_status check_row(const struct cs_golden_table *table,
                                const struct cs_golden_row *row, struct cs_error *error) {
    const char *name = row->image ? row->image : row->state;
    if (!*name || strchr(name, '/'))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: found the %s \"%.60s\", expected a name without a slash",
                       table->path, row->image ? "image" : "state", name);
    if (row->image || !strcmp(row->tolerance, "bits"))
        return CS_OK;
    if (!(cs_golden_tolerance(row) > 0))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: found the tolerance \"%.60s\", expected bits or a number of m",
                       table->path, row->tolerance);
    return strcmp(row->state, "-")
               ? CS_OK
               : cs_fail(error, CS_ERR_FILE,
                         "%s: found the tolerance %.60s without a state, which it is of",
                         table->path, row->tolerance);
}

/* Cuts a line into fields, in place. */
static enum cs_status read_row(const struct cs_golden_table *table, struct cs_golden_row *row,
                               char *line, struct cs_error *error) {
    char *fields[CS_GOLDEN_HASH_FIELDS];
    const bool has_image = table->n_fields == CS_GOLDEN_IMAGE_FIELDS;
    const uint32_t n = cs_csv_cut(line, '\t', fields, table->n_fields);
    const uint32_t least = has_image ? CS_GOLDEN_IMAGE_FIELDS : CS_GOLDEN_HASH_FIELDS - 2;
    const char *found = n >= least ? fields[3] : "";
    const uint32_t frames = read_frames(found);
    if (frames == 0)
        return cs_fail(error, CS_ERR_FILE,
                       "%s: a row has less than %u fields, or \"%.30s\" frames, expected 1 to "
                       "%d: %s",
                       table->path, least, found, FRAMES_MAX, line);
    row->run = (struct cs_golden_run){fields[0], fields[1], fields[2], frames};
    row->image = has_image ? fields[4] : NULL;
    row->hash = fields[has_image ? 5 : 4];
    row->note = fields[has_image ? 6 : 5];
    // tables of earlier releases end here
    row->tolerance = !has_image && n > least ? fields[6] : "bits";
    row->state = !has_image && n > least + 1 ? fields[7] : "-";
    return check_row(table, row, error);
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
    if (strcmp(line, table->head) != 0 &&
        (!table->former_head || strcmp(line, table->former_head) != 0))
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
    cs_text_add(text, "%s\t%s", hash, note);
    if (!row->image)
        cs_text_add(text, "\t%s\t%s", row->tolerance, row->state);
    cs_text_add(text, "\n");
}

enum cs_status cs_golden_table_write(const struct cs_golden_table *table,
                                     struct cs_error *error) {
    struct cs_text text = {0};
    cs_text_add(&text, "%s\n", table->head);
    for (uint32_t k = 0; k < table->n; k++) {
        add_line(table->rows + k, table->rows[k].hash, table->rows[k].note, &text);
        if (table->rows[k].added) {
            // stored states are those of the row before
            struct cs_golden_row other = table->rows[k];
            other.state = "-";
            add_line(&other, other.finding.found, other.finding.library, &text);
        }
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

/* True if a row has a picture or states of that name. */
static bool is_taken(const struct cs_golden_table *table, const char *name) {
    for (uint32_t k = 0; k < table->n; k++) {
        const struct cs_golden_row *row = table->rows + k;
        if (!strcmp(row->image ? row->image : row->state, name))
            return true;
    }
    return false;
}

/* Makes a name that no other row has: the scene's, with a number if needed. */
static const char *make_name(const struct cs_golden_table *table, struct cs_golden_row *row) {
    const char *slash = strrchr(row->run.scene, '/'),
               *name = slash ? slash + 1 : row->run.scene;
    if (*name == '.')
        name = "scene";
    const int length = (int)strcspn(name, ".");
    uint32_t number = 1;
    do {
        snprintf(row->name, sizeof row->name, number > 1 ? "%.*s_%u" : "%.*s", length, name,
                 number);
        number++;
    } while (is_taken(table, row->name));
    return row->name;
}

void cs_golden_table_name_states(const struct cs_golden_table *table,
                                 struct cs_golden_row *row) {
    if (strcmp(row->state, "-") != 0)
        return;
    row->state = make_name(table, row);
    row->is_state_new = true;
}

struct cs_golden_row *cs_golden_table_add(struct cs_golden_table *table,
                                          const struct cs_golden_run *run) {
    for (uint32_t k = 0; k < table->n; k++)
        if (is_same_run(&table->rows[k].run, run))
            return table->rows + k;
    struct cs_golden_row *row = table->rows + table->n;
    *row = (struct cs_golden_row){
        .run = *run, .hash = "", .note = "any", .tolerance = "bits", .state = "-"};
    if (table->n_fields == CS_GOLDEN_IMAGE_FIELDS)
        row->image = make_name(table, row);
    table->n++;
    return row;
}
