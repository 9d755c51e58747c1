/* Reproduces a row of a comparison. */
#include "reproduce/compare_reproduce.h"

#include "session/provenance_write.h"
#include "session/recorded_run.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare.h"

#include <libgen.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_BYTES = 4096 };

/* Refuses rows that no run can reproduce: over budget, refused, or without a state. */
static enum cs_status check_row(const struct cs_cell *cell, const char *file, uint32_t row,
                                struct cs_error *error) {
    const char *why = !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET))
                          ? "it exceeded its budget and has no end to compare"
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
    if (cs_csv_read(file, true, &cells, &n, error))
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
static enum cs_status describe_row(const struct cs_provenance *provenance,
                                   struct cs_session *session, const struct cs_cell *cell,
                                   struct cs_text *out, struct cs_error *error) {
    struct cs_provenance_out_module module;
    if (cs_provenance_out_find_module(session, &module, error))
        return error->status;
    cs_provenance_add_change("the version of clothsim", cell->version, CS_VERSION, out);
    if (strcmp(cell->module, module.hash) != 0)
        cs_text_add(out, "the module %s is a different build\n", module.file);
    cs_provenance_add_changed_files(provenance, out);
    return CS_OK;
}

/* Exact comparison, where none equals none; only the first difference is reported. */
static void compare_numbers(struct cs_reproduction *reproduction, const char *what, double then,
                            double now) {
    if (!reproduction->first_difference.length && then != now && !(isnan(then) && isnan(now)))
        cs_text_add(&reproduction->first_difference, "%s was %.17g, is %.17g", what, then, now);
}

static void compare_texts(struct cs_reproduction *reproduction, const char *what,
                          const char *then, const char *now) {
    if (!reproduction->first_difference.length && strcmp(then, now) != 0)
        cs_text_add(&reproduction->first_difference, "%s was %s, is %s", what, then, now);
}

/* Compares in the order outcome, time, steps, state: the first difference says most. */
static void compare_ends(struct cs_reproduction *reproduction, const struct cs_cell *then,
                         const struct cs_cell *now, bool errors) {
    static const char *const names[] = {"error",          "max_error",      "path_error",
                                        "max_path_error", "velocity_error", "energy_error",
                                        "centre_error",   "box_error",      "bar"};
    compare_texts(reproduction, "the outcome", then->outcome, now->outcome);
    compare_numbers(reproduction, "the time", then->time, now->time);
    compare_numbers(reproduction, "the number of steps", then->steps, now->steps);
    compare_texts(reproduction, "the state at the end", then->state_hash, now->state_hash);
    for (size_t k = 0; k < sizeof names / sizeof *names && errors; k++) {
        const struct cs_column *column = cs_column_find(names[k]);
        compare_numbers(reproduction, names[k], cs_cell_number(then, column),
                        cs_cell_number(now, column));
    }
    if (!reproduction->first_difference.length)
        cs_text_add(&reproduction->equal_items, "outcome, time, steps%s the state at the end%s",
                    errors ? "," : " and", errors ? " and the errors" : "");
}

/* Gets the reference of the comparison, from beside the file or computed. Another one than that
 * of the row is noted, and *same is false. */
static enum cs_status get_reference(struct cs_compare *compare, const struct cs_cell *cell,
                                    struct cs_reproduction *reproduction, bool *same,
                                    struct cs_error *error) {
    const struct cs_compare_reference_settings asked =
        cs_compare_reference_query(compare->settings);
    char key[CS_HASH_DIGITS];
    if (cs_compare_reference_plan(&compare->reference, &asked, key, error))
        return error->status;
    *same = !strncmp(key, cell->key, CS_COMPARE_DIGITS);
    if (*same)
        return cs_compare_reference_get(&compare->reference, &asked, error);
    cs_text_add(
        &reproduction->notes,
        "the reference: it is of another version or scene, and errors are not compared\n");
    return CS_OK;
}

static enum cs_status run(struct cs_reproduction *reproduction,
                          const struct cs_compare_settings *settings,
                          const struct cs_provenance *provenance, const struct cs_cell *cell,
                          struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_recorded_run recording = {0};
    struct cs_compare compare = {.settings = settings};
    struct cs_cell now = *cell;
    bool errors = false;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    cs_text_add(&reproduction->description, "%u frames of %s by %s", settings->run.frames,
                provenance->scene_file, integrator);
    if (!cs_recorded_run_open(&recording, &settings->run, integrator, error))
        describe_row(provenance, &recording.session, cell, &reproduction->notes, error);
    cs_recorded_run_close(&recording);
    if (!error->status && !isnan(cell->bar))
        get_reference(&compare, cell, reproduction, &errors, error);
    if (!error->status && !cs_compare_measure(&compare, &now, error))
        compare_ends(reproduction, cell, &now, errors);
    cs_compare_reference_finish(&compare.reference);
    return error->status;
}

/* Reads what the reference is chosen by; without methods it was the program's choice. */
static void read_reference(const struct cs_provenance *provenance,
                           struct cs_compare_settings *settings) {
    const struct cs_json *pair = cs_json_find_kind(provenance->json, "reference", CS_JSON_LIST);
    for (uint32_t k = 0; k < 2 && cs_json_count(pair) == 2; k++)
        if (cs_json_kind_of(cs_json_at(pair, k)) == CS_JSON_TEXT)
            settings->reference[k] = cs_json_text(cs_json_at(pair, k));
    settings->accuracy = cs_provenance_number(provenance->json, "accuracy");
    settings->reference_budget = cs_provenance_number(provenance->json, "reference_budget");
}

enum cs_status cs_compare_reproduce_row(struct cs_reproduction *reproduction,
                                        const struct cs_reproduction_settings *settings,
                                        uint32_t row, struct cs_error *error) {
    struct cs_compare_settings asked = {.run.session = settings->session};
    struct cs_provenance provenance = {0};
    struct cs_cell cell;
    char path[PATH_BYTES];
    if (!read_row(settings->file, row, &cell, error) &&
        !read_origin(&provenance, settings->file, path, &asked.run, error) &&
        !cs_provenance_to_session(&provenance, settings->folder, &asked.run.session, error)) {
        read_reference(&provenance, &asked);
        asked.cache = dirname(path);
        run(reproduction, &asked, &provenance, &cell, error);
    }
    cs_provenance_finish(&provenance);
    return error->status;
}
