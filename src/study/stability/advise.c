/* Finds a safe step for each method from linear theory, and confirms it by runs. */
#include "study/stability/advise.h"

#include "study/stability/contact_line.h"
#include "study/workers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 32 };
#define PERTURBATION 1e-4 /* of the shortest spring */
#define MARGIN       0.9  /* of the limit that is advised */

struct work {
    struct cs_advise *advise;
    struct cs_workers workers;
};

/* A run with the advised step: its verdict and what a frame costs. */
static enum cs_status try_safe(struct cs_advice *row, const struct cs_trial_settings *settings,
                               const struct cs_reference *reference, double frame,
                               struct cs_error *error) {
    struct cs_trial_settings asked = *settings;
    struct cs_trial trial;
    asked.session.dt = row->safe;
    asked.seconds = reference->seconds;
    asked.limits = cs_fate_limits(&reference->trial);
    if (cs_trial_run(&trial, &asked, error))
        return error->status;
    row->verdict = cs_fate_of(&trial, &reference->trial, true);
    if (trial.failed)
        snprintf(row->message, sizeof row->message, "%s", trial.message);
    if (trial.end > 0) {
        row->frame_cost = trial.seconds / trial.end * frame;
        row->steps = (double)trial.steps / trial.end * frame;
    }
    return CS_OK;
}

/* Theory has no limit: one step a frame is tried, and what is wrong with it is bisected. */
static enum cs_status try_frame(struct cs_advice *row, const struct cs_trial_settings *settings,
                                const struct cs_reference *reference, double frame,
                                struct cs_error *error) {
    row->kind = CS_ADVICE_FRAME;
    row->limit = HUGE_VAL;
    row->safe = fmin(frame, 10);
    if (try_safe(row, settings, reference, frame, error) || cs_fate_is_stable(row->verdict) ||
        row->verdict == CS_FATE_OVER_BUDGET)
        return error->status;
    row->kind = CS_ADVICE_MEASURED;
    if (cs_stability_border(settings, reference, 0, row->safe, &row->limit, error))
        return error->status;
    if (isnan(row->limit)) {
        row->kind = CS_ADVICE_REFUSED;
        snprintf(row->message, sizeof row->message,
                 "one step a frame does not live, and the budget ends the search for less");
        return CS_OK;
    }
    if (!(row->limit > 0)) {
        row->kind = CS_ADVICE_NONE;
        return CS_OK;
    }
    /* the message is about the step of a frame, which is not advised */
    *row->message = 0;
    row->safe = MARGIN * row->limit;
    return try_safe(row, settings, reference, frame, error);
}

/* If even a part of theory's limit is unstable, the stable step is bisected: a motion that is
 * large from the start passes the bound with less growth than theory allows. */
static enum cs_status try_lower(struct cs_advice *row, const struct cs_trial_settings *settings,
                                const struct cs_reference *reference, double frame,
                                struct cs_error *error) {
    double border;
    if (cs_stability_border(settings, reference, 0, row->safe, &border, error) ||
        !(border > 0 && border < HUGE_VAL))
        return error->status;
    row->kind = CS_ADVICE_LOWERED;
    row->limit = border;
    row->safe = MARGIN * border;
    *row->message = 0;
    return try_safe(row, settings, reference, frame, error);
}

static enum cs_status check_limit(struct cs_advice *row,
                                  const struct cs_trial_settings *settings,
                                  const struct cs_reference *reference,
                                  struct cs_error *error) {
    return cs_stability_border(settings, reference, 0, 1.5 * row->limit, &row->measured, error);
}

static enum cs_status advise_fixed(struct cs_advice *row,
                                   const struct cs_trial_settings *settings, double frame,
                                   bool check, struct cs_error *error) {
    struct cs_reference reference;
    if (cs_reference_run(&reference, settings, error))
        return error->status;
    if (!reference.found) {
        row->kind = CS_ADVICE_REFUSED;
        snprintf(row->message, sizeof row->message, "no run to judge by: %.280s",
                 reference.message);
        return CS_OK;
    }
    row->speed = reference.trial.speed;
    row->limit = row->theory = reference.worst.dt;
    row->mode = reference.worst.mode;
    /* theory knows no limit */
    if (row->limit > 1e100)
        return try_frame(row, settings, &reference, frame, error);
    row->kind = row->limit > 0 ? CS_ADVICE_THEORY : CS_ADVICE_NONE;
    row->safe = fmin(MARGIN * row->limit, fmin(frame, 10));
    if (row->kind == CS_ADVICE_NONE)
        return CS_OK;
    if (check && check_limit(row, settings, &reference, error))
        return error->status;
    if (try_safe(row, settings, &reference, frame, error) || cs_fate_is_stable(row->verdict) ||
        row->verdict == CS_FATE_OVER_BUDGET)
        return error->status;
    return try_lower(row, settings, &reference, frame, error);
}

static enum cs_status advise_adaptive(struct cs_advice *row,
                                      const struct cs_trial_settings *settings, double frame,
                                      struct cs_error *error) {
    struct cs_reference none = {.seconds = settings->seconds,
                                .trial = {.speed = 1e100, .held = 1e100}};
    row->kind = CS_ADVICE_ADAPTIVE;
    return try_safe(row, settings, &none, frame, error);
}

/* A method that cannot follow the scene, which was opened with its own before, is a row. */
static enum cs_status refuse(struct cs_advice *row, struct cs_error *error) {
    if (error->status != CS_ERR_SCENE)
        return error->status;
    row->kind = CS_ADVICE_REFUSED;
    snprintf(row->message, sizeof row->message, "%.300s", error->message);
    *error = (struct cs_error){0};
    return CS_OK;
}

static enum cs_status advise_task(void *ctx, uint32_t task, struct cs_error *error) {
    struct work *work = ctx;
    struct cs_advise *advise = work->advise;
    struct cs_advice *row = advise->rows + task;
    struct cs_session session;
    struct cs_trial_settings trial = {
        .session = advise->session, .seconds = advise->seconds, .samples = SAMPLES};
    const double frame = 1 / advise->opened.scene.time.fps;
    trial.session.perturbation =
        PERTURBATION * cs_springs_shortest(&advise->opened.system.springs);
    trial.session.run.budget = advise->budget;
    trial.session.integrator = row->method = advise->names[task];
    /* only to learn whether the method can follow the scene, and whether it takes dt */
    if (cs_session_open_plan(&session, &trial.session, error)) {
        cs_workers_tick(&work->workers, 1);
        return refuse(row, error);
    }
    const bool fixed = cs_method_takes_dt(session.method.integrator);
    cs_session_close(&session);
    if (fixed)
        advise_fixed(row, &trial, frame, advise->check, error);
    else
        advise_adaptive(row, &trial, frame, error);
    cs_workers_tick(&work->workers, 1);
    return error->status;
}

static void report(void *ctx, uint32_t ticks) {
    const struct cs_advise *advise = ctx;
    if (advise->progress)
        advise->progress(advise->ctx, ticks, advise->n);
}

static enum cs_status list_methods(struct cs_advise *advise, struct cs_error *error) {
    for (uint32_t k = 0; k < advise->session.n_plugins; k++)
        if (cs_registry_add_file(&advise->registry, advise->session.plugins[k], error))
            return error->status;
    if (!advise->n_methods && cs_registry_open_all(&advise->registry, error))
        return error->status;
    advise->names = calloc(advise->n_methods + advise->registry.n + 1, sizeof(char *));
    if (!advise->names)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    for (uint32_t k = 0; k < advise->n_methods; k++)
        advise->names[advise->n++] = advise->methods[k];
    for (uint32_t k = 0; k < advise->registry.n && !advise->n_methods; k++)
        if (advise->registry.entries[k].integrator)
            advise->names[advise->n++] = advise->registry.entries[k].integrator->name;
    return CS_OK;
}

enum cs_status cs_advise_run(struct cs_advise *advise, struct cs_error *error) {
    struct work work = {advise, {.task = advise_task, .progress = report}};
    if (cs_session_open_system(&advise->opened, &advise->session, error) ||
        list_methods(advise, error))
        return error->status;
    work.workers.ctx = &work;
    work.workers.progress_ctx = advise;
    work.workers.n_workers = advise->workers;
    work.workers.n_tasks = advise->n;
    work.workers.stop = advise->stop;
    advise->rows = cs_workers_take(advise->n * sizeof *advise->rows, error);
    work.workers.ticks = cs_workers_take(sizeof(uint32_t), error);
    if (!error->status)
        cs_workers_run(&work.workers, error);
    cs_workers_give_back(work.workers.ticks, sizeof(uint32_t));
    return error->status;
}

void cs_advise_finish(struct cs_advise *advise) {
    cs_workers_give_back(advise->rows, advise->n * sizeof *advise->rows);
    free(advise->names);
    cs_registry_finish(&advise->registry);
    cs_session_close(&advise->opened);
    *advise = (struct cs_advise){0};
}

struct spring {
    double stiffness; /* N/m; 0: none */
    uint32_t kind;
};

static struct spring stiffest_at(const struct cs_system *system, uint32_t particle) {
    struct spring found = {0};
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const double stiffness = cs_spring_stiffness(run, i);
            if ((cs_spring_a(run, i) == particle || cs_spring_b(run, i) == particle) &&
                stiffness > found.stiffness)
                found = (struct spring){stiffness, run->kind};
        }
    }
    return found;
}

/* "particle 12 (body 0, column 4, row 1) swings at 4158 /s on stretch springs of 1000 N/m" */
static void add_binding(const struct cs_system *system, const struct cs_mode *mode,
                        struct cs_text *out) {
    static const char *const kinds[CS_SPRING_KINDS] = {"stretch", "shear", "bend"};
    const struct spring spring = stiffest_at(system, mode->particle);
    const bool damped = mode->rate * mode->rate > 4 * mode->square;
    cs_system_print_particle(system, mode->particle, out);
    if (damped)
        cs_text_add(out, " is damped at %.4g /s", mode->rate);
    else
        cs_text_add(out, " swings at %.4g /s, damped at %.3g /s", sqrt(fmax(mode->square, 0)),
                    mode->rate);
    // the bounds of the view do not hold contact
    if (mode->rate > 2 * system->view.delta ||
        mode->square > system->view.omega * system->view.omega)
        cs_text_add(out, " by contact");
    if (spring.stiffness > 0)
        cs_text_add(out, ": %.3g kg on %s springs of %.4g N/m", system->mass[mode->particle],
                    kinds[spring.kind], spring.stiffness);
}

static void add_why(const struct cs_advise *advise, const struct cs_advice *row,
                    struct cs_text *out) {
    switch (row->kind) {
    case CS_ADVICE_THEORY:
        add_binding(&advise->opened.system, &row->mode, out);
        break;
    case CS_ADVICE_LOWERED:
        add_binding(&advise->opened.system, &row->mode, out);
        cs_text_add(out, "; bisected, linear theory allows %.4g s", row->theory);
        break;
    case CS_ADVICE_MEASURED:
        cs_text_add(out, "no limit in linear theory; bisected, large motions set it");
        break;
    case CS_ADVICE_FRAME:
        cs_text_add(out, "no limit found: one step a frame");
        break;
    case CS_ADVICE_NONE:
        cs_text_add(out, "no step is stable: the damping is too weak");
        break;
    case CS_ADVICE_ADAPTIVE:
        cs_text_add(out, "chooses its own steps");
        break;
    case CS_ADVICE_REFUSED:
        break;
    }
    /* a message says more than the verdict; a sound run needs neither */
    if (*row->message)
        cs_text_add(out, "%s%s", row->kind == CS_ADVICE_REFUSED ? "" : "; ", row->message);
    else if (row->verdict != CS_FATE_BOUNDED && row->kind != CS_ADVICE_NONE)
        cs_text_add(out, "; %s", cs_fate_word(row->verdict));
}

static void add_number(struct cs_text *out, double value, int width) {
    if (value > 0 && value < 1e100)
        cs_text_add(out, "%*.4g", width, value);
    else
        cs_text_add(out, "%*s", width, "-");
}

static void add_contact(const struct cs_advise *advise, struct cs_text *out) {
    const struct cs_system *system = &advise->opened.system;
    double speed = 0;
    for (uint32_t k = 0; k < advise->n; k++)
        speed = fmax(speed, advise->rows[k].speed);
    if (!system->scene->colliders.n)
        return;
    cs_contact_line_add(system->scene, "", out);
    cs_text_add(out, "\n");
    cs_contact_line_add_crossing(system, speed, out);
}

void cs_advise_print(const struct cs_advise *advise, struct cs_text *out) {
    add_contact(advise, out);
    cs_text_add(out, "%-22s%12s%12s%s%12s%14s\n", "method", "limit [s]", "advised [s]",
                advise->check ? "   found [s]" : "", "steps/frame", "ms a frame");
    for (uint32_t k = 0; k < advise->n; k++) {
        const struct cs_advice *row = advise->rows + k;
        const bool fixed = row->kind != CS_ADVICE_ADAPTIVE && row->kind != CS_ADVICE_NONE;
        cs_text_add(out, "%-22s", row->method);
        add_number(out, row->limit, 12);
        add_number(out, fixed ? row->safe : 0, 12);
        if (advise->check)
            add_number(out, row->measured, 12);
        add_number(out, row->steps, 12);
        add_number(out, 1e3 * row->frame_cost, 14);
        cs_text_add(out, "\n    ");
        add_why(advise, row, out);
        cs_text_add(out, "\n");
    }
}
