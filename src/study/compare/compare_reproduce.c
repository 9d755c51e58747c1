/* Reproduces a row of a comparison. */
#include "study/compare/compare.h"

#include "study/compare/cell_list_parse.h"
#include "study/provenance_write.h"
#include "study/recorded_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_BYTES = 4096 };

/* Refuses rows that no run can reproduce: over budget, refused, or without a state. */
static enum cs_status check_row(const struct cs_cell *cell, const char *file, uint32_t row,
                                struct cs_error *error) {
    const char *why = !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET))
                          ? "it exceeded its budget, which depends on the clock"
                      : !strcmp(cell->outcome, "refused") ? cell->note
                      : !*cell->state_hash ? "an earlier version wrote it without a state"
                                           : NULL;
    return why ? cs_fail(error, CS_ERR_USAGE, "%s: row %u cannot be reproduced: %s", file, row,
                         why)
               : CS_OK;
}

static enum cs_status read_row(const char *file, uint32_t row, struct cs_cell *cell,
                               struct cs_error *error) {
    struct cs_cell *cells;
    uint32_t n;
    if (cs_csv_read(file, &cells, &n, error))
        return error->status;
    if (row >= 1 && row <= n)
        *cell = cells[row - 1];
    free(cells);
    if (row < 1 || row > n)
        return cs_fail(error, CS_ERR_USAGE, "%s: found row %u, expected 1 to %u", file, row, n);
    return check_row(cell, file, row, error);
}

/* Reads origin.json beside the file: scene and number of frames. */
static enum cs_status read_origin(struct cs_provenance *provenance, const char *file,
                                  char path[PATH_BYTES],
                                  struct cs_recorded_run_settings *settings,
                                  struct cs_error *error) {
    const char *slash = strrchr(file, '/');
    snprintf(path, PATH_BYTES, "%.*sorigin.json", slash ? (int)(slash + 1 - file) : 0, file);
    if (cs_provenance_read(provenance, path, error))
        return error->status;
    const double frames = cs_provenance_number(provenance->json, "frames");
    settings->frames = frames >= 1 && frames <= 1e6 ? (uint32_t)frames : 0;
    return settings->frames
               ? CS_OK
               : cs_fail(error, CS_ERR_FILE, "%s: expected \"frames\", from 1 on", path);
}

/* Notes what has changed since: version, module, files of the scene. */
static void describe_row(const struct cs_provenance *provenance, struct cs_session *session,
                         const struct cs_cell *cell, struct cs_text *out) {
    struct cs_provenance_out_module module;
    cs_provenance_out_find_module(session, &module);
    cs_provenance_add_change("the version of clothsim", cell->version, CS_VERSION, out);
    if (strcmp(cell->module, module.hash) != 0)
        cs_text_add(out, "the module %s is a different build\n", module.file);
    cs_provenance_add_changed_files(provenance, out);
}

/* Exact comparison; only the first difference is reported. */
static void compare_numbers(struct cs_reproduction *again, const char *what, double then,
                            double now) {
    if (!again->first_difference.length && then != now)
        cs_text_add(&again->first_difference, "%s was %.17g, is %.17g", what, then, now);
}

static void compare_texts(struct cs_reproduction *again, const char *what, const char *then,
                          const char *now) {
    if (!again->first_difference.length && strcmp(then, now) != 0)
        cs_text_add(&again->first_difference, "%s was %s, is %s", what, then, now);
}

/* Compares in the order outcome, time, steps, state: the first difference says most. */
static void compare_ends(struct cs_reproduction *again, const struct cs_cell *cell,
                         const struct cs_recorded_run_result *end) {
    compare_texts(again, "the outcome", cell->outcome, cs_outcome_text(end->result.outcome));
    compare_numbers(again, "the time", cell->time, end->result.time);
    compare_numbers(again, "the number of steps", cell->steps, (double)end->counts.steps);
    compare_texts(again, "the state at the end", cell->state_hash, end->hash);
    if (!again->first_difference.length)
        cs_text_add(&again->equal_items, "outcome, time, steps and the state at the end");
}

static enum cs_status run(struct cs_reproduction *again,
                          const struct cs_recorded_run_settings *settings,
                          const struct cs_provenance *provenance, const struct cs_cell *cell,
                          struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_recorded_run recording = {0};
    struct cs_recorded_run_result end;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    cs_text_add(&again->description, "%u frames of %s by %s", settings->frames,
                provenance->scene_file, integrator);
    if (!cs_recorded_run_open(&recording, settings, integrator, error)) {
        describe_row(provenance, &recording.session, cell, &again->notes);
        if (!cs_recorded_run_execute(&recording, 0, NULL, &end, error))
            compare_ends(again, cell, &end);
    }
    cs_recorded_run_close(&recording);
    return error->status;
}

enum cs_status cs_compare_reproduce_row(struct cs_reproduction *again,
                                        const struct cs_reproduction_settings *settings,
                                        uint32_t row, struct cs_error *error) {
    struct cs_recorded_run_settings asked = {.session = settings->session};
    struct cs_provenance provenance = {0};
    struct cs_cell cell;
    char path[PATH_BYTES];
    if (!read_row(settings->file, row, &cell, error) &&
        !read_origin(&provenance, settings->file, path, &asked, error) &&
        !cs_provenance_to_session(&provenance, settings->folder, &asked.session, error))
        run(again, &asked, &provenance, &cell, error);
    cs_provenance_finish(&provenance);
    return error->status;
}
