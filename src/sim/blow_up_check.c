/* blow_up_check.c - detects a blow-up; the bound is derived in blow_up_check.h. */
#include "sim/blow_up_check.h"

#include "base/vector.h"
#include "model/event/events.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/system/shape_clusters.h"

#include <math.h>
#include <string.h>

/* The bound on kinetic energy at t, in J. */
static double energy_at(const struct cs_blow_up_check *bound, double t) {
    const double pushed = bound->force_gain + sqrt(bound->force_rate) * (t - bound->t_forces);
    return 100 * (bound->start_energy + bound->speed + pushed * pushed);
}

/* Sum of F^2 / m in J/s2, F the sum of the greatest forces that the terms can exert on a
 * particle. Forces that give none only convert energy that is there, or take it away. */
static double force_power_bound(const struct cs_system *system) {
    double sum = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        double push = 0;
        for (uint32_t k = 0; k < system->n_terms; k++)
            if (system->terms[k]->max_acceleration)
                push += system->terms[k]->max_acceleration(system, i);
        sum += push * push / system->mass[i];
    }
    return sum;
}

void cs_blow_up_check_set(struct cs_blow_up_check *bound, const struct cs_system *system,
                          double t) {
    const double *x = system->state, *v = x + 3 * (size_t)system->view.n;
    const struct cs_energy energy = cs_diagnostics_energy(system, t, x, v);
    *bound = (struct cs_blow_up_check){
        .start_energy = energy.elastic + energy.other +
                        cs_springs_energy_at_twice(&system->springs) +
                        cs_shape_clusters_energy(system),
        .speed = 2 * energy.kinetic,
        .force_rate = force_power_bound(system),
        .t_forces = t,
    };
}

/* Continues the bound from t on with other forces: closes the piece before t, and takes the
 * larger rate of those now and at the end of the ramps. Leaves the values at t. */
static void follow_looks(struct cs_blow_up_check *bound, struct cs_system *system, double t) {
    bound->force_gain += sqrt(bound->force_rate) * (t - bound->t_forces);
    bound->t_forces = t;
    bound->force_rate = force_power_bound(system);
    cs_events_move_values(system, system->events->end);
    bound->force_rate = fmax(bound->force_rate, force_power_bound(system));
    cs_events_move_values(system, t);
}

/* Two bounds are made, with the values at the begin and at the end of the segment that begins,
 * and the larger energies and forces count: ramps are linear, and each force grows with its
 * value. The speed w of paths adds 2 m w^2 for every particle, since a grab may pull all along.
 */
void cs_blow_up_check_after_events(struct cs_blow_up_check *bound, struct cs_system *system,
                                   double t) {
    struct cs_blow_up_check now;
    if (system->events->begin < t) {
        follow_looks(bound, system, t);
        return;
    }
    cs_blow_up_check_set(&now, system, t);
    cs_events_move_values(system, system->events->end);
    cs_blow_up_check_set(bound, system, t);
    cs_events_move_values(system, t);
    bound->start_energy = fmax(bound->start_energy, now.start_energy);
    bound->force_rate = fmax(bound->force_rate, now.force_rate);
    const double speed = cs_events_speed(system);
    for (size_t i = 0; i < system->view.n; i++)
        bound->speed += 2 * system->mass[i] * speed * speed;
}

typedef double lanes __attribute__((vector_size(2 * sizeof(double))));

static inline lanes load(const double *from) {
    lanes out;
    memcpy(&out, from, sizeof out);
    return out;
}

/* The state to check, component-major. */
struct watched {
    size_t n;
    const double *mass, *x, *v;
};

/* Kinetic energy in J of the particles [begin, end); not finite if a position or velocity
 * there is not: s - s is 0 for a finite s = x + y + z, else NaN. In lanes, because it runs
 * after every step. */
static double watch_part(const void *arg, size_t begin, size_t end) {
    enum { LANES = sizeof(lanes) / sizeof(double) };
    const struct watched *watched = arg;
    const size_t n = watched->n;
    const double *mass = watched->mass, *x = watched->x, *v = watched->v;
    /* two sums of each, so that one addition need not wait for the one before */
    lanes e[2] = {{0}}, p[2] = {{0}};
    size_t i = begin;
    for (; i + 2 * LANES <= end; i += 2 * LANES)
        for (size_t k = 0; k < 2; k++) {
            const size_t at = i + k * LANES;
            const lanes a = load(v + at), b = load(v + n + at), c = load(v + 2 * n + at);
            const lanes sum = load(x + at) + load(x + n + at) + load(x + 2 * n + at);
            e[k] += load(mass + at) * (a * a + b * b + c * c);
            p[k] += sum - sum;
        }
    double energy = e[0][0] + e[0][1] + e[1][0] + e[1][1];
    double places = p[0][0] + p[0][1] + p[1][0] + p[1][1];
    for (; i < end; i++) {
        const double sum = x[i] + x[n + i] + x[2 * n + i];
        energy += mass[i] * (v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        places += sum - sum;
    }
    return 0.5 * energy + places;
}

/* Kinetic energy decides: a number that is not finite anywhere makes it so. */
bool cs_blow_up_check_step(const struct cs_blow_up_check *bound, struct cs_run *run, double t,
                           const double *x, const double *v) {
    const size_t n = run->system->view.n;
    const struct watched watched = {n, run->system->mass, x, v};
    const double energy = cs_vector_sum(n, watch_part, &watched), most = energy_at(bound, t);
    // NaN is not <= most
    if (energy <= most)
        return false;

    /* report the first particle that is not finite, else the fastest */
    uint32_t worst = 0;
    double fastest = -1;
    run->outcome = CS_UNBOUNDED;
    for (size_t i = 0; i < n && run->outcome == CS_UNBOUNDED; i++) {
        const double speed = v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i];
        const double place = x[i] + x[n + i] + x[2 * n + i];
        if (speed > fastest || !isfinite(speed + place)) {
            fastest = speed;
            worst = (uint32_t)i;
        }
        if (!isfinite(speed + place))
            run->outcome = CS_NOT_FINITE;
    }
    run->blow_up = (struct cs_blow_up){t, worst, energy, most};
    return true;
}
