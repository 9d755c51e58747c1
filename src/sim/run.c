/* run.c - creates a method, advances it frame by frame, and restarts it at events. */
#include "scene/scene.h"
#include "sim/run_state.h"

#include "model/contact/bristle_law.h"
#include "model/system/seams.h"
#include "sim/crash.h"
#include "sim/run_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Force evaluations per step of a ledger, about, which struct cs_counts leaves out. */
enum { LEDGER_PASSES = 10 };

const char *const cs_stage_names[] = {"force", "setup",   "solve", "contact",
                                      "limit", "normals", NULL};

const char *cs_outcome_text(enum cs_outcome outcome) {
    switch (outcome) {
#define X(name, text)                                                                          \
    case name:                                                                                 \
        return text;
        CS_OUTCOME_LIST(X)
#undef X
    }
    return "unknown";
}

/* Turns the end of a call into the method into a status. A change of the process state is an
 * error whatever the call returned. CS_STEP_HALT is no error if an outcome explains it. After
 * a failed allocation any failure of the method counts as CS_ERR_MEMORY. */
static enum cs_status judge(struct cs_run *run, enum cs_step step, struct cs_error *error) {
    const char *name = run->integrator->name,
               *changed = cs_process_state_restore(&run->host->process_state);
    const bool starved = cs_crash_was_starved(CS_CRASH_METHOD);
    run->is_process_changed |= changed != NULL;
    if (changed)
        return cs_fail(error, CS_ERR_MODULE, "integrator \"%s\" changed %s", name, changed);
    if (step == CS_STEP_OK || (step == CS_STEP_HALT && run->outcome != CS_RUNNING))
        return CS_OK;
    const struct cs_error *said = &run->host->error;
    const enum cs_status status = said->status ? said->status : CS_ERR_MODULE;
    const bool memory = starved && status == CS_ERR_MODULE;
    return cs_fail(error, memory ? CS_ERR_MEMORY : status,
                   "%sintegrator \"%s\" failed at t = %.6g s: %s",
                   memory ? "out of memory: " : "", name, run->t,
                   said->status ? said->message : "it gave no reason");
}

/* Marks the call into the method that begins, for the message if it brings the program down.
 * cs_crash_forget ends it. */
static void watch(const struct cs_run *run, const char *place) {
    cs_view_pages_update(&run->host->pages, &run->system->view);
    cs_crash_watch(CS_CRASH_METHOD, "integrator", run->integrator->name, place);
}

/* The method's restart at t, with particles pinned that static friction holds. A module from
 * outside is held to the const of the state. */
static enum cs_step restart(struct cs_run *run, double t) {
    const size_t n = run->host->pages.view ? 6 * (size_t)run->system->view.n : 0;
    char before[CS_HASH_DIGITS], after[CS_HASH_DIGITS];
    cs_hash_doubles(run->x, n, before);
    cs_host_pin(run->host, true);
    watch(run, "in restart");
    const enum cs_step step = run->integrator->restart(run->host->self, t, run->x, run->v);
    cs_crash_forget(CS_CRASH_METHOD);
    cs_host_pin(run->host, false);
    cs_hash_doubles(run->x, n, after);
    return step == CS_STEP_OK && strcmp(before, after) != 0
               ? run->host->table.fail(run->host, "it changed the state in restart")
               : step;
}

/* Checks the post-conditions of an advance; a violation is a failure of the method. */
static enum cs_step check_left(struct cs_run *run, double to) {
    struct cs_run_host *host = run->host;
    struct cs_text why = {0};
    enum cs_step step = CS_STEP_OK;
    if (!host->settings.skip_advance_check &&
        !cs_advance_check_passes(&host->advance_check, to, &why))
        step = host->table.fail(host, "%s", cs_text_get(&why));
    cs_text_finish(&why);
    return step;
}

/* Adds the deepest contact to the reason of a method that gave up without a rejected step. */
static void add_deepest_contact(struct cs_run *run) {
    struct cs_run_host *host = run->host;
    struct cs_text where = {0};
    const size_t used = strlen(host->error.message);
    cs_blocked_step_print_deepest(&host->blocked_step, run->system,
                                  host->advance_check.last_commit, run->x, run->v, &where);
    snprintf(host->error.message + used, sizeof host->error.message - used, "%s",
             cs_text_get(&where));
    cs_text_finish(&where);
}

/* Makes a result of an advance that found no step short enough. Without memory it is none. */
static void note_give_up(struct cs_run *run) {
    const struct cs_run_host *host = run->host;
    const struct cs_error *said = &host->error;
    if (run->outcome != CS_RUNNING || said->status != CS_ERR_MODULE ||
        cs_crash_was_starved(CS_CRASH_METHOD))
        return;
    run->outcome = CS_GAVE_UP;
    run->reason = said->message;
    if (!host->blocked_step.is_set)
        add_deepest_contact(run);
}

/* The method's advance, with its post-conditions checked. */
static enum cs_step advance_part(struct cs_run *run, double from, double to) {
    if (!run->host->settings.skip_advance_check)
        cs_advance_check_begin(&run->host->advance_check, run->system, from);
    cs_host_store_step(run->host, from, run->x);
    cs_host_pin(run->host, true);
    watch(run, "in advance");
    const enum cs_step step =
        run->integrator->advance(run->host->self, from, to, run->x, run->v);
    cs_crash_forget(CS_CRASH_METHOD);
    cs_host_pin(run->host, false);
    if (step == CS_STEP_HALT)
        note_give_up(run);
    return step == CS_STEP_OK && !run->host->took_back ? check_left(run, to) : step;
}

/* Restarts the method where the step began that commit took back. */
static enum cs_step restart_step(struct cs_run *run) {
    const struct cs_contact_projection *contact = &run->host->contact;
    run->host->took_back = false;
    memcpy(run->x, contact->state_before, 6 * sizeof *run->x * run->system->view.n);
    return restart(run, contact->cut.t);
}

/* Advances in one call of the method, or in parts where contact by projection needs shorter
 * steps. */
static enum cs_step advance(struct cs_run *run, double from, double to) {
    struct cs_contact_projection *contact = &run->host->contact;
    const struct cs_events *events = run->system->events;
    const bool projects = run->system->plan.rows[CS_FEATURE_CONTACT].built;
    enum cs_step step = CS_STEP_OK;
    if (events && run->host->table.overstep_until > 0)
        run->host->table.overstep_until = cs_events_next(events);
    for (double t = from, end; t < to && step == CS_STEP_OK; t = end) {
        end = projects ? cs_contact_projection_end(contact, t == from, t, to) : to;
        step = advance_part(run, t, end);
        if (run->host->took_back) {
            step = restart_step(run);
            end = contact->cut.t;
        }
    }
    return step;
}

/* Adds the times since then to those inside the method. */
static void count_time(struct cs_run *run, struct cs_stage_start begin) {
    const struct cs_stage_start now = cs_stage_now();
    run->advance_seconds += now.wall - begin.wall;
    run->advance_cpu += now.cpu - begin.cpu;
}

/* The memory of rounds, only where a body has a strain limit. */
static enum cs_status add_strain_limit(struct cs_run *run, struct cs_error *error) {
    struct cs_plan_row *row = run->plan.rows + CS_FEATURE_STRAIN_LIMIT;
    run->host->arena.part = &row->bytes;
    if (row->built)
        CS_ARENA_ARRAY(&run->host->arena, run->strain_limit.before,
                       6 * (size_t)run->system->view.n, error);
    run->host->arena.part = &run->method_bytes;
    return error->status;
}

/* Creates the method, counts its memory in run->method_bytes, and restarts it at 0. */
static enum cs_status start(struct cs_run *run, const void *options, struct cs_error *error) {
    struct cs_run_host *host = run->host;
    cs_friction_anchors_commit(run->system, 0, run->x, NULL);
    host->process_state = cs_process_state_save();
    cs_crash_begin(CS_CRASH_METHOD);
    cs_run_host_set_scales(host);
    if (add_strain_limit(run, error))
        return error->status;
    host->creating = true;
    if (cs_view_pages_needed(run->integrator) &&
        cs_view_pages_create(&host->pages, &run->system->view, error))
        return error->status;
    if (host->pages.view)
        host->table.view = host->pages.view;
    const struct cs_stage_start begin = cs_stage_now();
    watch(run, "in create");
    const enum cs_step step = run->integrator->create(&host->table, options, &host->self);
    cs_crash_forget(CS_CRASH_METHOD);
    host->creating = false;
    count_time(run, begin);
    return judge(run, step, error) ? error->status : cs_run_restart(run, 0, error);
}

enum cs_status cs_run_restart(struct cs_run *run, double t, struct cs_error *error) {
    const struct cs_stage_start begin = cs_stage_now();
    const enum cs_step step = restart(run, t);
    count_time(run, begin);
    return judge(run, step, error);
}

enum cs_status cs_run_advance(struct cs_run *run, double from, double to,
                              struct cs_error *error) {
    return judge(run, advance(run, from, to), error);
}

enum cs_status cs_run_archive(struct cs_run *run, cs_archive_call *call,
                              const struct cs_archive *archive, struct cs_error *error) {
    cs_host_pin(run->host, true);
    watch(run, "in save or load");
    const enum cs_step step = call(run->host->self, archive);
    cs_crash_forget(CS_CRASH_METHOD);
    cs_host_pin(run->host, false);
    return judge(run, step, error);
}

/* Advances from run->t to end, in one call per segment between events, and restarts the
 * method at each event that changes something. Events at `end` belong to the next frame. */
static enum cs_step advance_frame(struct cs_run *run, double end) {
    const struct cs_events *events = run->system->events;
    enum cs_step step = CS_STEP_OK;
    for (double t = run->t, next; t < end && step == CS_STEP_OK; t = next) {
        if (events && cs_events_next(events) <= t && cs_run_host_apply_events(run->host, t))
            step = restart(run, t);
        next = events ? fmin(cs_events_next(events), end) : end;
        if (step == CS_STEP_OK)
            step = advance(run, t, next);
    }
    return step;
}

/* Order: the host's table and memory, the method's create, its restart at 0. */
enum cs_status cs_run_begin(struct cs_run *run, struct cs_system *system,
                            const struct cs_integrator *integrator, const void *options,
                            const struct cs_run_settings *settings, struct cs_error *error) {
    *run = (struct cs_run){.system = system, .integrator = integrator, .plan = system->plan};
    run->host = calloc(1, sizeof *run->host);
    if (!run->host)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    run->host->settings = *settings;
    run->host->pass_seconds = cs_pass_seconds(system) * (settings->ledger ? LEDGER_PASSES : 1);
    run->x = system->state;
    run->v = run->x + 3 * (size_t)system->view.n;
    if (cs_run_host_init(run->host, run, error) || start(run, options, error))
        cs_run_finish(run);
    return error->status;
}

static void count_method(struct cs_run *run) {
    watch(run, "in stats");
    cs_run_host_count(run->host);
    cs_crash_forget(CS_CRASH_METHOD);
}

/* The time of a frame is computed from its number: fps need not divide it without rounding. */
enum cs_status cs_run_frame(struct cs_run *run, struct cs_error *error) {
    const double next = (run->frame + 1) / run->system->scene->time.fps;
    const struct cs_stage_start begin = cs_stage_now();
    const enum cs_step step = advance_frame(run, next);
    count_time(run, begin);
    count_method(run);
    if (judge(run, step, error))
        return error->status;
    if (run->outcome == CS_RUNNING) {
        run->t = next;
        run->frame++;
    } else if (run->outcome == CS_OVER_BUDGET)
        run->t = run->host->advance_check.last_commit;
    return CS_OK;
}

const struct cs_host *cs_run_calls(const struct cs_run *run) {
    return &run->host->table;
}

void cs_run_fail_solves(struct cs_run *run) {
    cs_run_host_fail_solves(run->host);
}

bool cs_run_has_goals(const struct cs_integrator *integrator) {
    // a module that was built before the call was there has a shorter struct
    return CS_HAS(integrator, goals) && integrator->goals;
}

void cs_run_goals(const struct cs_run *run, double *g) {
    CS_ASSERT(cs_run_has_goals(run->integrator));
    watch(run, "in goals");
    run->integrator->goals(run->host->self, run->x, g);
    cs_crash_forget(CS_CRASH_METHOD);
}

size_t cs_run_bytes(const struct cs_run *run) {
    const struct cs_system *system = run->system;
    return system->arena.used + system->plan.rows[CS_FEATURE_MESHES].bytes +
           system->plan.rows[CS_FEATURE_KEY_FRAMES].bytes + run->host->arena.used;
}

void cs_run_hash(const struct cs_run *run, char digits[CS_HASH_DIGITS]) {
    const struct cs_friction_anchors *anchors = run->system->friction_anchors;
    char both[2][CS_HASH_DIGITS];
    cs_hash_doubles(run->x, 6 * (size_t)run->system->view.n, digits);
    const struct cs_seams *seams = run->system->seams;
    for (int k = 0; k < 2; k++) {
        if (k ? !seams || !seams->n_broken : !anchors)
            continue;
        memcpy(both[0], digits, CS_HASH_DIGITS);
        if (k)
            cs_hash_bytes(seams->broken, seams->n * sizeof *seams->broken, both[1]);
        else
            cs_hash_doubles(anchors->values, anchors->n_values, both[1]);
        cs_hash_bytes(both, sizeof both, digits);
    }
}

void cs_run_note(struct cs_run *run, const char *format, ...) {
    char message[sizeof run->notes[0]];
    CS_FORMAT(message, format);
    run->host->table.note(run->host, "%s", message);
}

/* destroy comes before the arena is freed, since the method's object lies in it. */
void cs_run_finish(struct cs_run *run) {
    if (!run->host)
        return;
    if (run->host->settings.pot)
        *run->host->settings.pot -= cs_run_host_work_seconds(run->host);
    if (run->integrator->destroy && run->host->self) {
        const struct cs_process_state before = cs_process_state_save();
        watch(run, "in destroy");
        run->integrator->destroy(run->host->self);
        cs_crash_forget(CS_CRASH_METHOD);
        const char *changed = cs_process_state_restore(&before);
        if (changed)
            cs_crash_end(CS_CRASH_METHOD, changed);
    }
    cs_arena_finish(&run->host->arena);
    cs_view_pages_finish(&run->host->pages);
    free(run->host);
    *run = (struct cs_run){0};
}
