/* projection_energy.c - energies before and after a correction, and its reduction if there is
 * too much; see projection_energy.h. */
#include "model/post_step/projection_energy.h"

#include "base/vec3.h"
#include "base/vector.h"
#include "model/force/diagnostics.h"
#include "model/post_step/tunnelling.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* Relative residual of the elastic response. It shapes a correction whose energy is checked
 * afterwards, so that few digits suffice. Chosen by trial. */
#define RTOL 1e-2

/* u (3,n) in m holds the pushes of the particles marked in pushed (n), and anything elsewhere.
 * Sets the other free particles to where they would be, had the pushes been forces in an
 * implicit Euler step of dt: the u with the smallest u^T A u / 2 for given pushes,
 *
 *   A = M + dt D + dt^2 K   at the state (x, v) of *matrix
 *
 * with pushed particles pinned (Baraff, Witkin 1998, sec. 5.3). A direction without stiffness
 * ends it early; u is then between start and solution. At pinned particles u is 0. */
static void response_solve(struct cs_elastic_response *response, const struct cs_matrix *matrix,
                           const bool *pushed, double *u) {
    const size_t n3 = 3 * (size_t)response->linear.system->view.n;
    uint64_t iterations;
    double residual;
    cs_temporary_pins_set(&response->pins, pushed);
    cs_linear_setup(&response->linear, matrix);
    for (size_t k = 0; k < n3; k++)
        u[k] = pushed[k % (n3 / 3)] ? u[k] : 0;
    cs_linear_mul(&response->linear, u, response->load);
    cs_vector_kernels.linear_sum(n3, -1, response->load, 0, u, response->load);
    memset(u, 0, n3 * sizeof *u);
    cs_linear_solve(&response->linear, response->load, RTOL, u, &iterations, &residual);
    cs_temporary_pins_clear(&response->pins, pushed);
}

/* Fraction of the energy lost since first contact that one commit may return, to lift particles
 * that are still behind a surface. Chosen by trial. */
#define GIVEN_BACK 0.01

/* Depth behind a collider from which on a particle is put on the surface whatever the energy,
 * the larger of both, in inner radii and in shortest springs: a limit by energy alone puts off
 * the rest for ever, and a sheet of 8 x 8 particles came through a ball. What lies inside a
 * collider thinner than a spring leaves it as energy lets it. Chosen by trial: at 0.04 radii
 * most sheets on balls change, at 0.25 three of nine methods get energy from the lift. */
#define DEPTH_RADII   0.1
#define DEPTH_SPRINGS 0.25

/* relative difference that rounding may cause between equal energies */
#define ROUNDING 1e-13

enum { HALVINGS = 8 };

static struct cs_energy_with_scale energy_of(const struct cs_projection_energy *balance,
                                             double t, const double *x, const double *v) {
    const struct cs_energy energy = cs_diagnostics_energy(balance->system, t, x, v);
    return (struct cs_energy_with_scale){.total = cs_energy_total(&energy),
                                         .scale = energy.kinetic + energy.elastic +
                                                  fabs(energy.other) + balance->energy_scale};
}

/* energy of the corrected state */
static struct cs_energy_with_scale energy_after(struct cs_projection_energy *energy,
                                                const struct cs_projection_step *step) {
    return energy_of(energy, step->t, step->corrected,
                     step->corrected + 3 * energy->system->view.n);
}

/* J, work of a surface of velocity u by its friction on particle i, which has the normal n: the
 * change of momentum across n, times u. */
static double find_rubbed(const struct cs_projection_energy *energy,
                          const struct cs_projection_step *step, size_t i, const double n[3],
                          const double u[3]) {
    const size_t count = energy->system->view.n;
    const double *before = step->v, *after = step->corrected + 3 * count;
    const double along = cs_vec3_dot(u, n);
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
        sum += (after[c * count + i] - before[c * count + i]) * (u[c] - along * n[c]);
    return energy->system->mass[i] * sum;
}

/* Energy after moving colliders have done their work: particles displaced by their motion, with
 * the velocities that projection gives. *rubbed: J, their work by friction. */
static double energy_with_collider_work(struct cs_projection_energy *energy,
                                        const struct cs_projection_step *step, double *rubbed) {
    const size_t n = energy->system->view.n;
    memcpy(energy->work, step->x, 3 * n * sizeof(double));
    for (uint32_t k = 0; k < energy->system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            double p[3], from[3], normal[3], provenance[3], gap;
            if (!step->is_pushed[i])
                continue;
            cs_point_read(energy->work, n, i, p);
            cs_point_read(step->before_step, n, i, from);
            if (!cs_tunnelling_find(step->colliders_before + k, step->colliders + k, from, p,
                                    &gap, normal))
                gap = cs_posed_collider_signed_distance(step->colliders + k, p, normal);
            cs_posed_collider_velocity(step->colliders + k, p, provenance);
            *rubbed += gap < 0 ? find_rubbed(energy, step, i, normal, provenance) : 0;
            const double along = step->dt * cs_vec3_dot(provenance, normal);
            for (size_t c = 0; c < 3 && gap < 0 && along > 0; c++)
                energy->work[c * n + i] += fmin(along, -gap) * normal[c];
        }
    return energy_of(energy, step->t, energy->work, step->corrected + 3 * n).total;
}

/* J, kinetic energy that the projections of this commit remove: sum m (v^2 - v'^2)/2, at least
 * 0. */
static double energy_absorbed(struct cs_projection_energy *energy,
                              const struct cs_projection_step *step) {
    const size_t n = energy->system->view.n;
    const double *before = step->v, *after = step->corrected + 3 * n;
    double sum = 0;
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++, k++)
            if (step->is_pushed[i])
                sum +=
                    energy->system->mass[i] * (before[k] * before[k] - after[k] * after[k]) / 2;
    return fmax(sum, 0);
}

/* J, energy of a fall through one step, m g^2 dt^2 / 2: energy alone cannot tell a body at rest
 * from one that falls so far. */
static double find_fall(struct cs_projection_energy *energy,
                        const struct cs_projection_step *step) {
    const struct cs_system *system = energy->system;
    const double *g = system->scene->forces->gravity;
    double mass = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        mass += system->inv_mass[i] > 0 ? system->mass[i] : 0;
    return mass * (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) * step->dt * step->dt / 2;
}

/* J, limit without external work: the energy of the last commit plus GIVEN_BACK of the loss, up
 * to that at first contact. */
static double energy_allowed(const struct cs_projection_energy *energy) {
    const double kept = energy->memory.energy.total;
    const double lost = fmax(energy->memory.energy_limit - kept, energy->absorbed);
    return fmin(kept + GIVEN_BACK * lost, fmax(energy->memory.energy_limit, kept));
}

/* J, limit with the work of this step from outside and by colliders, and room for rounding. */
static double find_allowed(struct cs_projection_energy *energy,
                           const struct cs_projection_step *step) {
    const struct cs_energy_with_scale before = energy_of(energy, step->t, step->x, step->v);
    energy->memory.energy_limit = fmax(energy->memory.energy_limit, before.total);
    double allowed = fmax(before.total, energy_allowed(energy));
    double rubbed = 0;
    if (energy->system->motions) {
        const double moved = energy_with_collider_work(energy, step, &rubbed);
        allowed = fmax(allowed + fmax(rubbed, 0), moved);
    }
    return allowed + ROUNDING * fmax(before.scale, energy->memory.energy.scale);
}

/* 1/s, change of velocity per displacement of the pushed particles, in the least-squares sense:
 * u.dv / u.u. A step of implicit Euler has g h for g h^2; one of second order g h for g h^2 /
 * 2, hence at most 2/dt. */
static double find_rate(const struct cs_projection_step *step, size_t n, const double *u) {
    double along = 0, squared = 0;
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++, k++) {
            if (!step->is_pushed[i])
                continue;
            along += u[k] * (step->corrected[3 * n + k] - step->v[k]);
            squared += u[k] * u[k];
        }
    return along > 0 ? fmin(along / squared, 2 / step->dt) : 0;
}

/* Lets the other particles follow the pushes, in position and velocity. */
static void apply_elastic_response(struct cs_projection_energy *energy,
                                   const struct cs_projection_step *step) {
    const size_t n = energy->system->view.n;
    double *u = energy->work;
    const struct cs_matrix matrix = {.t = step->t,
                                     .x = step->x,
                                     .v = step->v,
                                     .cm = 1,
                                     .cd = -step->dt,
                                     .ck = -step->dt * step->dt,
                                     .psd = true};
    cs_vector_kernels.linear_sum(3 * n, 1, step->corrected, -1, step->x, u);
    energy->velocity_per_push = find_rate(step, n, u);
    response_solve(&energy->elastic_response, &matrix, step->is_pushed, u);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            if (step->is_pushed[i])
                continue;
            step->corrected[c * n + i] += u[c * n + i];
            step->corrected[(3 + c) * n + i] += energy->velocity_per_push * u[c * n + i];
        }
}

/* Applies a fraction of the displacements to the state after the step. */
static void set_displacements(const struct cs_projection_energy *energy,
                              const struct cs_projection_step *step, double fraction) {
    const size_t n3 = 3 * (size_t)energy->system->view.n;
    cs_vector_kernels.linear_sum(n3, 1, step->x, fraction, energy->work, step->corrected);
}

/* The same of the velocities that belong to them. Pushed particles have their new velocity in
 * any case. */
static void set_velocities(const struct cs_projection_energy *energy,
                           const struct cs_projection_step *step, double fraction) {
    const size_t n = energy->system->view.n;
    const double speed = fraction * energy->velocity_per_push;
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++, k++)
            if (!step->is_pushed[i])
                step->corrected[3 * n + k] = step->v[k] + speed * energy->work[k];
}

typedef void set_fraction(const struct cs_projection_energy *energy,
                          const struct cs_projection_step *step, double fraction);

/* Bisects for the largest fraction within the limit, and sets it. */
static void bisect_fraction(struct cs_projection_energy *energy,
                            const struct cs_projection_step *step, double allowed,
                            set_fraction *set) {
    double low = 0, high = 1;
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = (low + high) / 2;
        set(energy, step, middle);
        *(energy_after(energy, step).total <= allowed ? &low : &high) = middle;
    }
    set(energy, step, low);
}

/* Applies the correction all the way to the particles that a shorter one leaves deep. */
static void lift_deep(const struct cs_projection_energy *energy,
                      const struct cs_projection_step *step) {
    const size_t n = energy->system->view.n;
    const double shortest = cs_diagnostics_shortest(energy->system);
    for (uint32_t k = 0; k < energy->system->scene->colliders.n; k++) {
        const double most = fmax(DEPTH_RADII * cs_tunnelling_inner_radius(step->colliders + k),
                                 DEPTH_SPRINGS * shortest);
        for (size_t i = 0; i < n; i++) {
            double *x = step->corrected + i, normal[3];
            const double p[3] = {x[0], x[n], x[2 * n]};
            if (!step->is_pushed[i] ||
                cs_posed_collider_signed_distance(step->colliders + k, p, normal) >= -most)
                continue;
            for (size_t c = 0; c < 3 * n; c += n)
                x[c] = step->x[c + i] + energy->work[c + i];
        }
    }
}

/* Reduces the correction: first the velocities, which carry the momentum of the impact, then
 * the displacements. Returns the energy that results. */
static struct cs_energy_with_scale shorten(struct cs_projection_energy *energy,
                                           const struct cs_projection_step *step,
                                           double allowed) {
    const size_t n = energy->system->view.n;
    cs_vector_kernels.linear_sum(3 * n, 1, step->corrected, -1, step->x, energy->work);
    set_displacements(energy, step, 0);
    set_velocities(energy, step, 1);
    if (energy_after(energy, step).total > allowed)
        bisect_fraction(energy, step, allowed, set_velocities);
    bisect_fraction(energy, step, allowed, set_displacements);
    lift_deep(energy, step);
    return energy_after(energy, step);
}

/* Energies are computed lazily: the limit with external work only if the simple one is
 * exceeded, the elastic response only if that is exceeded too. */
bool cs_projection_energy_limit(struct cs_projection_energy *energy,
                                const struct cs_projection_step *step) {
    const size_t n = energy->system->view.n;
    if (!energy->memory.has_last_energy)
        energy->memory.energy =
            energy_of(energy, step->t, step->before_step, step->before_step + 3 * n);
    energy->absorbed = energy_absorbed(energy, step);
    if (!energy->memory.in_contact)
        energy->memory.energy_limit = energy->memory.energy.total +
                                      GIVEN_BACK * energy->absorbed + find_fall(energy, step);
    energy->memory.has_last_energy = energy->memory.in_contact = true;
    energy->velocity_per_push = 0;
    struct cs_energy_with_scale found = energy_after(energy, step);
    if (found.total > energy_allowed(energy)) {
        const double allowed = find_allowed(energy, step);
        // a push without the neighbours may store more than the step brought if dt omega > 1
        if (found.total > allowed && energy->elastic_response.linear.system &&
            step->dt * energy->system->view.omega > 1) {
            apply_elastic_response(energy, step);
            found = energy_after(energy, step);
        }
        if (found.total > allowed) {
            energy->memory.energy = shorten(energy, step, allowed);
            return false;
        }
    }
    energy->memory.energy = found;
    return true;
}

/* J, sum of |m g.x|: the size of the terms of gravity's energy */
static double gravity_scale(const struct cs_system *system) {
    const size_t n = system->view.n;
    const double *g = system->scene->forces->gravity, *x = system->state;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += system->mass[i] * fabs(g[0] * x[i] + g[1] * x[n + i] + g[2] * x[2 * n + i]);
    return sum;
}

enum cs_status cs_projection_energy_init(struct cs_projection_energy *energy,
                                         struct cs_system *system, struct cs_arena *arena,
                                         struct cs_error *error) {
    *energy =
        (struct cs_projection_energy){.system = system, .energy_scale = gravity_scale(system)};
    CS_ARENA_ARRAY(arena, energy->work, 3 * (size_t)system->view.n, error);
    // nothing responds without springs
    struct cs_elastic_response *response = &energy->elastic_response;
    if (error->status || system->springs.n == 0)
        return error->status;
    CS_ARENA_ARRAY(arena, response->load, 3 * (size_t)system->view.n, error);
    return cs_temporary_pins_init(&response->pins, system, arena, error)
               ? error->status
               : cs_linear_init(&response->linear, system, arena, error);
}
