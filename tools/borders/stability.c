/* Makes a stability map. Its columns are distributed over worker processes, which write their
 * results to shared memory. A step is judged against the reference, and the border of stable
 * steps is bisected. */
#include "borders/stability.h"

#include "base/clock.h"
#include "borders/stability_state.h"
#include "session/process_pool.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>

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
    struct cs_sampled_run sample;
    asked.session.dt = dt;
    asked.seconds = fmin(reference->seconds, most_seconds);
    if (cs_sampled_run_execute(&sample, &asked, error))
        return error->status;
    *cell = (struct cs_stability_cell){
        .dt = dt,
        .verdict =
            cs_stability_judge(&sample, &reference->run, asked.seconds >= reference->seconds),
        .drift = (double)NAN,
        .time = sample.result.time,
        .particles = sample.monitor.first.particles,
        .crossings =
            sample.crossings.is_counted ? (double)sample.crossings.max_count : (double)NAN,
    };
    /* drift compares the energies at the end, which both runs must have reached */
    if (sample.result.outcome == CS_RUNNING && asked.seconds >= reference->seconds)
        cell->drift = cs_stability_drift(&sample, &reference->run);
    /* the reported time is that of the first sign, not that of the end */
    if (sample.monitor.first.verdict != CS_STABILITY_BOUNDED)
        cell->time = sample.monitor.first.t;
    return CS_OK;
}

/* Runs one cell with the step dt in s and judges it by a reference, over the time of the
 * reference or CS_CELL_STEPS steps, whichever is shorter. A blow-up or a failed method is a
 * verdict. Errors: those of cs_sampled_run_execute; *cell is then undefined. */
static enum cs_status run_map_cell(const struct cs_sampled_run_settings *settings,
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

/* Samples of the state per run; and runs that a bisected border counts as in the progress. */
enum { SAMPLES = 32, TRIALS_OF_BORDER = 7 };
/* Largest displacement at the start, in lengths of the shortest spring: the seed from which an
 * instability grows. */
#define PERTURBATION 1e-4

/* A map in the making. */
struct work {
    struct cs_stability *stability;
    struct cs_process_pool pool;
};

/* Bisects between the highest row that is stable with all rows below and the next one. A row
 * that was too short to judge does not count as stable, so its step is no lower bracket. */
static enum cs_status find_border(struct cs_stability_column *column, uint32_t n_rows,
                                  const struct cs_sampled_run_settings *settings,
                                  struct cs_error *error) {
    uint32_t row = 0;
    while (row < n_rows && cs_stability_is_sound(column->cells[row].verdict))
        row++;
    column->boundary = HUGE_VAL;
    if (row == n_rows)
        return CS_OK;
    /* a row that ran out of time says nothing, nor does one that was not judged */
    if (column->cells[row].verdict >= CS_STABILITY_OVER_BUDGET) {
        column->boundary = (double)NAN;
        return CS_OK;
    }
    const bool known = row && cs_stability_is_stable(column->cells[row - 1].verdict);
    return cs_stability_boundary(settings, &column->reference,
                                 known ? column->cells[row - 1].dt : 0, column->cells[row].dt,
                                 &column->boundary, error);
}

/* All cells of a column are judged by its reference, so the reference may take their total
 * budget. */
static enum cs_status find_reference(const struct cs_stability *stability,
                                     const struct cs_sampled_run_settings *settings,
                                     struct cs_stability_column *column,
                                     struct cs_error *error) {
    struct cs_sampled_run_settings patient = *settings;
    patient.session.run.budget *= stability->n_rows;
    if (cs_reference_run(&column->reference, &patient, error))
        return error->status;
    if (!column->reference.exists)
        column->reference.smallest_limit.dt = (double)NAN;
    return CS_OK;
}

/* Runs one cell, or marks it as not judged if the column has no reference. */
static enum cs_status try_cell(const struct cs_sampled_run_settings *settings,
                               const struct cs_stability_column *column, double dt,
                               struct cs_stability_cell *cell, struct cs_error *error) {
    if (column->reference.exists)
        return run_map_cell(settings, &column->reference, dt, cell, error);
    *cell = (struct cs_stability_cell){.dt = dt,
                                       .verdict = CS_STABILITY_UNJUDGED,
                                       .drift = (double)NAN,
                                       .crossings = (double)NAN};
    return CS_OK;
}

/* Work of one task: reference, cells by rising dt, border. Results that the journal had are
 * kept. Each result is journalled at once, so an interrupted map loses one run at most. */
static enum cs_status make_column(struct work *work, struct cs_stability_column *column,
                                  struct cs_arena *arena, struct cs_error *error) {
    const struct cs_stability *stability = work->stability;
    struct cs_sampled_run_settings settings = {.session = stability->settings->session,
                                               .seconds = stability->settings->seconds,
                                               .samples = SAMPLES};
    settings.session.perturbation =
        PERTURBATION * cs_diagnostics_shortest(&stability->session.system);
    settings.session.run.budget = stability->settings->budget;
    /* springs get shorter as columns are added: the perturbation keeps its ratio to them */
    if (stability->settings->axis == CS_AXIS_RESOLUTION && column->value > 0)
        settings.session.perturbation *= stability->scene_value / column->value;
    const uint32_t number = (uint32_t)(column - stability->columns);
    if (cs_axis_overrides(&stability->session.system, stability->settings->axis, column->value,
                          arena, &settings.session, error))
        return error->status;
    if (!column->has_reference && (find_reference(stability, &settings, column, error) ||
                                   cs_journal_append_reference(stability, number, error)))
        return error->status;
    for (uint32_t r = 0; r < stability->n_rows; r++) {
        if (!(column->cells[r].dt > 0) &&
            (try_cell(&settings, column, stability->dt[r], column->cells + r, error) ||
             cs_journal_append_cell(stability, number, r, error)))
            return error->status;
        cs_process_pool_tick(&work->pool, 1);
    }
    if (!column->has_boundary && !find_border(column, stability->n_rows, &settings, error))
        cs_journal_append_boundary(stability, number, error);
    cs_process_pool_tick(&work->pool, TRIALS_OF_BORDER);
    return error->status;
}

/* Runs in a worker process. A column of another shard only advances the progress. */
static enum cs_status make_task(void *ctx, uint32_t task, struct cs_error *error) {
    struct work *work = ctx;
    struct cs_arena arena = {0};
    /* the last columns are the slowest: they go first */
    const uint32_t column = work->stability->n_columns - 1 - task;
    if (cs_shard_holds(&work->stability->settings->shard, column))
        make_column(work, work->stability->columns + column, &arena, error);
    else
        cs_process_pool_tick(&work->pool, work->stability->n_rows + TRIALS_OF_BORDER);
    cs_arena_finish(&arena);
    return error->status;
}

static void report(void *ctx, uint32_t ticks) {
    const struct cs_stability *stability = ctx;
    if (stability->settings->progress)
        stability->settings->progress(stability->settings->ctx, ticks,
                                      stability->n_columns *
                                          (stability->n_rows + TRIALS_OF_BORDER));
}

/* Runs all columns on the process pool; the pool stops at the first error or on request. */
static enum cs_status distribute(struct cs_stability *stability, struct cs_error *error) {
    struct work work = {stability,
                        {.n_workers = stability->settings->workers,
                         .n_tasks = stability->n_columns,
                         .task = make_task,
                         .progress = report,
                         .progress_ctx = stability,
                         .silence_max = cs_hang_seconds(stability->settings->budget),
                         .stop = stability->settings->session.run.stop}};
    work.pool.ctx = &work;
    return cs_process_pool_run(&work.pool, error);
}

/* under the name that was given, or its own: dt is what the map varies */
static enum cs_status name_series(struct cs_stability *stability, struct cs_error *error) {
    const char *given = stability->settings->series;
    if (given && *given) {
        snprintf(stability->series, sizeof stability->series, "%s", given);
        return cs_series_check_name(&stability->session.registry, given,
                                    &stability->session.method, error);
    }
    return cs_series_name(&stability->session.method, "dt", stability->series, error);
}

/* Value i of n from `from` to `to`, in equal ratios. */
static double share(double from, double to, uint32_t i, uint32_t n) {
    return n > 1 ? from * pow(to / from, (double)i / (n - 1)) : from;
}

/* Range of dt in s: from a quarter of the Gershgorin limit 2/omega at the stiff end of the axis
 * (0.5/omega) to eight times the limit at the soft end (16/omega). omega goes as sqrt(k/m). 60
 * 1/s stands in for a scene without springs. The damped end of a damping axis gets a factor of
 * 8, because explicit damping shortens the limit. */
static struct cs_range choose_dt(const struct cs_stability *stability, struct cs_range values) {
    const struct cs_view *view = &stability->session.system.view;
    double fast = view->omega > 0 ? view->omega : 60, slow = fast;
    const enum cs_axis axis = stability->settings->axis;
    if ((axis == CS_AXIS_STIFFNESS || axis == CS_AXIS_YOUNG) && stability->scene_value > 0) {
        slow *= sqrt(values.from / stability->scene_value);
        fast *= sqrt(values.to / stability->scene_value);
    } else if (stability->settings->axis == CS_AXIS_MASS && stability->scene_value > 0) {
        slow *= sqrt(stability->scene_value / values.to);
        fast *= sqrt(stability->scene_value / values.from);
    } else if (stability->settings->axis == CS_AXIS_DAMPING)
        fast *= 8;
    return (struct cs_range){0.5 / fast, fmin(16 / slow, 10)};
}

/* columns, then the cells of all of them */
static size_t bytes_of(const struct cs_stability *stability) {
    return stability->n_columns *
           (sizeof *stability->columns + stability->n_rows * sizeof *stability->columns->cells);
}

/* Allocates columns and cells as one block of shared memory, and fills in values and steps.
 * Values of a resolution axis are rounded to whole numbers. */
static enum cs_status lay_out(struct cs_stability *stability, struct cs_error *error) {
    const struct cs_stability_settings *settings = stability->settings;
    const bool whole = settings->axis == CS_AXIS_RESOLUTION;
    struct cs_range values = settings->values, dt = settings->dt;
    stability->scene_value = cs_axis_scene_value(&stability->session.system, settings->axis);
    if (values.to <= 0)
        values = cs_axis_range(&stability->session.system, settings->axis);
    if (!(values.from > 0))
        return cs_fail(error, CS_ERR_USAGE, "the scene has no %s to vary",
                       cs_axis_names[settings->axis]);
    if (dt.to <= 0)
        dt = choose_dt(stability, values);
    stability->n_columns = settings->columns;
    stability->n_rows = settings->rows;
    /* shared by the workers, in one block with all cells */
    stability->columns = cs_process_pool_shared_alloc(bytes_of(stability), error);
    stability->dt = cs_arena_alloc_array(&stability->arena, stability->n_rows,
                                         sizeof *stability->dt, error);
    if (error->status)
        return error->status;
    for (uint32_t r = 0; r < stability->n_rows; r++)
        stability->dt[r] = share(dt.from, dt.to, r, stability->n_rows);
    for (uint32_t c = 0; c < stability->n_columns; c++) {
        const double value = share(values.from, values.to, c, stability->n_columns);
        stability->columns[c].value = whole ? floor(value + 0.5) : value;
        stability->columns[c].cells =
            (struct cs_stability_cell *)(stability->columns + stability->n_columns) +
            c * stability->n_rows;
    }
    return error->status;
}

/* Fails if no column has a reference: such a map judges nothing. */
static enum cs_status check_references(const struct cs_stability *stability,
                                       struct cs_error *error) {
    const struct cs_stability_column *without = NULL;
    for (uint32_t c = 0; c < stability->n_columns; c++) {
        const struct cs_stability_column *column = stability->columns + c;
        if (column->reference.exists)
            return CS_OK;
        if (*column->reference.message)
            without = column;
    }
    return without ? cs_fail(error, CS_ERR_USAGE,
                             "%s = %g: the reference run failed (%.400s), in all other columns "
                             "too; try a shorter --time or a larger --budget",
                             cs_axis_names[stability->settings->axis], without->value,
                             without->reference.message)
                   : CS_OK;
}

/* True if all columns of other shards are known too, from the journal. */
static bool is_complete(const struct cs_stability *stability) {
    for (uint32_t c = 0; c < stability->n_columns; c++)
        if (!cs_shard_holds(&stability->settings->shard, c) &&
            !stability->columns[c].has_boundary)
            return false;
    return true;
}

enum cs_status cs_stability_open(struct cs_stability *stability,
                                 const struct cs_stability_settings *settings,
                                 struct cs_error *error) {
    *stability = (struct cs_stability){.settings = settings};
    if (cs_session_open_plan(&stability->session, &settings->session, error))
        return error->status;
    stability->integrator = stability->session.method.integrator;
    if (!cs_method_takes_dt(stability->integrator))
        return cs_fail(error, CS_ERR_USAGE,
                       "integrator \"%s\" %s: it has no map of dt; expected -i NAME of one "
                       "with steps of equal length, such as rk4",
                       stability->integrator->name,
                       stability->integrator->traits & CS_ADAPTIVE ? "chooses its own steps"
                                                                   : "has no option dt");
    return name_series(stability, error);
}

enum cs_status cs_stability_run(struct cs_stability *stability, struct cs_error *error) {
    const double begin = cs_clock_wall();
    if (cs_session_build(&stability->session, error) || lay_out(stability, error) ||
        cs_journal_open(stability, error) || distribute(stability, error) ||
        check_references(stability, error))
        return error->status;
    stability->is_complete = is_complete(stability);
    stability->wall = cs_clock_wall() - begin;
    return CS_OK;
}

void cs_stability_finish(struct cs_stability *stability) {
    cs_process_pool_shared_free(stability->columns, bytes_of(stability));
    cs_session_close(&stability->session);
    cs_arena_finish(&stability->arena);
    *stability = (struct cs_stability){0};
}
