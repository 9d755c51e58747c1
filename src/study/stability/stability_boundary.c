/* Judges a step against the reference, and bisects the border of stable steps. */
#include "study/stability/stability_state.h"

#include <math.h>

/* Searches by a factor of 4 cover 4^12 = 1.7e7. A bracket of a factor 4 needs log2(ln 4 / ln
 * 1.01) = 7.1 halvings of its logarithm; 14 allow for wider rows of a map. */
enum { MOST_SEARCHES = 12, BISECTIONS = 14 };
#define RESOLUTION 1.01 /* of the border: unstable step / stable step */
/* s; a step that is longer says nothing about cloth */
#define LONGEST_DT 10

/* Runs and judges one step, over the time of the reference but at most most_seconds (s). */
static enum cs_status try_step(const struct cs_sampled_run_settings *settings,
                               const struct cs_reference *reference, double dt,
                               double most_seconds, struct cs_stability_cell *cell,
                               struct cs_error *error) {
    struct cs_sampled_run_settings asked = *settings;
    struct cs_sampled_run trial;
    asked.session.dt = dt;
    asked.seconds = fmin(reference->seconds, most_seconds);
    if (cs_sampled_run_execute(&trial, &asked, error))
        return error->status;
    *cell = (struct cs_stability_cell){
        .dt = dt,
        .verdict =
            cs_stability_judge(&trial, &reference->run, asked.seconds >= reference->seconds),
        .drift = (double)NAN,
        .time = trial.result.time,
        .particles = trial.monitor.first.particles,
        .crossings =
            trial.crossings.is_counted ? (double)trial.crossings.max_count : (double)NAN,
    };
    /* drift compares the energies at the end, which both runs must have reached */
    if (trial.result.outcome == CS_RUNNING && asked.seconds >= reference->seconds)
        cell->drift = cs_stability_drift(&trial, &reference->run);
    /* the reported time is that of the first sign, not that of the end */
    if (trial.monitor.worst_verdict != CS_STABILITY_BOUNDED)
        cell->time = trial.monitor.first.t;
    return CS_OK;
}

enum cs_status cs_stability_run_cell(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double dt,
                                     struct cs_stability_cell *cell, struct cs_error *error) {
    return try_step(settings, reference, dt, CS_CELL_STEPS * dt, cell, error);
}

/* Multiplies or divides the step by 4 until a stable and an unstable step are known. *known
 * becomes false if the budget of a run ended: nothing is then known of the step. */
static enum cs_status bracket(const struct cs_sampled_run_settings *settings,
                              const struct cs_reference *reference, double *stable,
                              double *unstable, bool *known, struct cs_error *error) {
    struct cs_stability_cell cell;
    for (int k = 0; k < MOST_SEARCHES && (*stable <= 0 || *unstable > LONGEST_DT); k++) {
        const double dt = *stable > 0 ? 4 * *stable : *unstable / 4;
        if (!(dt <= LONGEST_DT))
            break;
        if (try_step(settings, reference, dt, HUGE_VAL, &cell, error))
            return error->status;
        *known = cell.verdict != CS_STABILITY_OVER_BUDGET;
        if (!*known)
            break;
        *(cs_stability_is_stable(cell.verdict) ? stable : unstable) = dt;
    }
    return CS_OK;
}

enum cs_status cs_stability_boundary(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double stable,
                                     double unstable, double *border, struct cs_error *error) {
    struct cs_stability_cell cell;
    bool known = true;
    *border = (double)NAN;
    if (bracket(settings, reference, &stable, &unstable, &known, error) || !known)
        return error->status;
    /* no stable step was found, or no unstable one */
    *border = stable <= 0 ? 0 : HUGE_VAL;
    if (stable <= 0 || unstable > LONGEST_DT)
        return CS_OK;
    for (int k = 0; k < BISECTIONS && unstable > RESOLUTION * stable; k++) {
        /* the geometric mean, since steps cover decades */
        const double dt = sqrt(stable * unstable);
        if (try_step(settings, reference, dt, HUGE_VAL, &cell, error))
            return error->status;
        if (cell.verdict == CS_STABILITY_OVER_BUDGET) {
            *border = (double)NAN;
            return CS_OK;
        }
        *(cs_stability_is_stable(cell.verdict) ? &stable : &unstable) = dt;
    }
    *border = sqrt(stable * unstable);
    return CS_OK;
}
