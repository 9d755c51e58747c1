/* Measures a state: energies, strains and forces. */
#include "model/force/diagnostics.h"

#include "model/elastic/membrane_forces.h"
#include "model/force/terms.h"
#include "scene/body_keys.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* In the order of the particles, by one thread: the sum has one order. */
double cs_measure_kinetic(const struct cs_system *system, const double *v) {
    const size_t n = system->view.n;
    double energy = 0;
    for (size_t i = 0; i < n; i++)
        energy += 0.5 * system->mass[i] *
                  (v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
    return energy;
}

/* Each force adds its energy to the member of its kind. */
struct cs_energy cs_diagnostics_energy(const struct cs_system *system, double t,
                                       const double *x, const double *v) {
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = CS_PART_ALL};
    struct cs_energy energy = {.kinetic = cs_measure_kinetic(system, v)};
    double *const kinds[CS_ENERGIES] = {[CS_ENERGY_ELASTIC] = &energy.elastic,
                                        [CS_ENERGY_GRAVITY] = &energy.gravity,
                                        [CS_ENERGY_OTHER] = &energy.other};
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->energy)
            *kinds[system->terms[k]->energy_kind] += system->terms[k]->energy(system, &at);
    return energy;
}

/* l / L - 1 of spring i of a run. */
static double strain_of(const struct cs_spring_run *run, size_t n, const double *x,
                        uint32_t i) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = x[c * n + cs_spring_b(run, i)] - x[c * n + cs_spring_a(run, i)];
        squared += d * d;
    }
    return sqrt(squared) / cs_spring_length(run, i) - 1;
}

double cs_diagnostics_shortest(const struct cs_system *system) {
    const double springs = system->springs.n ? cs_springs_shortest(&system->springs) : HUGE_VAL;
    const double shortest =
        system->membranes ? fmin(springs, system->membranes->shortest) : springs;
    return isfinite(shortest) ? shortest : 0;
}

double cs_diagnostics_strain(const struct cs_system *system, const double *x) {
    return fmax(cs_springs_largest_strain(&system->springs, system->view.n, x),
                cs_membranes_largest_strain(system, x, false));
}

double cs_diagnostics_extension(const struct cs_system *system, const double *x) {
    double largest = cs_membranes_largest_strain(system, x, true);
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        const bool is_soft = cs_scene_bodies(system->scene)[run->body].network.present;
        for (uint32_t i = 0; !is_soft && i < run->count; i++)
            largest = fmax(largest, strain_of(run, system->view.n, x, i));
    }
    return largest;
}

/* Comparisons are negated, to count a NaN as too fast. */
double cs_measure_speed(const struct cs_system *system, const double *v, double limit,
                        uint32_t *fastest, uint32_t *count) {
    const size_t n = system->view.n;
    double largest = -1;
    *fastest = *count = 0;
    for (size_t i = 0; i < n; i++) {
        const double speed =
            sqrt(v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        *count += !(speed <= limit);
        if (!(speed <= largest)) {
            largest = speed;
            *fastest = (uint32_t)i;
        }
    }
    return largest;
}

void cs_diagnostics_particle_strain(const struct cs_system *system, const double *x,
                                    double *out) {
    for (uint32_t i = 0; i < system->view.n; i++)
        out[i] = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const double strain = strain_of(run, system->view.n, x, i);
            const uint32_t ends[2] = {cs_spring_a(run, i), cs_spring_b(run, i)};
            for (int e = 0; e < 2; e++)
                if (fabs(strain) > fabs(out[ends[e]]))
                    out[ends[e]] = strain;
        }
    }
    cs_membranes_particle_strain(system, x, out);
}

void cs_diagnostics_particle_force(const struct cs_system *system, double t, const double *x,
                                   const double *v, double *out, double *work) {
    const size_t n = system->view.n;
    if (cs_terms_need_normals(system, CS_PART_ALL))
        cs_normals_update(system, x);
    cs_terms_force(system, &(struct cs_eval){.t = t, .x = x, .v = v, .parts = CS_PART_ALL},
                   work);
    for (size_t i = 0; i < n; i++)
        out[i] = sqrt(work[i] * work[i] + work[n + i] * work[n + i] +
                      work[2 * n + i] * work[2 * n + i]);
}

void cs_diagnostics_range(const double *values, uint32_t n, double range[2]) {
    range[0] = range[1] = n > 0 ? values[0] : 0;
    for (uint32_t i = 0; i < n; i++) {
        range[0] = fmin(range[0], values[i]);
        range[1] = fmax(range[1], values[i]);
    }
}

/* Bits of a magnitude as a float. For numbers without sign, bits as integers are ordered as the
 * numbers. */
static uint32_t key_of(double value) {
    const float magnitude = (float)fabs(value);
    uint32_t key;
    memcpy(&key, &magnitude, sizeof key);
    return key;
}

/* Radix selection: eight bits at a time from the highest, counts the keys that share the bits
 * found so far, and finds the digit of the wanted rank. Four passes, no memory, and the same
 * result for any order of the values. 0x7f800000 is the key of infinity; NaNs are above it. */
double cs_diagnostics_magnitude(const double *values, uint32_t n) {
    static const uint32_t infinite = 0x7f800000;
    uint32_t prefix = 0, known = 0, rank = 0;
    float found;
    for (uint32_t i = 0; i < n; i++)
        rank += key_of(values[i]) < infinite;
    if (rank == 0)
        return 0;
    rank -= 1 + (rank - 1) / 100;
    for (int shift = 24; shift >= 0; shift -= 8) {
        uint32_t counts[256] = {0}, digit = 0;
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t key = key_of(values[i]);
            counts[key >> shift & 255] += key < infinite && (key & known) == prefix;
        }
        while (rank >= counts[digit])
            rank -= counts[digit++];
        prefix |= digit << shift;
        known |= 255u << shift;
    }
    memcpy(&found, &prefix, sizeof found);
    return (double)found;
}

/* --- bounds on frequencies and damping rates by Gershgorin's circles, from all forces --- */

/* The sums in work (2n), zeroed. */
static struct cs_gershgorin start_sums(const struct cs_system *system, double *work) {
    const size_t n = system->view.n;
    memset(work, 0, 2 * n * sizeof *work);
    return (struct cs_gershgorin){work, work + n};
}

/* Largest row sum over mass, of stiffness, and half of that of damping. Pinned particles have
 * the inverse mass 0 and do not count. */
static void take_largest(const struct cs_system *system, const struct cs_gershgorin *sums,
                         double *squared, double *delta) {
    *squared = *delta = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        *squared = fmax(*squared, sums->stiffness[i] * system->inv_mass[i]);
        *delta = fmax(*delta, 0.5 * sums->damping[i] * system->inv_mass[i]);
    }
}

/* Adds the bounds of one force: at a state, or those for the whole run. */
static void add_term(const struct cs_system *system, const struct cs_term *term,
                     const struct cs_eval *at, const struct cs_gershgorin *sums) {
    if (at && term->add_state_bound)
        term->add_state_bound(system, at, sums);
    else if (term->add_bound)
        term->add_bound(system, sums);
}

void cs_spectral_bounds_at(const struct cs_system *system, const struct cs_eval *at,
                           double *work, double *omega, double *delta) {
    const struct cs_gershgorin sums = start_sums(system, work);
    double squared;
    for (uint32_t k = 0; k < system->n_terms; k++)
        add_term(system, system->terms[k], at, &sums);
    take_largest(system, &sums, &squared, delta);
    *omega = sqrt(squared);
}

/* Tells whether a force has bounds only at a state. */
static bool has_rate(const struct cs_term *term) {
    return term->add_state_bound && !term->add_bound;
}

/* Tells whether a force has bounds at a state; both: for the run too, so that the bound at the
 * state may be the larger one. */
static bool any_at_state(const struct cs_system *system, bool both) {
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->add_state_bound && (!both || system->terms[k]->add_bound))
            return true;
    return false;
}

bool cs_spectral_bounds_depend_on_state(const struct cs_system *system) {
    return any_at_state(system, false);
}

bool cs_spectral_bounds_can_jump(const struct cs_system *system) {
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (has_rate(system->terms[k]))
            return true;
    return false;
}

/* Takes friction as far as it limits the step of an explicit method. sums: of contact alone,
 * where a damper has contact.damping times the stiffness, and friction the rest. */
static void limit_friction(const struct cs_system *system, const struct cs_gershgorin *sums) {
    const struct cs_contact_keys *contact = system->scene->contact;
    const double *g = system->scene->forces->gravity;
    const double weight = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]),
                 rest = CS_FRICTION_REST_LOADS * weight / contact->friction_speed;
    for (size_t i = 0; i < system->view.n; i++) {
        const double k = sums->stiffness[i], root = sqrt(k * system->mass[i]);
        const double most = fmax(CS_FRICTION_IMPACT_RATIO * root,
                                 fmin(CS_FRICTION_RATE_RATIO * root, rest * system->mass[i]));
        sums->damping[i] = fmin(sums->damping[i], contact->damping * k + most);
    }
}

void cs_spectral_bounds_rate(const struct cs_system *system, const struct cs_eval *at,
                             bool is_explicit, double *work, double *omega, double *delta) {
    const struct cs_gershgorin sums = start_sums(system, work);
    const bool varies = any_at_state(system, true);
    double squared;
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (has_rate(system->terms[k]))
            add_term(system, system->terms[k], at, &sums);
    if (is_explicit)
        limit_friction(system, &sums);
    for (uint32_t k = 0; k < system->n_terms && varies; k++)
        if (!has_rate(system->terms[k]))
            add_term(system, system->terms[k], at, &sums);
    take_largest(system, &sums, &squared, delta);
    const double least = system->view.omega;
    // triangle inequality: the bounds of omega^2 and of delta add up
    *omega = varies ? fmax(sqrt(squared), least) : sqrt(least * least + squared);
    *delta = varies ? fmax(*delta, system->view.delta) : *delta + system->view.delta;
}

void cs_spectral_bounds_set(struct cs_system *system, double *work) {
    cs_spectral_bounds_at(system, NULL, work, &system->view.omega, &system->view.delta);
}

void cs_diagnostics_force(const struct cs_system *system, double t, const double *x,
                          const double *v, uint32_t parts, double *f) {
    struct cs_system free = *system;
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = parts};
    free.n_pinned = 0;
    if (cs_terms_need_normals(&free, parts))
        cs_normals_update(&free, x);
    cs_terms_force(&free, &at, f);
}

void cs_diagnostics_add_moment(const struct cs_system *system, const double *weight,
                               double factor, const double *a, const double *b, double sum[3]) {
    const size_t n = system->view.n;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++) {
            const size_t y = (c + 1) % 3 * n + i, z = (c + 2) % 3 * n + i;
            sum[c] += factor * (weight ? weight[i] : 1) * (a[y] * b[z] - a[z] * b[y]);
        }
}
