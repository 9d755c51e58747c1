/* Compares state hashes and images with the golden tables, row by row. */
#include "golden/golden.h"

#include "base/file.h"
#include "io/png.h"
#include "shared/image_diff.h"
#include "study/follow.h"
#include "study/frame_picture.h"
#include "study/process_pool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Splits "path=value;path=value" in place. Returns the number of overrides. */
static uint32_t split_overrides(char *text, struct cs_override *overrides) {
    uint32_t n = 0;
    char *pair;
    while (n < CS_GOLDEN_SETS_MAX && (pair = strsep(&text, ";"))) {
        char *equals = strchr(pair, '=');
        if (!equals)
            continue;
        *equals = 0;
        overrides[n++] = (struct cs_override){pair, equals + 1};
    }
    return n;
}

/* Steps a row's run to its last frame. On success the session is open and the caller closes it.
 */
static enum cs_status step_golden(const struct cs_golden *golden,
                                  const struct cs_golden_run *run, bool render,
                                  struct cs_session *session, struct cs_error *error) {
    char scene[1280], text[CS_GOLDEN_SETS_BYTES];
    struct cs_override overrides[CS_GOLDEN_SETS_MAX];
    /* scenes are named from the folder above the golden one, which is often this one */
    const bool here = *golden->folder != '.' && !strchr(golden->folder, '/');
    snprintf(scene, sizeof scene, "%s%s%s", here ? "" : golden->folder, here ? "" : "/../",
             run->scene);
    /* a copy, which split_overrides cuts up */
    snprintf(text, sizeof text, "%s", run->overrides);
    const struct cs_session_settings settings = {
        .scene = scene,
        .overrides = overrides,
        .n_overrides = split_overrides(text, overrides),
        .integrator = strcmp(run->integrator, "-") ? run->integrator : NULL,
        .render = render,
        .threads = golden->threads,
        .run = {.stop = golden->stop},
    };
    if (cs_session_open(session, &settings, error))
        return error->status;
    struct cs_follow follow = {.run = &session->run, .last = run->frames};
    cs_follow_next(&follow, error);
    if (cs_follow_check(&session->run, "", error))
        cs_session_close(session);
    return error->status;
}

static void path_of(const struct cs_golden *golden, const struct cs_golden_row *row,
                    const char *ending, char path[1024]) {
    snprintf(path, 1024, "%.500s/image/%.400s%s", golden->folder, row->image, ending);
}

static enum cs_status write_image(const struct cs_golden *golden,
                                  const struct cs_golden_row *row, const char *ending,
                                  const struct cs_image *image, struct cs_error *error) {
    char path[1024];
    path_of(golden, row, ending, path);
    return cs_png_write(path, image, 6, NULL, 0, error);
}

/* Writes the picture and 16 times the difference beside the golden image. */
static enum cs_status write_evidence(const struct cs_golden *golden,
                                     const struct cs_golden_row *row,
                                     const struct cs_image *found,
                                     const struct cs_image *expected, struct cs_error *error) {
    struct cs_image amplified = {found->width, found->height, malloc(cs_image_bytes(found)),
                                 NULL};
    if (!amplified.rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    cs_image_amplify(found, expected, &amplified);
    if (!write_image(golden, row, ".actual.png", found, error))
        write_image(golden, row, ".difference.png", &amplified, error);
    free(amplified.rgb);
    return error->status;
}

/* Removes the evidence of an earlier check. */
static void remove_evidence(const struct cs_golden *golden, const struct cs_golden_row *row) {
    char path[1024];
    path_of(golden, row, ".actual.png", path);
    remove(path);
    path_of(golden, row, ".difference.png", path);
    remove(path);
}

/* Fills row->message if the picture does not pass. */
static enum cs_status judge(const struct cs_golden *golden, struct cs_golden_row *row,
                            const struct cs_image *found, const char *renderer,
                            struct cs_error *error) {
    const bool same_renderer = !strcmp(renderer, row->note);
    /* equal hashes of pixels decide: the golden picture need not be read */
    if (same_renderer && !strcmp(row->finding.found, row->hash))
        return CS_OK;
    char path[1024];
    struct cs_image expected;
    path_of(golden, row, ".png", path);
    if (cs_png_read(path, &expected, error))
        return error->status;
    if (expected.width != found->width || expected.height != found->height) {
        cs_text_add(&row->message, "%u x %u pixels, expected %u x %u", found->width,
                    found->height, expected.width, expected.height);
    } else {
        const struct cs_image_difference d = cs_image_compare(found, &expected);
        if (same_renderer || !cs_image_difference_passes(&d)) {
            cs_text_add(
                &row->message,
                "%llu pixels differ, RMSE %.3f, %.3f %% off by more than 2, largest %d%s",
                (unsigned long long)d.pixels, d.rmse, 100 * d.share, d.largest,
                same_renderer ? " (same renderer: every pixel counts)" : "");
            write_evidence(golden, row, found, &expected, error);
        }
    }
    free(expected.rgb);
    return error->status;
}

/* Accepts the picture. Only the CPU renderer may, because its pixels are equal on all machines.
 */
static enum cs_status accept_image(const struct cs_golden *golden, struct cs_golden_row *row,
                                   const struct cs_image *found, struct cs_text *renderer,
                                   struct cs_error *error) {
    if (strncmp(cs_text_get(renderer), "cpu", 3))
        return cs_fail(error, CS_ERR_CHECK,
                       "%s: only --renderer cpu may accept images, found %s", row->image,
                       cs_text_get(renderer));
    if (!strcmp(row->finding.found, row->hash) && !strcmp(row->note, cs_text_get(renderer)))
        return CS_OK;
    cs_text_add(&row->message, "accepted");
    snprintf(row->finding.renderer, sizeof row->finding.renderer, "%s", cs_text_get(renderer));
    row->note = row->finding.renderer;
    return write_image(golden, row, ".png", found, error);
}

static enum cs_status check_with(const struct cs_golden *golden, enum cs_renderer_kind kind,
                                 struct cs_session *session, struct cs_golden_row *row,
                                 struct cs_error *error) {
    struct cs_image found = {0};
    struct cs_text renderer = {0};
    if (!cs_snapshot_draw(&session->run, kind, &found, &renderer, error)) {
        cs_hash_bytes(found.rgb, cs_image_bytes(&found), row->finding.found);
        if (golden->accept_all)
            accept_image(golden, row, &found, &renderer, error);
        else
            judge(golden, row, &found, cs_text_get(&renderer), error);
    }
    free(found.rgb);
    cs_text_finish(&renderer);
    return error->status;
}

static enum cs_status check_image(struct cs_golden *golden, struct cs_golden_row *row,
                                  struct cs_error *error) {
    struct cs_session session;
    if (step_golden(golden, &row->run, true, &session, error))
        return error->status;
    remove_evidence(golden, row);
    for (int kind = 0; cs_renderer_names[kind] && !error->status; kind++)
        if (golden->renderers >> kind & 1)
            check_with(golden, (enum cs_renderer_kind)kind, &session, row, error);
    cs_session_close(&session);
    return error->status;
}

/* True if the row holds for this build. A method whose bits depend on a library has one row per
 * version. */
static bool is_for_this_build(struct cs_golden_row *row, const struct cs_integrator *method) {
    if (CS_HAS(method, library) && method->library)
        snprintf(row->finding.library, sizeof row->finding.library, "%s", method->library);
    row->finding.skipped =
        strcmp(row->note, "any") != 0 && strcmp(row->note, row->finding.library) != 0;
    if (row->finding.skipped)
        cs_text_add(&row->message, "golden for %s, but this build has %s", row->note,
                    *row->finding.library ? row->finding.library : "no such library");
    return !row->finding.skipped;
}

/* Compares one state hash with its golden value. */
static enum cs_status check_hash(struct cs_golden *golden, struct cs_golden_row *row,
                                 struct cs_error *error) {
    struct cs_session session;
    struct cs_error failed = {0};
    if (step_golden(golden, &row->run, false, &session, &failed)) {
        /* only a build without a library may lack an integrator, and only where the row names
         * the library */
        row->finding.skipped = failed.status == CS_ERR_USAGE && strcmp(row->note, "any") != 0;
        if (!row->finding.skipped)
            return cs_fail(error, failed.status, "%s", failed.message);
        cs_text_add(&row->message, "this build is without %s", row->note);
        return CS_OK;
    }
    cs_run_hash(&session.run, row->finding.found);
    if (is_for_this_build(row, session.method.integrator) &&
        strcmp(row->finding.found, row->hash)) {
        cs_text_add(&row->message, "hash %s", row->finding.found);
        if (!golden->add.scene)
            cs_text_add(&row->message, ", expected %s (%s after frame %u)", row->hash,
                        cs_outcome_text(session.run.outcome), session.run.frame);
    }
    cs_session_close(&session);
    return CS_OK;
}

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
    const char *name, *head;
    uint32_t n_fields;
    enum cs_status (*check)(struct cs_golden *golden, struct cs_golden_row *row,
                            struct cs_error *error);
};
static const struct kind hashes = {"hash.tsv",
                                   "scene\tintegrator\toverrides\tframes\thash\tbuilds",
                                   CS_GOLDEN_HASH_FIELDS, check_hash};
static const struct kind images = {
    "image.tsv", "scene\tintegrator\toverrides\tframe\timage\tpixels\trenderer",
    CS_GOLDEN_IMAGE_FIELDS, check_image};

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

/* Counts, reports and accepts a row that was checked. */
static void settle(struct cs_golden *golden, const struct cs_golden_table *table,
                   struct cs_golden_row *row) {
    row->added = golden->accept_all && row->finding.skipped && *row->finding.library &&
                 !cs_golden_table_has(table, row);
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
    rows->kind->check(rows->golden, row, error);
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

/* Checks all rows of a table that are wanted. */
static enum cs_status check_rows(struct cs_golden *golden, const struct kind *kind,
                                 struct cs_golden_table *table, struct cs_error *error) {
    struct rows rows = {.golden = golden, .kind = kind, .table = table};
    const size_t bytes = golden->jobs * sizeof *rows.answers;
    const struct cs_isolate_queue queue = {.limits = {.is_cell = true, .stop = golden->stop},
                                           .n_slots = golden->jobs,
                                           .ctx = &rows,
                                           .next = next_row,
                                           .task = answer_in_child,
                                           .ended = take_answer};
    rows.done = calloc(table->n + 1, sizeof *rows.done);
    rows.answers = cs_process_pool_shared_alloc(bytes, error);
    if (!rows.done)
        cs_fail(error, CS_ERR_MEMORY, "out of memory");
    if (!error->status)
        cs_isolate_queue_run(&queue, error);
    cs_process_pool_shared_free(rows.answers, bytes);
    free(rows.done);
    return error->status;
}

/* Checks and adds the run of --add. */
static enum cs_status add_row(struct cs_golden *golden, const struct kind *kind,
                              struct cs_golden_table *table, struct cs_error *error) {
    struct cs_golden_row *row = cs_golden_table_add(table, &golden->add);
    struct cs_error own = {0};
    kind->check(golden, row, &own);
    if (!take_failure(golden, row, &own, error))
        settle(golden, table, row);
    return error->status;
}

static enum cs_status check_table(struct cs_golden *golden, const struct kind *kind,
                                  struct cs_error *error) {
    struct cs_golden_table table = {.head = kind->head, .n_fields = kind->n_fields};
    const uint32_t before = golden->accepted;
    const bool may_lack = golden->add.scene || golden->any_table;
    cs_golden_table_read(&table, golden->folder, kind->name, may_lack, error);
    if (!error->status)
        (golden->add.scene ? add_row : check_rows)(golden, kind, &table, error);
    // a run that cannot be added leaves no folder
    if (!error->status && golden->accepted > before && !cs_folder_create(golden->folder, error))
        cs_golden_table_write(&table, error);
    cs_golden_table_close(&table);
    return error->status;
}

static bool is_there(const struct cs_golden *golden, const struct kind *kind) {
    char path[1024];
    snprintf(path, sizeof path, "%.900s/%s", golden->folder, kind->name);
    return access(path, F_OK) == 0;
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
