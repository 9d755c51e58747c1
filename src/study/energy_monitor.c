/* Judges by energy alone whether a run is sound; the header derives the limits. */
#include "study/energy_monitor.h"

#include "base/table.h"
#include "model/event/event_state.h"
#include "model/event/events.h"
#include "model/force/terms.h"

#include <math.h>
#include <stdlib.h>

/* Safety factors of the limits of energy and speed. */
#define ENERGY_FACTOR 2
#define SPEED_FACTOR  3
/* Ratio of the fastest particle to the root mean square speed of all in sound motions. */
#define SPEED_SPREAD 4
#define LEAST_ENERGY 1e-12
#define LEAST_SPEED  1e-6

/* Length of a vector. */
static double length_of(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Largest speed in m/s that the springs at one particle could give it: sqrt(2 E / m) with the
 * elastic energy E of all its springs. CS_ERR_MEMORY. */
static enum cs_status spring_speed(const struct cs_run *run, double *speed,
                                   struct cs_error *error) {
    const struct cs_system *system = run->system;
    const size_t n = system->view.n;
    double *stored = calloc(n, sizeof *stored);
    if (!stored)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu particles", n);
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *s = system->springs.runs + r;
        for (uint32_t i = 0; i < s->count; i++) {
            const uint32_t a = cs_spring_a(s, i), b = cs_spring_b(s, i);
            const double d[3] = {run->x[b] - run->x[a], run->x[n + b] - run->x[n + a],
                                 run->x[2 * n + b] - run->x[2 * n + a]};
            const double stretch = length_of(d) - cs_spring_length(s, i);
            const double energy = 0.5 * cs_spring_stiffness(s, i) * stretch * stretch;
            /* the whole energy at both ends: either particle may get all of it */
            stored[a] += energy;
            stored[b] += energy;
        }
    }
    double squared = 0;
    for (size_t i = 0; i < n; i++)
        squared = fmax(squared, 2 * stored[i] * system->inv_mass[i]);
    *speed = sqrt(squared);
    free(stored);
    return CS_OK;
}

/* Largest acceleration in m/s2 of particle i by forces that have an energy (gravity), or by the
 * others (wind). */
static double force_acceleration(const struct cs_system *system, size_t i, bool with_energy) {
    double push = 0;
    for (uint32_t k = 0; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        if (term->max_acceleration && !!term->energy == with_energy)
            push += term->max_acceleration(system, i) * system->inv_mass[i];
    }
    return push;
}

/* Largest acceleration in m/s2 by viewpoint forces, as if the particle were visible to all. */
static double visible_force(const struct cs_system *system, size_t i) {
    const struct cs_events *events = system->events;
    return events && events->viewpoint_forces
               ? cs_viewpoint_forces_force(events->viewpoint_forces, system->scene) *
                     system->inv_mass[i]
               : 0;
}

/* Restarts the account from the present state. wind_mass is sum m a^2 in kg m2/s4: half of it
 * times t^2 is the energy B of the header. */
static void start(struct cs_energy_monitor *monitor, const struct cs_run *run) {
    const struct cs_system *system = run->system;
    const struct cs_energy energy = cs_diagnostics_energy(system, run->t, run->x, run->v);
    uint32_t particle, count;
    monitor->t_begin = run->t;
    monitor->start_energy = cs_energy_without_gravity(&energy);
    monitor->gravity = energy.gravity;
    monitor->gravity_released = 0;
    monitor->start_speed = fmax(monitor->start_speed,
                                cs_measure_speed(system, run->v, HUGE_VAL, &particle, &count));
    monitor->gravity_acceleration = monitor->force_acceleration = monitor->mass =
        monitor->wind_mass = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        /* pinned particles do not move, whatever pushes them */
        if (system->inv_mass[i] <= 0)
            continue;
        const double push = force_acceleration(system, i, false) + visible_force(system, i);
        monitor->gravity_acceleration =
            fmax(monitor->gravity_acceleration, force_acceleration(system, i, true));
        monitor->force_acceleration = fmax(monitor->force_acceleration, push);
        monitor->mass += system->mass[i];
        monitor->wind_mass += system->mass[i] * push * push;
    }
}

enum cs_status cs_energy_monitor_begin(struct cs_energy_monitor *monitor,
                                       const struct cs_run *run, struct cs_error *error) {
    double speed = 0;
    *monitor = (struct cs_energy_monitor){0};
    if (spring_speed(run, &speed, error))
        return error->status;
    start(monitor, run);
    monitor->start_speed += speed;
    return CS_OK;
}

/* True if an event since the last sample may have added energy. */
static bool has_event_since(const struct cs_energy_monitor *monitor, const struct cs_run *run) {
    const struct cs_events *events = run->system->events;
    return events && (events->begin >= monitor->last_sample || events->has_ramps ||
                      cs_events_speed(run->system) > 0);
}

/* Available kinetic and elastic energy in J at t seconds after the restart. */
static double available(const struct cs_energy_monitor *monitor, double t) {
    /* the wind's work, were it to push all the way in free flight */
    const double blown = monitor->wind_mass * t * t / 2;
    return monitor->start_energy + monitor->gravity_released + blown +
           sqrt(2 * blown * 2 * (monitor->start_energy + monitor->gravity_released));
}

void cs_energy_monitor_sample(struct cs_energy_monitor *monitor, const struct cs_run *run,
                              struct cs_energy_monitor_row *row) {
    const struct cs_system *system = run->system;
    *row = (struct cs_energy_monitor_row){.t = run->t};
    row->energy = cs_diagnostics_energy(system, run->t, run->x, run->v);
    row->strain = cs_diagnostics_strain(system, run->x);
    /* no bound holds after an event has added energy: restart */
    if (has_event_since(monitor, run))
        start(monitor, run);
    monitor->last_sample = run->t;
    monitor->gravity_released =
        fmax(monitor->gravity_released, monitor->gravity - row->energy.gravity);
    const double passed = run->t - monitor->t_begin;
    const double energy = fmax(available(monitor, passed), LEAST_ENERGY);
    const double mean = monitor->mass > 0 ? sqrt(2 * energy / monitor->mass) : 0;
    /* what the forces can have added, at most a few times the mean that the energy allows */
    const double fall =
        fmin((monitor->gravity_acceleration + monitor->force_acceleration) * passed,
             SPEED_SPREAD * mean);
    row->energy_limit = ENERGY_FACTOR * energy;
    row->speed_limit = SPEED_FACTOR * fmax(monitor->start_speed + fall, LEAST_SPEED);
    row->speed =
        cs_measure_speed(system, run->v, row->speed_limit, &row->particle, &row->particles);
    const double held = cs_energy_without_gravity(&row->energy);
    /* first, because no comparison with NAN is true */
    if (!isfinite(held + row->speed + row->strain))
        row->verdict = CS_STABILITY_NOT_FINITE;
    else if (held > row->energy_limit)
        row->verdict = CS_STABILITY_GLOBAL;
    else if (row->particles)
        row->verdict = CS_STABILITY_LOCAL;
    if (row->verdict > monitor->worst_verdict)
        monitor->worst_verdict = row->verdict;
    if (row->verdict >= CS_STABILITY_LOCAL && !monitor->has_local_instability) {
        monitor->has_local_instability = true;
        monitor->first = *row;
    }
}

void cs_energy_monitor_print(const struct cs_energy_monitor *monitor,
                             const struct cs_system *system, struct cs_text *out) {
    const struct cs_energy_monitor_row *first = &monitor->first;
    if (!monitor->has_local_instability)
        return;
    cs_text_add(out, "%s from t = %.6g s on: ", cs_stability_word(first->verdict), first->t);
    if (first->verdict == CS_STABILITY_GLOBAL)
        cs_text_add(out, "kinetic + elastic energy %.3g J exceeds the possible %.3g J",
                    cs_energy_without_gravity(&first->energy),
                    first->energy_limit / ENERGY_FACTOR);
    else {
        cs_text_add(out, "%u particle%s, the fastest ", first->particles,
                    first->particles == 1 ? "" : "s");
        cs_system_print_particle(system, first->particle, out);
        cs_text_add(out, " at %.3g m/s, above the limit of %.3g m/s", first->speed,
                    first->speed_limit);
    }
    if (monitor->worst_verdict > first->verdict)
        cs_text_add(out, "; later %s", cs_stability_word(monitor->worst_verdict));
}

void cs_energy_monitor_print_head(struct cs_text *out) {
    cs_text_add(out, "frame,t,kinetic,elastic,gravity,energy,largest_strain,largest_velocity,"
                     "particle,fast_particles,verdict\n");
}

void cs_energy_monitor_print_row(const struct cs_energy_monitor_row *row, uint32_t frame,
                                 struct cs_text *out) {
    const struct cs_energy *energy = &row->energy;
    const double values[] = {row->t,          energy->kinetic,         energy->elastic,
                             energy->gravity, cs_energy_total(energy), row->strain,
                             row->speed};
    cs_text_add(out, "%u", frame);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++)
        cs_csv_add_number(out, values[k]);
    cs_text_add(out, ",%u,%u,%s\n", row->particle, row->particles,
                cs_stability_word(row->verdict));
}
