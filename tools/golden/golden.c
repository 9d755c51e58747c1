/* Compares state hashes and images with the golden tables, row by row. */
#include "golden/golden.h"

#include "base/clock.h"
#include "base/file.h"
#include "session/process_pool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* True if the row passes the filter by scene or integrator. */
static bool is_wanted(const struct cs_golden *golden, const struct cs_golden_row *row) {
    return !golden->only_rows || strstr(row->run.scene, golden->only_rows) ||
           strstr(row->run.integrator, golden->only_rows);
}

static void accept_row(struct cs_golden_row *row) {
    row->hash = row->finding.found;
    if (*row->finding.library)
        row->note = row->finding.library;
}

static void count(struct cs_golden *golden, const struct cs_golden_row *row) {
    if (row->finding.skipped && !row->added)
        golden->skipped++;
    else if (row->message.length == 0)
        golden->passed++;
    else if (golden->accept_all && !row->failed)
        golden->accepted++;
    else
        golden->failed++;
}

/* A table of one kind, and the check of its rows. */
struct kind {
    const char *name, *head, *former_head;
    uint32_t n_fields;
    enum cs_status (*check)(struct cs_golden *golden, struct cs_golden_row *row,
                            struct cs_error *error);
};
#define RUN_COLUMNS "scene\tintegrator\toverrides\tframes\thash\tbuilds"
static const struct kind hashes = {"hash.tsv", RUN_COLUMNS "\ttolerance\tstate", RUN_COLUMNS,
                                   CS_GOLDEN_HASH_FIELDS, cs_golden_check_state};
static const struct kind images = {
    "image.tsv", "scene\tintegrator\toverrides\tframe\timage\tpixels\trenderer", NULL,
    CS_GOLDEN_IMAGE_FIELDS, cs_golden_check_image};

/* A failed run is a failed row, unless the run is added, the user interrupts, or memory ends.
 */
static enum cs_status take_failure(struct cs_golden *golden, struct cs_golden_row *row,
                                   const struct cs_error *own, struct cs_error *error) {
    if (!own->status)
        return CS_OK;
    if (golden->add.scene || own->status == CS_ERR_INTERRUPT || own->status == CS_ERR_MEMORY)
        return cs_fail(error, own->status, "%s", own->message);
    row->failed = true;
    golden->broken++;
    cs_text_add(&row->message, "%s", own->message);
    return CS_OK;
}

/* Checks a row by the kind of its table, and its time. */
static enum cs_status check(struct cs_golden *golden, const struct kind *kind,
                            struct cs_golden_row *row, struct cs_error *error) {
    const double start = cs_clock_wall();
    kind->check(golden, row, error);
    row->finding.seconds = cs_clock_wall() - start;
    return error->status;
}

/* Counts, reports and accepts a row that was checked. */
static void settle(struct cs_golden *golden, const struct cs_golden_table *table,
                   struct cs_golden_row *row) {
    row->added = golden->accept_all && row->finding.skipped && *row->finding.library &&
                 !cs_golden_table_has(table, row);
    if (row->is_state_new && !row->finding.has_new_states)
        row->state = "-";
    count(golden, row);
    if (golden->report)
        golden->report(golden->ctx, row);
    if (golden->accept_all && row->message.length > 0 && !row->finding.skipped && !row->failed)
        accept_row(row);
}

/* The answer of a child for a row: in memory that it shares with its parent. */
struct answer {
    struct cs_golden_finding finding;
    char message[1024];
};

/* The rows of a table, some at a time. */
struct rows {
    struct cs_golden *golden;
    const struct kind *kind;
    struct cs_golden_table *table;
    uint32_t begun, settled; /* rows before these are */
    bool *done;              /* (n of the table) */
    uint32_t row_of[CS_PROCESS_POOL_MAX];
    struct answer *answers; /* (jobs), shared */
};

static bool next_row(void *ctx, uint32_t slot, struct cs_error *error) {
    struct rows *rows = ctx;
    (void)error;
    while (rows->begun < rows->table->n &&
           !is_wanted(rows->golden, rows->table->rows + rows->begun))
        rows->done[rows->begun++] = true;
    rows->row_of[slot] = rows->begun;
    rows->answers[slot] = (struct answer){.message = ""};
    return rows->begun++ < rows->table->n;
}

static enum cs_status answer_in_child(void *ctx, uint32_t slot, struct cs_error *error) {
    struct rows *rows = ctx;
    struct cs_golden_row *row = rows->table->rows + rows->row_of[slot];
    struct answer *answer = rows->answers + slot;
    check(rows->golden, rows->kind, row, error);
    answer->finding = row->finding;
    snprintf(answer->message, sizeof answer->message, "%s", cs_text_get(&row->message));
    return error->status;
}

static void take_answer(void *ctx, uint32_t slot, const struct cs_error *result,
                        struct cs_error *error) {
    struct rows *rows = ctx;
    const struct answer *answer = rows->answers + slot;
    struct cs_golden_row *row = rows->table->rows + rows->row_of[slot];
    row->finding = answer->finding;
    if (*row->finding.renderer)
        row->note = row->finding.renderer; // of an accepted picture
    cs_text_add(&row->message, "%s", answer->message);
    rows->done[rows->row_of[slot]] = true;
    if (take_failure(rows->golden, row, result, error))
        return;
    for (; rows->settled < rows->table->n && rows->done[rows->settled]; rows->settled++)
        if (is_wanted(rows->golden, rows->table->rows + rows->settled))
            settle(rows->golden, rows->table, rows->table->rows + rows->settled);
}

/* Names the states of a row that gets some. */
static void name_states(const struct cs_golden *golden, const struct cs_golden_table *table,
                        struct cs_golden_row *row) {
    if (golden->accept_all && golden->states && !row->image && is_wanted(golden, row))
        cs_golden_table_name_states(table, row);
}

/* Checks all rows of a table that are wanted. */
static enum cs_status check_rows(struct cs_golden *golden, const struct kind *kind,
                                 struct cs_golden_table *table, struct cs_error *error) {
    struct rows rows = {.golden = golden, .kind = kind, .table = table};
    const size_t bytes = golden->jobs * sizeof *rows.answers;
    const struct cs_isolate_queue queue = {.isolate = {.is_cell = true, .stop = golden->stop},
                                           .n_slots = golden->jobs,
                                           .ctx = &rows,
                                           .next = next_row,
                                           .task = answer_in_child,
                                           .ended = take_answer};
    rows.done = calloc(table->n + 1, sizeof *rows.done);
    rows.answers = cs_process_pool_shared_alloc(bytes, error);
    if (!rows.done)
        cs_fail(error, CS_ERR_MEMORY, "out of memory");
    // before rows are shared out: no two processes may choose the same name
    for (uint32_t k = 0; k < table->n; k++)
        name_states(golden, table, table->rows + k);
    if (!error->status)
        cs_isolate_queue_run(&queue, error);
    cs_process_pool_shared_free(rows.answers, bytes);
    free(rows.done);
    return error->status;
}

/* Checks and adds the run of --add. */
static enum cs_status append_golden_row(struct cs_golden *golden, const struct kind *kind,
                                        struct cs_golden_table *table, struct cs_error *error) {
    struct cs_golden_row *row = cs_golden_table_add(table, &golden->add);
    struct cs_error own = {0};
    const bool is_other = golden->add_tolerance && !row->image &&
                          strcmp(golden->add_tolerance, row->tolerance) != 0;
    row->tolerance = is_other ? golden->add_tolerance : row->tolerance;
    name_states(golden, table, row);
    check(golden, kind, row, &own);
    if (is_other)
        cs_text_add(&row->message, "%stolerance %s", row->message.length ? ", " : "",
                    row->tolerance);
    if (!take_failure(golden, row, &own, error))
        settle(golden, table, row);
    return error->status;
}

static bool is_there(const struct cs_golden *golden, const struct kind *kind) {
    char path[1024];
    snprintf(path, sizeof path, "%.900s/%s", golden->folder, kind->name);
    return access(path, F_OK) == 0;
}

/* Makes the folder; a new one keeps pictures that differ out of a repository of git. */
static enum cs_status make_folder(const struct cs_golden *golden, struct cs_error *error) {
    static const char names[] = "*.actual.png\n*.difference.png\n";
    char path[1024];
    snprintf(path, sizeof path, "%.900s/.gitignore", golden->folder);
    const bool is_new = !is_there(golden, &hashes);
    if (cs_folder_create(golden->folder, error) || !is_new)
        return error->status;
    return cs_file_write(path, names, sizeof names - 1, error);
}

static enum cs_status check_table(struct cs_golden *golden, const struct kind *kind,
                                  struct cs_error *error) {
    struct cs_golden_table table = {
        .head = kind->head, .former_head = kind->former_head, .n_fields = kind->n_fields};
    const uint32_t before = golden->accepted;
    const bool may_lack = golden->add.scene || golden->any_table;
    cs_golden_table_read(&table, golden->folder, kind->name, may_lack, error);
    if (!error->status)
        (golden->add.scene ? append_golden_row : check_rows)(golden, kind, &table, error);
    // a run that cannot be added leaves no folder
    if (!error->status && golden->accepted > before && !make_folder(golden, error))
        cs_golden_table_write(&table, error);
    cs_golden_table_close(&table);
    return error->status;
}

enum cs_status cs_golden_check(struct cs_golden *golden, struct cs_error *error) {
    char folder[1024];
    if (golden->any_table && !is_there(golden, &hashes) && !is_there(golden, &images))
        return cs_fail(error, CS_ERR_FILE,
                       "no golden files in \"%s\"; clothsim golden --add SCENE -n N makes them",
                       golden->folder);
    if (golden->hashes && check_table(golden, &hashes, error))
        return error->status;
    snprintf(folder, sizeof folder, "%.900s/image", golden->folder);
    if (golden->images && golden->add.scene && cs_folder_create(folder, error))
        return error->status;
    return golden->images ? check_table(golden, &images, error) : CS_OK;
}
