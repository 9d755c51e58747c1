/* Makes a stability map. Its columns are distributed over worker processes, which write their
 * results to shared memory. A step is judged against the reference, and the border of stable
 * steps is bisected. */
#include "study/stability/stability.h"

#include "base/clock.h"
#include "model/force/diagnostics.h"
#include "study/process_pool.h"
#include "study/stability/stability_state.h"

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
    if (trial.monitor.first.verdict != CS_STABILITY_BOUNDED)
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

/* Samples of the state per run; and runs that a bisected border counts as in the progress. */
enum { SAMPLES = 32, TRIALS_OF_BORDER = 7 };
/* Largest displacement at the start, in lengths of the shortest spring: the seed from which an
 * instability grows. */
#define PERTURBATION 1e-4

/* A map in the making. */
struct work {
    struct cs_stability *map;
    struct cs_process_pool workers;
};

/* Bisects between the highest row that is stable with all rows below and the next one. A row
 * that was too short to judge does not count as stable, so its step is no lower bracket. */
static enum cs_status find_border(struct cs_stability_column *column, uint32_t n_rows,
                                  const struct cs_sampled_run_settings *trial,
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
    return cs_stability_boundary(trial, &column->reference,
                                 known ? column->cells[row - 1].dt : 0, column->cells[row].dt,
                                 &column->boundary, error);
}

/* All cells of a column are judged by its reference, so the reference may take their total
 * budget. */
static enum cs_status find_reference(const struct cs_stability *map,
                                     const struct cs_sampled_run_settings *trial,
                                     struct cs_stability_column *column,
                                     struct cs_error *error) {
    struct cs_sampled_run_settings patient = *trial;
    patient.session.run.budget *= map->n_rows;
    if (cs_reference_run(&column->reference, &patient, error))
        return error->status;
    if (!column->reference.exists)
        column->reference.smallest_limit.dt = (double)NAN;
    return CS_OK;
}

/* Runs one cell, or marks it as not judged if the column has no reference. */
static enum cs_status try_cell(const struct cs_sampled_run_settings *trial,
                               const struct cs_stability_column *column, double dt,
                               struct cs_stability_cell *cell, struct cs_error *error) {
    if (column->reference.exists)
        return cs_stability_run_cell(trial, &column->reference, dt, cell, error);
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
    const struct cs_stability *map = work->map;
    struct cs_sampled_run_settings trial = {.session = map->settings->session,
                                            .seconds = map->settings->seconds,
                                            .samples = SAMPLES};
    trial.session.perturbation = PERTURBATION * cs_diagnostics_shortest(&map->session.system);
    trial.session.run.budget = map->settings->budget;
    /* springs get shorter as columns are added: the perturbation keeps its ratio to them */
    if (map->settings->axis == CS_AXIS_RESOLUTION && column->value > 0)
        trial.session.perturbation *= map->scene_value / column->value;
    const uint32_t number = (uint32_t)(column - map->columns);
    if (cs_axis_overrides(&map->session.system, map->settings->axis, column->value, arena,
                          &trial.session, error))
        return error->status;
    if (!column->has_reference && (find_reference(map, &trial, column, error) ||
                                   cs_journal_append_reference(map, number, error)))
        return error->status;
    for (uint32_t r = 0; r < map->n_rows; r++) {
        if (!(column->cells[r].dt > 0) &&
            (try_cell(&trial, column, map->dt[r], column->cells + r, error) ||
             cs_journal_append_cell(map, number, r, error)))
            return error->status;
        cs_process_pool_tick(&work->workers, 1);
    }
    if (!column->has_boundary && !find_border(column, map->n_rows, &trial, error))
        cs_journal_append_boundary(map, number, error);
    cs_process_pool_tick(&work->workers, TRIALS_OF_BORDER);
    return error->status;
}

/* Runs in a worker process. A column of another shard only advances the progress. */
static enum cs_status make_task(void *ctx, uint32_t task, struct cs_error *error) {
    struct work *work = ctx;
    struct cs_arena arena = {0};
    /* the last columns are the slowest: they go first */
    const uint32_t column = work->map->n_columns - 1 - task;
    if (cs_shard_holds(&work->map->settings->shard, column))
        make_column(work, work->map->columns + column, &arena, error);
    else
        cs_process_pool_tick(&work->workers, work->map->n_rows + TRIALS_OF_BORDER);
    cs_arena_finish(&arena);
    return error->status;
}

static void report(void *ctx, uint32_t ticks) {
    const struct cs_stability *map = ctx;
    if (map->settings->progress)
        map->settings->progress(map->settings->ctx, ticks,
                                map->n_columns * (map->n_rows + TRIALS_OF_BORDER));
}

/* Runs all columns on the process pool; the pool stops at the first error or on request. */
static enum cs_status distribute(struct cs_stability *map, struct cs_error *error) {
    struct work work = {map,
                        {.n_workers = map->settings->workers,
                         .n_tasks = map->n_columns,
                         .task = make_task,
                         .progress = report,
                         .progress_ctx = map,
                         .silence_max = cs_hang_seconds(map->settings->budget),
                         .stop = map->settings->session.run.stop}};
    work.workers.ctx = &work;
    return cs_process_pool_run(&work.workers, error);
}

/* under the name that was given, or its own: dt is what the map varies */
static enum cs_status name_series(struct cs_stability *map, struct cs_error *error) {
    const char *given = map->settings->series;
    if (given && *given) {
        snprintf(map->series, sizeof map->series, "%s", given);
        return cs_series_check_name(&map->session.registry, given, &map->session.method, error);
    }
    return cs_series_name(&map->session.method, "dt", map->series, error);
}

/* Value i of n from `from` to `to`, in equal ratios. */
static double share(double from, double to, uint32_t i, uint32_t n) {
    return n > 1 ? from * pow(to / from, (double)i / (n - 1)) : from;
}

/* Range of dt in s: from a quarter of the Gershgorin limit 2/omega at the stiff end of the axis
 * (0.5/omega) to eight times the limit at the soft end (16/omega). omega goes as sqrt(k/m). 60
 * 1/s stands in for a scene without springs. The damped end of a damping axis gets a factor of
 * 8, because explicit damping shortens the limit. */
static struct cs_range choose_dt(const struct cs_stability *map, struct cs_range values) {
    const struct cs_view *view = &map->session.system.view;
    double fast = view->omega > 0 ? view->omega : 60, slow = fast;
    const enum cs_axis axis = map->settings->axis;
    if ((axis == CS_AXIS_STIFFNESS || axis == CS_AXIS_YOUNG) && map->scene_value > 0) {
        slow *= sqrt(values.from / map->scene_value);
        fast *= sqrt(values.to / map->scene_value);
    } else if (map->settings->axis == CS_AXIS_MASS && map->scene_value > 0) {
        slow *= sqrt(map->scene_value / values.to);
        fast *= sqrt(map->scene_value / values.from);
    } else if (map->settings->axis == CS_AXIS_DAMPING)
        fast *= 8;
    return (struct cs_range){0.5 / fast, fmin(16 / slow, 10)};
}

/* columns, then the cells of all of them */
static size_t bytes_of(const struct cs_stability *map) {
    return map->n_columns * (sizeof *map->columns + map->n_rows * sizeof *map->columns->cells);
}

/* Allocates columns and cells as one block of shared memory, and fills in values and steps.
 * Values of a resolution axis are rounded to whole numbers. */
static enum cs_status lay_out(struct cs_stability *map, struct cs_error *error) {
    const struct cs_stability_settings *settings = map->settings;
    const bool whole = settings->axis == CS_AXIS_RESOLUTION;
    struct cs_range values = settings->values, dt = settings->dt;
    map->scene_value = cs_axis_scene_value(&map->session.system, settings->axis);
    if (values.to <= 0)
        values = cs_axis_range(&map->session.system, settings->axis);
    if (!(values.from > 0))
        return cs_fail(error, CS_ERR_USAGE, "the scene has no %s to vary",
                       cs_axis_names[settings->axis]);
    if (dt.to <= 0)
        dt = choose_dt(map, values);
    map->n_columns = settings->columns;
    map->n_rows = settings->rows;
    /* shared by the workers, in one block with all cells */
    map->columns = cs_process_pool_shared_alloc(bytes_of(map), error);
    map->dt = cs_arena_alloc_array(&map->arena, map->n_rows, sizeof *map->dt, error);
    if (error->status)
        return error->status;
    for (uint32_t r = 0; r < map->n_rows; r++)
        map->dt[r] = share(dt.from, dt.to, r, map->n_rows);
    for (uint32_t c = 0; c < map->n_columns; c++) {
        const double value = share(values.from, values.to, c, map->n_columns);
        map->columns[c].value = whole ? floor(value + 0.5) : value;
        map->columns[c].cells =
            (struct cs_stability_cell *)(map->columns + map->n_columns) + c * map->n_rows;
    }
    return error->status;
}

/* Fails if no column has a reference: such a map judges nothing. */
static enum cs_status check_references(const struct cs_stability *map, struct cs_error *error) {
    const struct cs_stability_column *without = NULL;
    for (uint32_t c = 0; c < map->n_columns; c++) {
        const struct cs_stability_column *column = map->columns + c;
        if (column->reference.exists)
            return CS_OK;
        if (*column->reference.message)
            without = column;
    }
    return without ? cs_fail(error, CS_ERR_USAGE,
                             "%s = %g: the reference run failed (%.400s), in all other columns "
                             "too; try a shorter --time or a larger --budget",
                             cs_axis_names[map->settings->axis], without->value,
                             without->reference.message)
                   : CS_OK;
}

/* True if all columns of other shards are known too, from the journal. */
static bool is_complete(const struct cs_stability *map) {
    for (uint32_t c = 0; c < map->n_columns; c++)
        if (!cs_shard_holds(&map->settings->shard, c) && !map->columns[c].has_boundary)
            return false;
    return true;
}

enum cs_status cs_stability_open(struct cs_stability *map,
                                 const struct cs_stability_settings *settings,
                                 struct cs_error *error) {
    *map = (struct cs_stability){.settings = settings};
    if (cs_session_open_plan(&map->session, &settings->session, error))
        return error->status;
    map->integrator = map->session.method.integrator;
    if (!cs_method_takes_dt(map->integrator))
        return cs_fail(error, CS_ERR_USAGE, "integrator \"%s\" %s: it has no map of dt",
                       map->integrator->name,
                       map->integrator->traits & CS_ADAPTIVE ? "chooses its own steps"
                                                             : "has no option dt");
    return name_series(map, error);
}

enum cs_status cs_stability_run(struct cs_stability *map, struct cs_error *error) {
    const double begin = cs_clock_wall();
    if (cs_session_build(&map->session, error) || lay_out(map, error) ||
        cs_journal_open(map, error) || distribute(map, error) || check_references(map, error))
        return error->status;
    map->is_complete = is_complete(map);
    map->wall = cs_clock_wall() - begin;
    return CS_OK;
}

void cs_stability_finish(struct cs_stability *map) {
    cs_process_pool_shared_free(map->columns, bytes_of(map));
    cs_session_close(&map->session);
    cs_arena_finish(&map->arena);
    *map = (struct cs_stability){0};
}
