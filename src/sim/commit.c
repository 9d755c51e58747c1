/* commit.c - the corrections after a step, in their order, and the decision to continue.
 *
 * One commit, in order:
 * 1. Ramped values move to t, and particles that static friction holds become free.
 * 2. The ledger books the step itself: works of forces, and the remainder as the method's
 *    error.
 * 3. Strain limit, contact projection, velocity loss, positions on grabbed paths. The ledger
 *    books each.
 *    A step that leaves particles inside colliders is taken back here.
 * 4. Anchors of sticking friction follow the points that slip.
 * 5. Checks: blow-up, interrupt, budget, a step over contact that the method did not ask about,
 *    then a first crossing of surfaces if the scene stops there.
 * 6. The observer, which may move the state.
 * 7. The ledger and contact store the state that the next step starts from; static friction
 *    decides again which particles it holds, and pins them. */
#include "sim/run_host.h"

#include "base/vector.h"
#include "model/contact/bristle_law.h"
#include "model/system/seams.h"
#include "scene/force_keys.h"
#include "sim/energy_ledger.h"

/* Shortens springs that are longer than the scene allows; counts them. */
static void limit_strain(struct cs_run_host *host, double dt, double *x, double *v,
                         bool *changed) {
    const struct cs_stage_start begin = cs_stage_begin(host);
    const uint64_t moves =
        cs_strain_limit_apply(&host->run->strain_limit, host->run->system, dt, x, v);
    host->run->counts.strain_limit_moves += moves;
    *changed |= moves > 0;
    cs_stage_end(host, CS_STAGE_LIMIT, begin);
}

/* Moves particles out of colliders and corrects their velocities (contact by projection). */
static void resolve_contact(struct cs_run_host *host, double t, double dt, double *x, double *v,
                            bool *changed) {
    const struct cs_stage_start begin = cs_stage_begin(host);
    *changed |= cs_contact_projection_resolve(&host->contact, t, dt, x, v);
    host->run->counts.contact_tests = host->contact.counts.tests;
    host->run->counts.projected_particles = host->contact.counts.projected;
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
}

void cs_host_pin(struct cs_run_host *host, bool held) {
    if (host->run->system->plan.rows[CS_FEATURE_CONTACT].built)
        cs_static_friction_pin(&host->contact.static_friction, held);
}

/* Stores the state as the start of the next step's contact, and pins the particles that
 * static friction will hold in it. observed: the observer moved the state, which voids what
 * friction held. moved: the state is not the one that contact left. Returns true if other
 * particles are held than before. */
static bool store_contact(struct cs_run_host *host, double t, const double *x, const double *v,
                          bool observed, bool moved) {
    struct cs_contact_projection *contact = &host->contact;
    const struct cs_stage_start begin = cs_stage_begin(host);
    cs_contact_projection_store(contact, x, v, !moved);
    contact->cut.t = t;
    if (observed)
        cs_static_friction_clear(&contact->static_friction);
    const bool others = cs_static_friction_update(&contact->static_friction, contact->colliders,
                                                  t, x, v, contact->state_after);
    cs_host_pin(host, true);
    cs_view_pages_update(&host->pages, &host->run->system->view);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
    return others;
}

/* Work of apply_velocity_loss: v is scaled by `kept`, in 0..1. */
struct loss {
    double *v, kept;
};

/* One range of the loop over 3n velocities. */
static void apply_velocity_loss(void *arg, size_t begin, size_t end) {
    const struct loss *loss = arg;
    for (size_t i = begin; i < end; i++)
        loss->v[i] *= loss->kept;
}

/* v *= 1 - velocity_loss, once per step whatever its length: not a force (see
 * docs/theory.md). */
static void lose_velocity(struct cs_run_host *host, double *v, bool *changed) {
    struct loss loss = {v, 1 - host->run->system->scene->forces->velocity_loss};
    cs_vector_parallel_for(3 * (size_t)host->run->system->view.n, apply_velocity_loss, &loss);
    *changed = true;
}

void cs_host_store_step(struct cs_run_host *host, double t, const double *x) {
    struct cs_blocked_step *step = &host->blocked_step;
    if (!step->asked && step->x) {
        step->t[0] = t;
        memcpy(step->x, x, 3 * sizeof *x * host->run->system->view.n);
    }
}

/* Ends the run at a step that passes over contact, of a method that never asks
 * max_step_fraction and so cannot shorten it: bodies would be through each other. */
static enum cs_step refuse_unasked(struct cs_run_host *host, double t, const double *x) {
    struct cs_blocked_step *step = &host->blocked_step;
    const double from = step->t[0], *const ends[] = {step->x, x};
    if (step->asked || !step->x ||
        cs_step_limit_fraction(host->run->system, from, step->x, t, x) >= 1)
        return CS_STEP_OK;
    cs_blocked_step_store(step, host->run->system, (const double[2]){from, t}, ends, 0);
    host->table.fail(
        host, "never asks max_step_fraction: its step of %.3g s at %.9g s would pass a contact",
        t - from, from);
    return CS_STEP_HALT;
}

/* Decides if the run continues. A blow-up comes first: its report must not hide behind an
 * interrupt. */
static enum cs_step judge(struct cs_run_host *host, double t, const double *x,
                          const double *v) {
    const volatile sig_atomic_t *stop = host->settings.stop;
    if (cs_blow_up_check_step(&host->blow_up, host->run, t, x, v))
        return CS_STEP_HALT;
    if (stop && *stop) {
        host->run->outcome = CS_INTERRUPTED;
        return CS_STEP_HALT;
    }
    return cs_run_host_end_over_budget(host) ? CS_STEP_HALT : refuse_unasked(host, t, x);
}

/* Ends the run at the first crossing of surfaces, if the scene asks for that: the motion
 * after it has no meaning. */
static enum cs_step stop_crossings(struct cs_run_host *host, double t, const double *x) {
    const struct cs_stage_start begin = cs_stage_begin(host);
    struct cs_text why = {0};
    enum cs_step step = CS_STEP_OK;
    if (cs_step_limit_ends_run(host->run->system, t, x, &why))
        step = host->table.fail(host, "%s", cs_text_get(&why));
    cs_text_finish(&why);
    cs_stage_end(host, CS_STAGE_CONTACT, begin);
    return step;
}

/* Traces the state that a correction left (phase NULL: it does not act), and books its
 * energy. */
static void book_correction(const struct cs_run_host *host, enum cs_ledger_work work,
                            const char *phase, double t, const double *x, const double *v) {
    if (phase)
        cs_trace_state(host, phase, t, x, v);
    if (host->settings.ledger)
        cs_energy_ledger_book_correction(host->settings.ledger, work, t, x, v);
}

/* Applies the post-step corrections. Contact follows the strain limit, which may move
 * particles into colliders. Grabbed particles come last and stay on their path, whatever
 * moved them. */
static void correct(struct cs_run_host *host, double t, double dt, double *x, double *v,
                    bool *changed) {
    const struct cs_plan_row *rows = host->run->system->plan.rows;
    const bool limit = rows[CS_FEATURE_STRAIN_LIMIT].built;
    const bool contact = rows[CS_FEATURE_CONTACT].built;
    const bool loss = rows[CS_FEATURE_VELOCITY_LOSS].built;
    if (limit)
        limit_strain(host, dt, x, v, changed);
    book_correction(host, CS_WORK_LIMIT, limit ? "strain limit" : NULL, t, x, v);
    if (contact)
        resolve_contact(host, t, dt, x, v, changed);
    book_correction(host, CS_WORK_PROJECTION, contact ? "contact" : NULL, t, x, v);
    cs_energy_input_corrections(host, t, x, v);
    if (loss)
        lose_velocity(host, v, changed);
    book_correction(host, CS_WORK_LOSS, loss ? "velocity loss" : NULL, t, x, v);
    if (rows[CS_FEATURE_EVENTS].built) {
        cs_events_apply_paths(host->run->system, t, x, v);
        cs_trace_state(host, "paths", t, x, v);
    }
}

/* Accounts before a step, for one that is taken back. */
struct account {
    struct cs_energy_input input;
    struct cs_energy_ledger ledger;
    double missed;
};

static void save_account(const struct cs_run_host *host, struct account *account) {
    account->input = host->run->energy_input;
    account->missed = host->run->strain_limit.missed;
    if (host->settings.ledger)
        account->ledger = *host->settings.ledger;
}

/* Returns true if the step is taken back, with nothing booked of it. */
static bool take_back(struct cs_run_host *host, double t, double dt, const double *x,
                      const struct account *account) {
    if (!cs_contact_projection_refuses(&host->contact, t, dt, x))
        return false;
    host->run->energy_input = account->input;
    host->run->strain_limit.missed = account->missed;
    if (host->settings.ledger)
        *host->settings.ledger = account->ledger;
    host->took_back = true;
    host->run->counts.steps--;
    host->run->counts.subdivided_steps++;
    return true;
}

/* A step that ends the run is observed and booked too: outputs then show where it ended. */
enum cs_step cs_host_commit(void *ctx, double t, double dt, double *x, double *v,
                            bool *changed) {
    struct cs_run_host *host = ctx;
    const struct cs_plan_row *rows = host->run->system->plan.rows;
    const struct cs_run_settings *settings = &host->settings;
    const bool projects = rows[CS_FEATURE_CONTACT].built;
    struct account account;
    *changed = false;
    if (projects)
        save_account(host, &account);
    host->run->counts.steps++;
    host->advance_check.last_commit = t;
    cs_move_values(host, t);
    cs_host_pin(host, false);
    cs_trace_state(host, "step", t, x, v);
    cs_events_apply_arcs(host->run->system, t, x, v);
    if (settings->ledger)
        cs_energy_ledger_book_step(settings->ledger, t, x, v);
    cs_energy_input_step(host, t, dt, x, v);
    correct(host, t, dt, x, v, changed);
    if (projects && take_back(host, t, dt, x, &account))
        return CS_STEP_BACK;
    cs_friction_anchors_commit(host->run->system, t, x, v);
    *changed |= cs_seams_break(host->run->system, x);
    if (cs_step_limit_failed(host->run->system))
        return host->table.fail(ctx, "out of memory for the contact pairs");
    enum cs_step step = judge(host, t, x, v);
    if (step == CS_STEP_OK && rows[CS_FEATURE_CROSSINGS].built)
        step = stop_crossings(host, t, x);
    bool moved = rows[CS_FEATURE_VELOCITY_LOSS].built || rows[CS_FEATURE_EVENTS].built;
    // a step that ends the run is observed too
    const bool observed =
        settings->after_commit && settings->after_commit(settings->ctx, t, dt, x, v);
    moved |= observed;
    *changed |= observed;
    if (settings->ledger)
        cs_energy_ledger_store_state(settings->ledger, t, x, v);
    if (projects)
        *changed |= store_contact(host, t, x, v, observed, moved);
    cs_host_store_step(host, t, x);
    return step;
}
