/* Measures one cell by a recorded run, and finds observed orders, the slopes of error against
 * step. */
#include "study/compare/compare_measure.h"

#include "study/origin.h"
#include "study/reference/compare_reference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Steps that contact or a method itself cuts hardly depend on dt: below that ratio of mean
 * steps, where dt is halved, there is no slope. */
#define SHORTER 1.7

/* Two successive slopes within that are steady. */
#define STEADY 0.1

static void take_counts(struct cs_cell *cell, const struct cs_course_end *end) {
    const struct cs_counts *counts = &end->counts;
    cell->steps = (double)counts->steps;
    cell->evals = (double)counts->forces;
    cell->jvps = (double)counts->jvps;
    cell->solves = (double)counts->solves;
    cell->iterations = (double)counts->solve_iterations;
    cell->setups = (double)counts->solve_setups;
    cell->clamped = (double)counts->clamped;
    cell->rejected = (double)counts->method.rejected;
    cell->newton = (double)counts->method.newton;
    cell->work = cell->evals + cell->jvps + cell->iterations;
    cs_machine_name(cell->machine);
    snprintf(cell->version, sizeof cell->version, "%s", CS_VERSION);
    memcpy(cell->state_hash, end->hash, sizeof cell->state_hash);
    cell->cpu = cell->cpu_low = cell->cpu_high = end->cpu;
    cell->wall = end->wall;
    cell->runs = 1;
    cell->outliers = 0;
    cell->crossings = end->crossings.counted ? (double)end->crossings.most : (double)NAN;
    cell->time = end->result.time;
    cell->step = end->result.outcome == CS_RUNNING ? cell->time / cell->steps : (double)NAN;
    snprintf(cell->outcome, sizeof cell->outcome, "%s", cs_outcome_text(end->result.outcome));
    snprintf(cell->note, sizeof cell->note, "%s", end->note);
}

static void take_errors(const struct cs_compare *compare, const struct cs_course *course,
                        const struct cs_track *track, struct cs_cell *cell) {
    const struct cs_compare_reference *reference = &compare->reference;
    struct cs_deviation deviation;
    if (!reference->agree)
        return;
    cs_deviation_take(&deviation, &course->session.system, track, &reference->track,
                      track->frames, cs_compare_reference_pointwise_frames(reference));
    cell->bar = reference->bar;
    cell->error = deviation.end;
    cell->max_error = deviation.end_max;
    cell->path_error = deviation.path;
    cell->max_path_error = deviation.path_max;
    cell->velocity_error = deviation.velocity;
    cell->energy_error = deviation.energy / reference->kinetic;
    cell->centre_error = deviation.centre;
    cell->box_error = deviation.box;
    cell->strain = deviation.strain;
    cell->achieved =
        cell->adaptive ? cell->error / (cell->value * reference->scale) : (double)NAN;
}

/* Where its energy went, in a run that is not timed. */
static enum cs_status take_ledger(struct cs_course *course, struct cs_cell *cell,
                                  struct cs_error *error) {
    struct cs_system *system = &course->session.system;
    struct cs_account account = {0};
    struct cs_course_end end;
    memcpy(system->state, course->start, 6 * (size_t)system->view.n * sizeof *course->start);
    if (!cs_account_open(&account, system, 0, error)) {
        course->session.settings.run.account = &account;
        if (!cs_course_run(course, 0, NULL, &end, error))
            memcpy(cell->ledger, account.work, sizeof cell->ledger);
        course->session.settings.run.account = NULL;
    }
    cs_account_close(&account);
    return error->status;
}

static void take_module(struct cs_session *session, struct cs_cell *cell) {
    struct cs_origin_module module;
    cs_origin_find_module(session, &module);
    memcpy(cell->module, module.hash, sizeof cell->module);
}

enum cs_status cs_compare_measure(const struct cs_compare *compare, struct cs_cell *cell,
                                  struct cs_error *error) {
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_course course = {0};
    struct cs_track track = {0};
    struct cs_course_end end;
    cs_cell_integrator(cell, integrator, sizeof integrator);
    if (!cs_course_open(&course, &compare->settings->course, integrator, error) &&
        !cs_track_init(&track, &course, error) &&
        !cs_course_run(&course, compare->budget, &track, &end, error)) {
        take_counts(cell, &end);
        take_module(&course.session, cell);
        if (cs_cell_is_finished(cell)) {
            take_errors(compare, &course, &track, cell);
            if (compare->settings->ledger)
                take_ledger(&course, cell, error);
        }
    }
    cs_track_finish(&track);
    cs_course_close(&course);
    return error->status;
}

static bool is_usable(const struct cs_cell *cell, double bar, double scale) {
    // near the bar the reference's own error is measured, near the motion everything is lost
    return cs_cell_is_finished(cell) && cell->error > 10 * bar && cell->error < 0.1 * scale;
}

/* NAN where there is none */
static double slope(const struct cs_cell *a, const struct cs_cell *b, double bar,
                    double scale) {
    if (a->adaptive || b->adaptive || !cs_cell_same_series(a, b) || !is_usable(a, bar, scale) ||
        !is_usable(b, bar, scale) || !(SHORTER * b->step < a->step))
        return (double)NAN;
    return log(a->error / b->error) / log(a->step / b->step);
}

void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale) {
    for (uint32_t k = 0; k < n; k++) {
        const double here = k > 0 ? slope(cells + k - 1, cells + k, bar, scale) : (double)NAN;
        const double before =
            k > 1 ? slope(cells + k - 2, cells + k - 1, bar, scale) : (double)NAN;
        const double after =
            k + 1 < n ? slope(cells + k, cells + k + 1, bar, scale) : (double)NAN;
        const bool steady = fabs(here - before) < STEADY || fabs(here - after) < STEADY;
        cells[k].order = steady ? here : (double)NAN;
    }
}
