/* stability_border.c - one cell, and the border between stable and unstable ones. */
#include "study/stability.h"

#include <math.h>

enum { MOST_SEARCHES = 12, BISECTIONS = 14 };
#define RESOLUTION 1.01 /* of the border: unstable step / stable step */
#define LONGEST_DT 10

enum cs_status cs_stability_try(const struct cs_trial_settings *settings,
                                const struct cs_reference *reference, double dt,
                                struct cs_stability_cell *cell, struct cs_error *error) {
    struct cs_trial_settings asked = *settings;
    struct cs_trial trial;
    asked.dt = dt;
    asked.seconds = fmin(reference->seconds, CS_CELL_STEPS * dt);
    asked.limits = cs_fate_limits(&reference->trial);
    if (cs_trial_run(&trial, &asked, error))
        return error->status;
    *cell = (struct cs_stability_cell){
        .dt = dt,
        .verdict = cs_fate_of(&trial, &reference->trial, asked.seconds >= reference->seconds),
        .drift = (double)NAN,
        .time = trial.end,
        .particles = trial.excess.particles,
    };
    if (trial.outcome == CS_RUNNING && !trial.failed && asked.seconds >= reference->seconds)
        cell->drift = cs_fate_drift(&trial, &reference->trial);
    if (trial.outcome == CS_UNBOUNDED || trial.outcome == CS_NOT_FINITE)
        cell->time = trial.blow_up.time;
    if (cell->verdict == CS_FATE_GLOBAL && trial.beyond)
        cell->time = trial.beyond_time;
    else if (cell->verdict == CS_FATE_LOCAL)
        cell->time = trial.excess.time;
    return CS_OK;
}

/* steps by a factor of 4 until both sides are known; a budget that runs out ends the search */
static enum cs_status enclose(const struct cs_trial_settings *settings,
                              const struct cs_reference *reference, double *stable,
                              double *unstable, struct cs_error *error) {
    struct cs_stability_cell cell;
    for (int k = 0; k < MOST_SEARCHES && (*stable <= 0 || *unstable > LONGEST_DT); k++) {
        const double dt = *stable > 0 ? 4 * *stable : *unstable / 4;
        if (!(dt <= LONGEST_DT))
            break;
        if (cs_stability_try(settings, reference, dt, &cell, error))
            return error->status;
        if (cell.verdict == CS_FATE_OVER_BUDGET)
            break;
        *(cs_fate_is_stable(cell.verdict) ? stable : unstable) = dt;
    }
    return CS_OK;
}

enum cs_status cs_stability_border(const struct cs_trial_settings *settings,
                                   const struct cs_reference *reference, double stable,
                                   double unstable, double *border, struct cs_error *error) {
    struct cs_stability_cell cell;
    if (enclose(settings, reference, &stable, &unstable, error))
        return error->status;
    *border = stable <= 0 ? 0 : HUGE_VAL;
    if (stable <= 0 || unstable > LONGEST_DT)
        return CS_OK;
    for (int k = 0; k < BISECTIONS && unstable > RESOLUTION * stable; k++) {
        const double dt = sqrt(stable * unstable);
        if (cs_stability_try(settings, reference, dt, &cell, error))
            return error->status;
        *(cs_fate_is_stable(cell.verdict) ? &stable : &unstable) = dt;
    }
    *border = sqrt(stable * unstable);
    return CS_OK;
}
