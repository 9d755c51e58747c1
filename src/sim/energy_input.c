/* energy_input.c - energy that the scene gives to the motion, in every run; run_host.h has the
 * equations.
 *
 * The powers come with the forces that the method asks for. A step costs a sum over the
 * particles, and only if something can give energy. What needs evaluations of its own waits
 * until the method has done SHARE times their work. */
#include "model/contact/rebound.h"
#include "model/event/events.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "scene/body_pairs.h"
#include "sim/run_host.h"

#include <string.h>

/* Passes over the forces that a method must have made for each one of the account. Two
 * energies count as ENERGIES. */
enum { SHARE = 33, ENERGIES = 2 };

/* Tells whether something may do work by a force: wind, pushes, or what moves. */
static bool has_powers(const struct cs_system *system) {
    bool found = system->events || cs_scene_has_key_frames(system->scene);
    for (uint32_t k = 0; k < system->n_terms; k++)
        found |= !!(system->terms[k]->part_bits & (CS_PART_WIND | CS_PART_EXTERNAL));
    return found;
}

/* Kinetic energy in J of the pinned particles, and of those led out: it changes only if
 * their path turns. */
static void find_pinned_energy(const struct cs_system *system, const double *v,
                               double energy[2]) {
    const size_t n = system->view.n;
    const bool turns = system->events && system->events->has_turns;
    energy[0] = energy[1] = 0;
    for (uint32_t p = 0; turns && p < system->n_pinned; p++)
        for (size_t k = system->pinned[p]; k < 3 * n; k += n)
            energy[cs_system_is_led_out(system, system->pinned[p])] +=
                0.5 * system->mass[system->pinned[p]] * v[k] * v[k];
}

/* J, all potentials. */
static double potential(const struct cs_system *system, double t, const double *x,
                        const double *v) {
    const struct cs_energy energy = cs_diagnostics_energy(system, t, x, v);
    return energy.elastic + energy.gravity + energy.other;
}

static double total(const struct cs_run_host *host, double t) {
    const struct cs_energy energy =
        cs_diagnostics_energy(host->run->system, t, host->run->x, host->run->v);
    return cs_energy_total(&energy);
}

enum cs_status cs_energy_input_init(struct cs_run_host *host, struct cs_error *error) {
    const struct cs_system *system = host->run->system;
    const struct cs_plan_row *rows = system->plan.rows;
    host->corrects = rows[CS_FEATURE_CONTACT].built || rows[CS_FEATURE_STRAIN_LIMIT].built;
    host->power_by_end = (host->run->integrator->traits & CS_IMPLICIT) &&
                         (system->events || cs_scene_has_key_frames(system->scene));
    if (has_powers(system))
        CS_ARENA_ARRAY(&host->arena, host->power, 4 * (size_t)system->view.n, error);
    return error->status;
}

struct cs_eval cs_energy_input_eval(struct cs_run_host *host, double t, const double *x,
                                    const double *v, uint32_t parts) {
    const bool all = parts == CS_PART_ALL;
    host->power_is_set |= all;
    host->power_t = all ? t : host->power_t;
    return (struct cs_eval){
        .t = t, .x = x, .v = v, .parts = parts, .power = all ? host->power : NULL};
}

/* Passes over the forces that the method has made so far. */
static double passes(struct cs_run_host *host) {
    cs_run_host_count(host);
    return cs_counts_work(&host->run->counts);
}

/* Books the work of forces over a step of length dt, by the power at its end: the force that
 * the method asked for last, or one evaluation if it made many others or none. */
static void book_powers(struct cs_run_host *host, double t, double dt, const double *x,
                        const double *v) {
    struct cs_energy_input *input = &host->run->energy_input;
    const struct cs_system *system = host->run->system;
    const size_t n = system->view.n;
    const double work = passes(host);
    if (!host->power_is_set || (host->power_by_end && host->power_t != t) ||
        work - input->powers_work >= SHARE) {
        const struct cs_eval at = {
            .t = t, .x = x, .v = v, .parts = CS_PART_ALL, .power = host->power};
        if (cs_terms_need_normals(system, CS_PART_ALL))
            cs_normals_update(host->run->system, x);
        cs_terms_force(system, &at, host->power + n);
    }
    const struct cs_rebound *impacts = host->has_impact ? system->rebounds->list : NULL;
    double power = 0, led = 0;
    for (size_t i = 0; i < n; i++)
        *(cs_system_is_led_out(system, (uint32_t)i) ? &led : &power) +=
            impacts && impacts[i].collider ? 0 : host->power[i];
    input->given[CS_SOURCE_FORCES] += (impacts ? host->impact_work : 0) + dt * power;
    input->given[CS_SOURCE_UNTANGLE] += dt * led;
    host->has_impact = false;
    input->powers_work = work;
    host->power_is_set = false;
}

/* Books the change of the potentials by ramps since the last time, at the present positions. */
static void book_values(struct cs_run_host *host, double t, const double *x, const double *v) {
    struct cs_energy_input *input = &host->run->energy_input;
    const struct cs_system *system = host->run->system;
    if (!system->events->has_ramps) {
        input->values_t = t;
        return;
    }
    const double work = passes(host);
    if (work - input->values_work < SHARE * ENERGIES && t < system->events->end)
        return;
    cs_events_move_values(host->run->system, input->values_t);
    const double before = potential(system, t, x, v);
    cs_events_move_values(host->run->system, t);
    input->given[CS_SOURCE_VALUES] += potential(system, t, x, v) - before;
    input->values_t = t;
    input->values_work = work;
}

void cs_energy_input_step(struct cs_run_host *host, double t, double dt, const double *x,
                          const double *v) {
    struct cs_energy_input *input = &host->run->energy_input;
    if (host->power)
        book_powers(host, t, dt, x, v);
    if (host->run->system->events) {
        double pinned[2];
        find_pinned_energy(host->run->system, v, pinned);
        input->given[CS_SOURCE_FORCES] += pinned[0] - input->pinned[0];
        input->given[CS_SOURCE_UNTANGLE] += pinned[1] - input->pinned[1];
        memcpy(input->pinned, pinned, sizeof pinned);
        book_values(host, t, x, v);
    }
    if (!host->corrects)
        return;
    input->corrected_steps++;
    input->kinetic = cs_measure_kinetic(host->run->system, v);
    const double work = passes(host);
    input->is_sampled = work - input->corrections_work >= SHARE * ENERGIES;
    if (input->is_sampled) {
        input->potential = potential(host->run->system, t, x, v);
        input->corrections_work = work;
    }
}

void cs_energy_input_corrections(struct cs_run_host *host, double t, const double *x,
                                 const double *v) {
    struct cs_energy_input *input = &host->run->energy_input;
    if (!host->corrects)
        return;
    input->given[CS_SOURCE_CORRECTIONS] +=
        cs_measure_kinetic(host->run->system, v) - input->kinetic;
    if (!input->is_sampled)
        return;
    input->given[CS_SOURCE_CORRECTIONS] +=
        input->corrected_steps * (potential(host->run->system, t, x, v) - input->potential);
    input->corrected_steps = 0;
}

bool cs_energy_input_events(struct cs_run_host *host, double t) {
    struct cs_energy_input *input = &host->run->energy_input;
    const double before = total(host, t);
    const struct cs_events *events = host->run->system->events;
    const bool leads = events->begin < events->untangled;
    if (!cs_events_apply(host->run->system, t))
        return false;
    // particles that arrive meet contact
    const bool arrive = leads && events->begin >= events->untangled;
    input->given[arrive ? CS_SOURCE_UNTANGLE : CS_SOURCE_EVENTS] += total(host, t) - before;
    find_pinned_energy(host->run->system, host->run->v, input->pinned);
    input->values_t = t;
    host->power_is_set = false;
    return true;
}
