/* Measures one cell by a recorded run, and finds observed orders: slopes of log error against
 * log mean step. */

#include "study/compare/compare_state.h"

#include "session/provenance_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Smallest ratio of successive mean steps that counts as a halving. Steps that contact or the
 * method cuts hardly depend on dt: a slope would divide by nearly 0. */
#define SHORTER 1.7

/* Largest difference of two successive slopes that counts as steady. */
#define STEADY 0.1

/* Counts, costs and outcome of a run. */
static void take_counts(struct cs_cell *cell, const struct cs_recorded_run_result *result) {
    const struct cs_counts *counts = &result->counts;
    cell->steps = (double)counts->steps;
    cell->evals = (double)counts->forces;
    cell->jvps = (double)counts->jvps;
    cell->solves = (double)counts->solves;
    cell->iterations = (double)counts->solve_iterations;
    cell->setups = (double)counts->solve_setups;
    cell->clamped = (double)counts->clamped_setups;
    cell->rejected = (double)counts->method.rejected;
    cell->newton = (double)counts->method.newton;
    cell->sweeps = (double)counts->method.sweeps;
    cell->work = cs_counts_work(counts);
    cs_machine_name(cell->machine);
    snprintf(cell->version, sizeof cell->version, "%s", CS_VERSION);
    memcpy(cell->state_hash, result->hash, sizeof cell->state_hash);
    cell->cpu = cell->cpu_low = cell->cpu_high = result->cpu;
    cell->wall = result->wall;
    cell->runs = 1;
    cell->outliers = 0;
    cell->crossings =
        result->crossings.is_counted ? (double)result->crossings.max_count : (double)NAN;
    cell->time = result->result.time;
    cell->step = result->result.outcome == CS_RUNNING ? cell->time / cell->steps : (double)NAN;
    snprintf(cell->outcome, sizeof cell->outcome, "%s",
             cs_outcome_text(result->result.outcome));
    snprintf(cell->note, sizeof cell->note, "%s", result->note);
}

/* Errors against the reference. achieved: the error over what the tolerance asks for, rtol
 * times the motion. */
static void take_errors(const struct cs_compare *compare,
                        const struct cs_recorded_run *recording,
                        const struct cs_trajectory *trajectory, struct cs_cell *cell) {
    const struct cs_compare_reference *reference = &compare->reference;
    struct cs_trajectory_error error;
    if (!reference->families_agree)
        return;
    cs_trajectory_error_compute(&error, &recording->session.system, trajectory,
                                &reference->trajectory, trajectory->frames,
                                cs_compare_reference_pointwise_frames(reference));
    cell->bar = reference->error_bar;
    cell->error = error.end;
    cell->max_error = error.end_max;
    cell->path_error = error.path;
    cell->max_path_error = error.path_max;
    cell->velocity_error = error.velocity;
    cell->energy_error = error.energy / reference->kinetic;
    cell->centre_error = error.centre;
    cell->box_error = error.box;
    cell->strain = error.strain;
    cell->achieved =
        cell->adaptive ? cell->error / (cell->value * reference->motion_scale) : (double)NAN;
}

/* An instability that the monitor saw goes before the notes. */
static void take_verdict(const struct cs_recorded_run *recording,
                         const struct cs_energy_monitor *monitor, struct cs_cell *cell) {
    struct cs_text text = {0};
    cs_energy_monitor_print(monitor, &recording->session.system, &text);
    if (text.length) {
        cs_text_add(&text, "%s%s", *cell->note ? "; " : "", cell->note);
        snprintf(cell->note, sizeof cell->note, "%s", cs_text_get(&text));
    }
    cs_text_finish(&text);
}

/* Runs the cell again from its initial state with an energy ledger. This run is not timed. */
static enum cs_status take_ledger(struct cs_recorded_run *recording, struct cs_cell *cell,
                                  struct cs_error *error) {
    struct cs_system *system = &recording->session.system;
    struct cs_energy_ledger account = {0};
    struct cs_recorded_run_result result;
    memcpy(system->state, recording->initial_state,
           6 * (size_t)system->view.n * sizeof *recording->initial_state);
    if (!cs_energy_ledger_open(&account, system, 0, error)) {
        recording->session.settings.run.ledger = &account;
        if (!cs_recorded_run_execute(recording, 0, NULL, &result, error))
            memcpy(cell->ledger, account.work, sizeof cell->ledger);
        recording->session.settings.run.ledger = NULL;
    }
    cs_energy_ledger_close(&account);
    return error->status;
}

/* Hash of the module's file: a rebuilt module makes a different row. */
static enum cs_status take_module(struct cs_session *session, struct cs_cell *cell,
                                  struct cs_error *error) {
    struct cs_provenance_out_module module;
    if (!cs_provenance_out_find_module(session, &module, error))
        memcpy(cell->module, module.hash, sizeof cell->module);
    return error->status;
}

enum cs_status cs_compare_measure(const struct cs_compare *compare, struct cs_cell *cell,
                                  struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_recorded_run recording = {0};
    struct cs_trajectory trajectory = {0};
    struct cs_recorded_run_result result;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    if (!cs_recorded_run_open(&recording, &compare->settings->run, integrator, error) &&
        !cs_trajectory_init(&trajectory, &recording, error) &&
        !cs_recorded_run_execute(&recording, compare->budget, &trajectory, &result, error)) {
        take_counts(cell, &result);
        if (!take_module(&recording.session, cell, error) && cs_cell_is_finished(cell)) {
            take_verdict(&recording, &result.monitor, cell);
            take_errors(compare, &recording, &trajectory, cell);
            if (compare->settings->ledger)
                take_ledger(&recording, cell, error);
        }
    }
    cs_trajectory_finish(&trajectory);
    cs_recorded_run_close(&recording);
    return error->status;
}

/* An error between 10 bars and a tenth of the motion. Nearer to the bar the reference's own
 * error is measured; nearer to the motion the run has lost it. */
static bool is_usable(const struct cs_cell *cell, double bar, double scale) {
    // near the bar the reference's own error is measured, near the motion everything is lost
    return cs_cell_is_finished(cell) && cell->error > 10 * bar && cell->error < 0.1 * scale;
}

/* d log(error) / d log(step) between two cells of one series; NAN if one is not usable. */
static double slope(const struct cs_cell *a, const struct cs_cell *b, double bar,
                    double scale) {
    if (a->adaptive || b->adaptive || !cs_cell_same_series(a, b) || !is_usable(a, bar, scale) ||
        !is_usable(b, bar, scale) || !(SHORTER * b->step < a->step))
        return (double)NAN;
    return log(a->error / b->error) / log(a->step / b->step);
}

/* A slope needs a neighbour that agrees: a single one can have any value where errors of two
 * orders cancel. Only cells of the sweep have orders: others lie too close together. */
void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale) {
    struct cs_cell *last = NULL; // of the sweep
    double before = (double)NAN;
    for (uint32_t k = 0; k < n; k++) {
        struct cs_cell *cell = cells + k;
        cell->order = (double)NAN;
        if (isfinite(cell->target))
            continue;
        const double here = last ? slope(last, cell, bar, scale) : (double)NAN;
        if (fabs(here - before) < STEADY) {
            cell->order = here;
            last->order = before;
        }
        before = here;
        last = cell;
    }
}

/* Describes the error norms of a comparison in one table. */

const char *const cs_norm_names[] = {"error", "path", "largest", "velocity", "energy", NULL};

/* One row per norm: text, unit, column, and whether it is a pointwise error. */
static const struct norm {
    const char *words, *unit;
    size_t offset; /* of the column */
    bool of_particles;
} norms[CS_NORMS] = {
    [CS_NORM_END] = {"error", "m", offsetof(struct cs_cell, error), true},
    [CS_NORM_PATH] = {"path error", "m", offsetof(struct cs_cell, path_error), true},
    [CS_NORM_LARGEST] = {"largest error", "m", offsetof(struct cs_cell, max_error), true},
    [CS_NORM_VELOCITY] = {"velocity error", "m/s", offsetof(struct cs_cell, velocity_error),
                          true},
    [CS_NORM_ENERGY] = {"energy error", "", offsetof(struct cs_cell, energy_error), false},
};

const char *cs_norm_words(enum cs_norm norm) {
    return norms[norm].words;
}

const char *cs_norm_unit(enum cs_norm norm) {
    return norms[norm].unit;
}

const struct cs_column *cs_norm_column(enum cs_norm norm) {
    const struct cs_column *column = cs_columns;
    while (column->offset != norms[norm].offset)
        column++;
    return column;
}

bool cs_norm_is_known(enum cs_norm norm, const struct cs_compare_reference *reference) {
    return norms[norm].of_particles ? reference->pointwise : reference->families_agree;
}

double cs_norm_of(enum cs_norm norm, const struct cs_cell *cell,
                  const struct cs_compare_reference *reference) {
    return cs_norm_bounded(norm, cs_cell_number(cell, cs_norm_column(norm)), reference);
}

double cs_norm_bounded(enum cs_norm norm, double error,
                       const struct cs_compare_reference *reference) {
    // the reference's own error is known for positions
    if (norm > CS_NORM_LARGEST || isnan(error))
        return error;
    return fmax(error,
                norm == CS_NORM_LARGEST ? reference->error_bar_max : reference->error_bar);
}

double cs_norm_scale(enum cs_norm norm, const struct cs_compare_reference *reference) {
    return norm <= CS_NORM_LARGEST  ? reference->motion_scale
           : norm == CS_NORM_ENERGY ? 1
                                    : HUGE_VAL;
}
