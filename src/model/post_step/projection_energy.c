/* projection_energy.c - energies before and after a correction, and what reduces them if there
 * is too much; see projection_energy.h. */
#include "model/post_step/projection_energy.h"

#include "base/vector.h"
#include "model/force/diagnostics.h"
#include "model/post_step/tunnelling.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* Solves A u = f by conjugate gradients in the displacements that the pushes leave open, to
 * which residuals and directions are projected (Baraff, Witkin 1998, sec. 5.3). */

/* Relative residual, and the largest number of iterations. The response shapes a correction
 * whose energy is checked afterwards, so that few digits suffice. Chosen by trial. */
#define RTOL 1e-2

enum { ITERATIONS_MAX = 300 };

/* Prepares the solver; nothing for a system without springs. The arena owns its memory.
 * CS_ERR_MEMORY. */
static enum cs_status response_init(struct cs_elastic_response *response,
                                    struct cs_system *system, struct cs_arena *arena,
                                    struct cs_error *error) {
    *response = (struct cs_elastic_response){0};
    if (system->springs.n == 0)
        return CS_OK;
    return cs_linear_init(&response->linear, system, arena, error);
}

/* Returns whether springs are so stiff for a step of dt s that pushing a particle without its
 * neighbours may store more energy than the step brought: dt omega > 1. */
static bool response_is_needed(const struct cs_elastic_response *response, double dt) {
    const struct cs_system *system = response->linear.system;
    return system && dt * system->view.omega > 1;
}

/* Projects a vector to the displacements that are open: any for a free particle, those across
 * the normal for a pushed one if it slides, else none. */
static void clear_imposed(const struct cs_projection_step *step, bool slides, size_t n,
                          double *p) {
    for (size_t i = 0; i < n; i++) {
        const double *normal = step->normals + i;
        if (!step->is_pushed[i])
            continue;
        const double along =
            p[i] * normal[0] + p[n + i] * normal[n] + p[2 * n + i] * normal[2 * n];
        const bool held = !slides || (normal[0] == 0 && normal[n] == 0 && normal[2 * n] == 0);
        for (size_t c = 0; c < 3 * n; c += n)
            p[c + i] = held ? 0 : p[c + i] - along * normal[c];
    }
}

/* u (3,n) in m holds the pushes, and a start at free particles. Adds to it what makes

 *   A u = M f,   A = M + dt D + dt^2 K   at the state after the step
 *
 * in all open displacements, where f is the part of the pushes across the normals, by friction:
 * the body follows the pushes as in an implicit Euler step of dt. By preconditioned conjugate
 * gradients (Saad 2003). A direction without stiffness, or 300 iterations, end it early; u is
 * then between start and solution. */
static void response_solve(struct cs_elastic_response *response,
                           const struct cs_projection_step *step, bool slides, double *u) {
    struct cs_linear *linear = &response->linear;
    const struct cs_system *system = linear->system;
    const size_t n = system->view.n, n3 = 3 * n;
    const struct cs_matrix matrix = {.t = step->t,
                                     .x = step->x,
                                     .v = step->v,
                                     .cm = 1,
                                     .cd = -step->dt,
                                     .ck = -step->dt * step->dt,
                                     .psd = true};
    double *r = linear->r, *z = linear->z, *p = linear->p, *q = linear->q;
    cs_linear_setup(linear, &matrix);
    cs_linear_mul(linear, u, q);
    for (size_t k = 0; k < n3; k++)
        r[k] = (step->is_pushed[k % n] ? system->mass[k % n] * u[k] : 0) - q[k];
    clear_imposed(step, slides, n, r);
    double norm = sqrt(cs_vector_dot(n3, r, r)), before = 0;
    const double goal = RTOL * norm;
    for (int k = 0; k < ITERATIONS_MAX && norm > goal; k++) {
        cs_linear_precondition(linear, r, norm, z);
        clear_imposed(step, slides, n, z);
        const double now = cs_vector_dot(n3, r, z);
        if (!(now > 0))
            break;
        cs_vector_kernels.linear_sum(n3, 1, z, k > 0 ? now / before : 0, k > 0 ? p : z, p);
        before = now;
        cs_linear_mul(linear, p, q);
        const double curvature = cs_vector_dot(n3, p, q);
        if (!(curvature > 0))
            break;
        cs_vector_kernels.linear_sum(n3, 1, u, now / curvature, p, u);
        clear_imposed(step, slides, n, q);
        cs_vector_kernels.linear_sum(n3, 1, r, -now / curvature, q, r);
        norm = sqrt(cs_vector_dot(n3, r, r));
    }
}

/* Fraction of the energy lost since first contact that one commit may return, because pushes at
 * rest bring the body back to where it was. Chosen by trial. */
#define GIVEN_BACK 0.01

/* relative difference that rounding may cause between equal energies */
#define ROUNDING 1e-13

/* bisections of a step, and passes over colliders, each of which may push into another */
enum { HALVINGS = 8, PASSES = 32 };

static struct cs_energy_with_scale energy_of(const struct cs_projection_energy *balance,
                                             double t, const double *x, const double *v) {
    const struct cs_energy energy = cs_diagnostics_energy(balance->system, t, x, v);
    return (struct cs_energy_with_scale){.total = cs_energy_total(&energy),
                                         .scale = energy.kinetic + energy.elastic +
                                                  fabs(energy.other) + balance->energy_scale};
}

/* energy of the corrected state */
static struct cs_energy_with_scale energy_after(const struct cs_projection_energy *energy,
                                                const struct cs_projection_step *step) {
    return energy_of(energy, step->t, step->corrected,
                     step->corrected + 3 * energy->system->view.n);
}

/* Energy after moving colliders have done their work: particles displaced by their motion, with
 * the velocities that projection gives. */
static double energy_with_collider_work(struct cs_projection_energy *energy,
                                        const struct cs_projection_step *step) {
    const size_t n = energy->system->view.n;
    memcpy(energy->work, step->x, 3 * n * sizeof(double));
    for (uint32_t k = 0; k < energy->system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            double p[3], from[3], normal[3], provenance[3], gap;
            if (!step->is_pushed[i])
                continue;
            for (size_t c = 0; c < 3; c++) {
                p[c] = energy->work[c * n + i];
                from[c] = step->before_step[c * n + i];
            }
            if (!cs_tunnelling_find(step->colliders_before + k, step->colliders + k, from, p,
                                    &gap, normal))
                gap = cs_posed_collider_signed_distance(step->colliders + k, p, normal);
            cs_posed_collider_velocity(step->colliders + k, p, provenance);
            const double along =
                step->dt * (provenance[0] * normal[0] + provenance[1] * normal[1] +
                            provenance[2] * normal[2]);
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
    const double kept = energy->energy.total;
    const double lost = fmax(energy->energy_limit - kept, energy->absorbed);
    return fmin(kept + GIVEN_BACK * lost, fmax(energy->energy_limit, kept));
}

/* J, limit with the work of this step from outside and by colliders, and room for rounding. */
static double find_allowed(struct cs_projection_energy *energy,
                           const struct cs_projection_step *step) {
    const struct cs_energy_with_scale before = energy_of(energy, step->t, step->x, step->v);
    energy->energy_limit = fmax(energy->energy_limit, before.total);
    double allowed = fmax(before.total, energy_allowed(energy));
    if (energy->system->motions)
        allowed = fmax(allowed, energy_with_collider_work(energy, step));
    return allowed + ROUNDING * fmax(before.scale, energy->energy.scale);
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

/* Moves one particle out of a collider, and takes its inward velocity. Returns whether it was
 * inside. */
static bool put_out_one(const struct cs_posed_collider *collider, size_t n, double *x) {
    double p[3] = {x[0], x[n], x[2 * n]}, *v = x + 3 * n, normal[3], w[3], inward = 0;
    if (!cs_posed_collider_is_near(collider, collider->collider->thickness, p))
        return false;
    const double gap = cs_posed_collider_signed_distance(collider, p, normal);
    const double size = fabs(p[0]) + fabs(p[1]) + fabs(p[2]) + collider->radius;
    if (!(gap < -ROUNDING * size))
        return false;
    cs_posed_collider_velocity(collider, p, w);
    for (size_t c = 0; c < 3; c++)
        inward += (v[c * n] - w[c]) * normal[c];
    for (size_t c = 0; c < 3; c++) {
        x[c * n] -= gap * normal[c];
        v[c * n] -= fmin(inward, 0) * normal[c];
    }
    return true;
}

/* Moves free particles out of all colliders. */
static void put_out(const struct cs_projection_energy *energy,
                    const struct cs_projection_step *step) {
    const struct cs_system *system = energy->system;
    bool inside = true;
    for (int pass = 0; pass < PASSES && inside; pass++) {
        inside = false;
        for (uint32_t k = 0; k < system->scene->colliders.n; k++)
            for (size_t i = 0; i < system->view.n; i++)
                if (system->inv_mass[i] > 0 && !step->is_sticking[i])
                    inside |=
                        put_out_one(step->colliders + k, system->view.n, step->corrected + i);
    }
}

/* Lets the body follow the pushes, in position and velocity. */
static void apply_elastic_response(struct cs_projection_energy *energy,
                                   const struct cs_projection_step *step, bool slides) {
    const size_t n3 = 3 * (size_t)energy->system->view.n;
    double *u = energy->work;
    cs_vector_kernels.linear_sum(n3, 1, step->corrected, -1, step->x, u);
    const double rate = find_rate(step, n3 / 3, u);
    response_solve(&energy->elastic_response, step, slides, u);
    for (size_t k = 0; k < n3; k++) {
        const double followed = step->x[k] + u[k] - step->corrected[k];
        step->corrected[k] += followed;
        step->corrected[n3 + k] += rate * followed;
    }
    put_out(energy, step);
}

/* Returns whether a particle of the body was pushed. */
static bool is_touched(const struct cs_projection_step *step,
                       const struct cs_body_range *body) {
    return memchr(step->is_pushed + body->first, true, body->count * sizeof(bool)) != NULL;
}

/* Scales the velocities of the bodies that were pushed. Returns their kinetic energy in J
 * before. */
static double scale_motion(const struct cs_projection_energy *energy,
                           const struct cs_projection_step *step, double factor) {
    const struct cs_system *system = energy->system;
    const size_t n = system->view.n;
    double sum = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        const size_t end = is_touched(step, body) ? body->first + body->count : 0;
        for (size_t i = body->first; i < end; i++)
            for (size_t k = 3 * n + i; k < 6 * n && system->inv_mass[i] > 0; k += n) {
                sum += system->mass[i] * step->corrected[k] * step->corrected[k] / 2;
                step->corrected[k] *= factor;
            }
    }
    return sum;
}

/* Takes the bodies that were pushed only a fraction of their way in this step, from where they
 * started to the positions in energy->work, and out of colliders. */
static void retreat(const struct cs_projection_energy *energy,
                    const struct cs_projection_step *step, double fraction) {
    const struct cs_system *system = energy->system;
    const size_t n = system->view.n;
    const double *from = step->before_step, *to = energy->work;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        const size_t end = is_touched(step, body) ? body->first + body->count : 0;
        for (size_t i = body->first; i < end; i++)
            for (size_t k = i; k < 3 * n; k += n)
                step->corrected[k] = from[k] + fraction * (to[k] - from[k]);
    }
    put_out(energy, step);
}

/* J, what is left for motion at the corrected positions: negative if they store too much. */
static double find_room(const struct cs_projection_energy *energy,
                        const struct cs_projection_step *step, double allowed) {
    return allowed - energy_after(energy, step).total + scale_motion(energy, step, 1);
}

/* Slows the bodies that were pushed until the limit holds. Where springs and gravity alone
 * store more, the bodies go a part of the way first. Returns whether they had not to. */
static bool fit_energy(struct cs_projection_energy *energy,
                       const struct cs_projection_step *step, double allowed) {
    const bool whole = find_room(energy, step, allowed) >= 0;
    double low = 0, high = 1;
    memcpy(energy->work, step->corrected, 3 * energy->system->view.n * sizeof(double));
    for (int k = 0; k < HALVINGS && !whole; k++) {
        const double middle = (low + high) / 2;
        retreat(energy, step, middle);
        *(find_room(energy, step, allowed) >= 0 ? &low : &high) = middle;
    }
    if (!whole)
        retreat(energy, step, low);
    const double room = fmax(find_room(energy, step, allowed), 0);
    const double motion = scale_motion(energy, step, 1);
    if (motion > room)
        scale_motion(energy, step, sqrt(room / motion));
    energy->energy = energy_after(energy, step);
    return whole;
}

/* Energies are computed lazily: the limit with external work only if the simple one is
 * exceeded, the elastic response only if that is exceeded too. */
bool cs_projection_energy_limit(struct cs_projection_energy *energy,
                                const struct cs_projection_step *step) {
    const size_t n = energy->system->view.n;
    if (!energy->has_last_energy)
        energy->energy =
            energy_of(energy, step->t, step->before_step, step->before_step + 3 * n);
    energy->absorbed = energy_absorbed(energy, step);
    if (!energy->in_contact)
        energy->energy_limit =
            energy->energy.total + GIVEN_BACK * energy->absorbed + find_fall(energy, step);
    energy->has_last_energy = energy->in_contact = true;
    if (energy->system->scene->colliders.n > 1)
        put_out(energy, step);
    struct cs_energy_with_scale found = energy_after(energy, step);
    if (found.total > energy_allowed(energy)) {
        const double allowed = find_allowed(energy, step);
        const bool follows = response_is_needed(&energy->elastic_response, step->dt);
        for (int slides = 0; slides < 2 && follows && found.total > allowed; slides++) {
            apply_elastic_response(energy, step, slides == 1);
            found = energy_after(energy, step);
        }
        if (found.total > allowed)
            return fit_energy(energy, step, allowed);
    }
    energy->energy = found;
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
    return error->status ? error->status
                         : response_init(&energy->elastic_response, system, arena, error);
}

void cs_projection_energy_serialise(struct cs_projection_energy *energy,
                                    struct cs_serialiser *serialiser) {
    CS_SERIALISER(serialiser, energy->energy);
    CS_SERIALISER(serialiser, energy->energy_limit);
    CS_SERIALISER(serialiser, energy->has_last_energy);
    CS_SERIALISER(serialiser, energy->in_contact);
}
