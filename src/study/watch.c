/* Judges by its energy alone whether a run is still sound. */
#include "study/watch.h"

#include "base/table.h"
#include "model/event/events.h"
#include "model/event/viewpoint_forces.h"
#include "model/force/terms.h"

#include <math.h>
#include <stdlib.h>

/* how far above what is physically possible a number must be to be called an instability */
#define ENERGY_FACTOR 2
#define SPEED_FACTOR  3
/* fastest particle over the mean speed of all, in motions that are sound */
#define SPEED_SPREAD 4
#define LEAST_ENERGY 1e-12
#define LEAST_SPEED  1e-6

static double length_of(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* speed that the energy of the springs at one particle would give it, the largest of all */
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

/* largest acceleration in m/s2 of a particle by forces with an energy, or by the others */
static double push_of(const struct cs_system *system, size_t i, bool with_energy) {
    double push = 0;
    for (uint32_t k = 0; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        if (term->strongest && !!term->energy == with_energy)
            push += term->strongest(system, i) * system->inv_mass[i];
    }
    return push;
}

/* and by the viewpoint forces, were it seen by all */
static double seen_push(const struct cs_system *system, size_t i) {
    const struct cs_events *events = system->events;
    return events && events->viewpoint_forces
               ? cs_viewpoint_forces_force(events->viewpoint_forces, system->scene) *
                     system->inv_mass[i]
               : 0;
}

/* from what there is now */
static void start(struct cs_watch *watch, const struct cs_run *run) {
    const struct cs_system *system = run->system;
    const struct cs_energy energy = cs_measure_energy(system, run->t, run->x, run->v);
    uint32_t particle, count;
    watch->since = run->t;
    watch->held = cs_energy_held(&energy);
    watch->gravity = energy.gravity;
    watch->released = 0;
    watch->start_speed =
        fmax(watch->start_speed, cs_measure_speed(system, run->v, HUGE_VAL, &particle, &count));
    watch->pull = watch->push = watch->mass = watch->wind_mass = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        /* pinned particles do not move, whatever pushes them */
        if (system->inv_mass[i] <= 0)
            continue;
        const double push = push_of(system, i, false) + seen_push(system, i);
        watch->pull = fmax(watch->pull, push_of(system, i, true));
        watch->push = fmax(watch->push, push);
        watch->mass += system->mass[i];
        watch->wind_mass += system->mass[i] * push * push;
    }
}

enum cs_status cs_watch_begin(struct cs_watch *watch, const struct cs_run *run,
                              struct cs_error *error) {
    double speed = 0;
    *watch = (struct cs_watch){0};
    if (spring_speed(run, &speed, error))
        return error->status;
    start(watch, run);
    watch->start_speed += speed;
    return CS_OK;
}

/* an event did something since the last look that no bound knows of */
static bool is_disturbed(const struct cs_watch *watch, const struct cs_run *run) {
    const struct cs_events *events = run->system->events;
    return events && (events->begin >= watch->looked || events->ramps ||
                      cs_events_speed(run->system) > 0);
}

/* kinetic and elastic energy that there can be */
static double available(const struct cs_watch *watch, double t) {
    /* the wind's work, were it to push all the way in free flight */
    const double blown = watch->wind_mass * t * t / 2;
    return watch->held + watch->released + blown +
           sqrt(2 * blown * 2 * (watch->held + watch->released));
}

void cs_watch_look(struct cs_watch *watch, const struct cs_run *run, struct cs_watch_row *row) {
    const struct cs_system *system = run->system;
    *row = (struct cs_watch_row){.t = run->t};
    row->energy = cs_measure_energy(system, run->t, run->x, run->v);
    row->strain = cs_measure_strain(system, run->x);
    /* no bound knows what an event has added: the account starts anew */
    if (is_disturbed(watch, run))
        start(watch, run);
    watch->looked = run->t;
    watch->released = fmax(watch->released, watch->gravity - row->energy.gravity);
    const double passed = run->t - watch->since;
    const double energy = fmax(available(watch, passed), LEAST_ENERGY);
    const double mean = watch->mass > 0 ? sqrt(2 * energy / watch->mass) : 0;
    /* what the forces can have added, at most a few times the mean that the energy allows */
    const double fall = fmin((watch->pull + watch->push) * passed, SPEED_SPREAD * mean);
    row->energy_limit = ENERGY_FACTOR * energy;
    row->speed_limit = SPEED_FACTOR * fmax(watch->start_speed + fall, LEAST_SPEED);
    row->speed =
        cs_measure_speed(system, run->v, row->speed_limit, &row->particle, &row->particles);
    const double held = cs_energy_held(&row->energy);
    /* first, because no comparison with NAN is true */
    if (!isfinite(held + row->speed + row->strain))
        row->verdict = CS_STABILITY_NOT_FINITE;
    else if (held > row->energy_limit)
        row->verdict = CS_STABILITY_GLOBAL;
    else if (row->particles)
        row->verdict = CS_STABILITY_LOCAL;
    if (row->verdict > watch->worst)
        watch->worst = row->verdict;
    if (row->verdict >= CS_STABILITY_LOCAL && !watch->found) {
        watch->found = true;
        watch->first = *row;
    }
}

void cs_watch_print(const struct cs_watch *watch, const struct cs_system *system,
                    struct cs_text *out) {
    const struct cs_watch_row *first = &watch->first;
    if (!watch->found)
        return;
    cs_text_add(out, "%s from t = %.6g s on: ", cs_stability_word(first->verdict), first->t);
    if (first->verdict == CS_STABILITY_GLOBAL)
        cs_text_add(out, "%.3g J in motion and springs, where %.3g J can be",
                    cs_energy_held(&first->energy), first->energy_limit / ENERGY_FACTOR);
    else {
        cs_text_add(out, "%u particle%s, the fastest ", first->particles,
                    first->particles == 1 ? "" : "s");
        cs_system_print_particle(system, first->particle, out);
        cs_text_add(out, " at %.3g m/s beyond %.3g m/s", first->speed, first->speed_limit);
    }
    if (watch->worst > first->verdict)
        cs_text_add(out, "; later %s", cs_stability_word(watch->worst));
}

void cs_watch_print_head(struct cs_text *out) {
    cs_text_add(out, "frame,t,kinetic,elastic,gravity,energy,largest_strain,largest_velocity,"
                     "particle,fast_particles,verdict\n");
}

void cs_watch_print_row(const struct cs_watch_row *row, uint32_t frame, struct cs_text *out) {
    const struct cs_energy *energy = &row->energy;
    const double values[] = {row->t,          energy->kinetic,         energy->elastic,
                             energy->gravity, cs_energy_whole(energy), row->strain,
                             row->speed};
    cs_text_add(out, "%u", frame);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++)
        cs_csv_add_number(out, values[k]);
    cs_text_add(out, ",%u,%u,%s\n", row->particle, row->particles,
                cs_stability_word(row->verdict));
}
