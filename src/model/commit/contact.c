/* contact.c - all particles against all obstacles, and the energy of it; see contact.h. */
#include "model/commit/contact.h"

#include "base/vector.h"
#include "model/commit/touch.h"
#include "model/force/measure.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* share of what was lost since the first touch that one commit may give back, to lift what is
 * still behind a surface */
#define GIVEN_BACK 0.01
/* of the energy: what rounding may make of equal ones */
#define ROUNDING 1e-13
enum { HALVINGS = 8 };

/* one commit */
struct step {
    struct cs_contact *contact;
    double t, dt;
    double *x, *v;               /* the state as the step has left it */
    atomic_ullong tests, pushed; /* whole numbers: their sum has no order */
};

static size_t count_of(const struct cs_contact *contact) {
    return contact->system->view.n;
}

static void take(const double *from, size_t n, size_t i, double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = from[c * n + i];
}

static void put(const double value[3], size_t n, size_t i, double *to) {
    for (size_t c = 0; c < 3; c++)
        to[c * n + i] = value[c];
}

/* most particles are in front of all: of those only the place is looked at */
static bool is_behind_any(const struct step *step, size_t i) {
    const struct cs_contact *contact = step->contact;
    double p[3], normal[3];
    take(step->x, count_of(contact), i, p);
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++) {
        const struct cs_obstacle *obstacle = contact->obstacles + k;
        if (cs_obstacle_is_near(obstacle, obstacle->collider->thickness, p) &&
            cs_obstacle_gap(obstacle, p, normal) < 0)
            return true;
    }
    return false;
}

/* particle i against the obstacles, each after the one before; returns how many pushed it */
static unsigned meet_all(const struct step *step, size_t i) {
    struct cs_contact *contact = step->contact;
    const size_t n = count_of(contact);
    double p[3], v[3], last[3], depth = 0, fresh = 0;
    unsigned pushed = 0;
    take(step->x, n, i, p);
    take(step->v, n, i, v);
    take(contact->last, n, i, last);
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++) {
        struct cs_touch touch;
        if (!cs_touch_resolve(contact->obstacles + k, step->dt, last, p, v, &touch))
            continue;
        pushed++;
        depth += touch.depth;
        fresh += touch.fresh;
    }
    put(p, n, i, contact->to);
    put(v, n, i, contact->to + 3 * n);
    contact->move[i] = depth;
    contact->move[n + i] = fresh;
    return pushed;
}

static void meet_part(void *arg, size_t begin, size_t end) {
    struct step *step = arg;
    struct cs_contact *contact = step->contact;
    const struct cs_system *system = contact->system;
    uint64_t tested = 0, pushed = 0;
    for (size_t i = begin; i < end; i++) {
        const bool free = system->inv_mass[i] > 0;
        tested += free;
        contact->pushed[i] = free && is_behind_any(step, i);
        if (contact->pushed[i])
            pushed += meet_all(step, i);
    }
    step->tests += tested * system->scene->colliders.n;
    step->pushed += pushed;
}

/* the particles that were not pushed, and the sums over those that were */
static void complete(struct step *step) {
    struct cs_contact *contact = step->contact;
    const size_t n = count_of(contact);
    contact->depth = contact->fresh = 0;
    for (size_t i = 0; i < n; i++) {
        if (contact->pushed[i]) {
            contact->depth += contact->move[i];
            contact->fresh += contact->move[n + i];
            continue;
        }
        for (size_t c = 0; c < 3; c++) {
            contact->to[c * n + i] = step->x[c * n + i];
            contact->to[(3 + c) * n + i] = step->v[c * n + i];
        }
    }
}

static struct cs_contact_energy energy_of(const struct cs_contact *contact, double t,
                                          const double *x, const double *v) {
    const struct cs_energy energy = cs_measure_energy(contact->system, t, x, v);
    return (struct cs_contact_energy){.whole = cs_energy_whole(&energy),
                                      .size = energy.kinetic + energy.elastic +
                                              fabs(energy.other) + contact->weight};
}

/* of where the commit would take the state */
static struct cs_contact_energy energy_to(const struct step *step) {
    const struct cs_contact *contact = step->contact;
    return energy_of(contact, step->t, contact->to, contact->to + 3 * count_of(contact));
}

/* The energy with obstacles having done their work: particles taken along, and the velocities
 * that they are given. */
static double energy_carried(const struct step *step) {
    struct cs_contact *contact = step->contact;
    const size_t n = count_of(contact);
    memcpy(contact->move, step->x, 3 * n * sizeof(double));
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            double p[3], normal[3], carried[3];
            for (size_t c = 0; c < 3; c++)
                p[c] = contact->move[c * n + i];
            if (!contact->pushed[i])
                continue;
            const double gap = cs_obstacle_gap(contact->obstacles + k, p, normal);
            cs_obstacle_velocity(contact->obstacles + k, p, carried);
            const double along = step->dt * (carried[0] * normal[0] + carried[1] * normal[1] +
                                             carried[2] * normal[2]);
            for (size_t c = 0; c < 3 && gap < 0 && along > 0; c++)
                contact->move[c * n + i] += fmin(along, -gap) * normal[c];
        }
    return energy_of(contact, step->t, contact->move, contact->to + 3 * n).whole;
}

/* what the energy may come to beside work from outside: what the commit before has left, and a
 * little of what was lost */
static double find_kept(const struct cs_contact *contact) {
    const double kept = contact->energy.whole;
    return kept + GIVEN_BACK * (contact->most - kept);
}

/* with the work that the step has brought in, from outside and by obstacles */
static double find_allowed(const struct step *step) {
    struct cs_contact *contact = step->contact;
    const struct cs_contact_energy before = energy_of(contact, step->t, step->x, step->v);
    contact->most = fmax(contact->most, before.whole);
    double allowed = fmax(before.whole, find_kept(contact));
    if (contact->system->motions)
        allowed = fmax(allowed, energy_carried(step));
    return allowed + ROUNDING * fmax(before.size, contact->energy.size);
}

/* the rest of the body follows the pushes, and has the velocity of the fresh part of it */
static void respond(const struct step *step) {
    struct cs_contact *contact = step->contact;
    const size_t n = count_of(contact);
    double *u = contact->move;
    const struct cs_matrix matrix = {.t = step->t,
                                     .x = step->x,
                                     .v = step->v,
                                     .cm = 1,
                                     .cd = -step->dt,
                                     .ck = -step->dt * step->dt,
                                     .psd = true};
    cs_vector_kernels.linear_sum(3 * n, 1, contact->to, -1, step->x, u);
    cs_response_find(&contact->response, &matrix, contact->pushed, u);
    contact->rate = contact->depth > 0 ? contact->fresh / contact->depth / step->dt : 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            if (contact->pushed[i])
                continue;
            contact->to[c * n + i] += u[c * n + i];
            contact->to[(3 + c) * n + i] += contact->rate * u[c * n + i];
        }
}

/* what of a correction is done */
struct share {
    double way, speed; /* of the pushes and what follows them, of the velocity that it gets */
};

/* The energy of the state that the step has left with a share of the correction; pushed
 * particles have their new velocity in any case. */
static struct cs_contact_energy try_share(const struct step *step, struct share share) {
    struct cs_contact *contact = step->contact;
    const size_t n = count_of(contact);
    const double *way = contact->move, speed = share.speed * contact->rate;
    cs_vector_kernels.linear_sum(3 * n, 1, step->x, share.way, way, contact->to);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (!contact->pushed[i])
                contact->to[(3 + c) * n + i] = step->v[c * n + i] + speed * way[c * n + i];
    return energy_to(step);
}

/* Of *part of share, from 0 to 1, as much as keeps to the energy. */
static void halve(const struct step *step, double allowed, struct share *share, double *part) {
    double low = 0, high = 1;
    for (int k = 0; k < HALVINGS; k++) {
        *part = (low + high) / 2;
        *(try_share(step, *share).whole <= allowed ? &low : &high) = *part;
    }
    *part = low;
}

/* First the velocities, which take the momentum of the blow away, then the pushes; returns the
 * energy that is left. */
static struct cs_contact_energy shorten(const struct step *step, double allowed) {
    struct cs_contact *contact = step->contact;
    struct share share = {0, 1};
    cs_vector_kernels.linear_sum(3 * count_of(contact), 1, contact->to, -1, step->x,
                                 contact->move);
    if (try_share(step, share).whole > allowed)
        halve(step, allowed, &share, &share.speed);
    halve(step, allowed, &share, &share.way);
    contact->counts.shortened++;
    return try_share(step, share);
}

/* The energy of `to`, after as much was done about it as is needed. */
static struct cs_contact_energy hold_energy(const struct step *step) {
    struct cs_contact *contact = step->contact;
    if (!contact->known)
        contact->energy =
            energy_of(contact, step->t, contact->last, contact->last + 3 * count_of(contact));
    if (!contact->touching)
        contact->most = contact->energy.whole;
    contact->rate = 0;
    struct cs_contact_energy found = energy_to(step);
    if (found.whole <= find_kept(contact))
        return found;
    const double allowed = find_allowed(step);
    if (found.whole > allowed && cs_response_is_due(&contact->response, step->dt)) {
        respond(step);
        found = energy_to(step);
    }
    return found.whole > allowed ? shorten(step, allowed) : found;
}

bool cs_contact_resolve(struct cs_contact *contact, double t, double dt, double *x, double *v) {
    const size_t n = count_of(contact);
    struct step step = {.contact = contact, .t = t, .dt = dt, .x = x, .v = v};
    cs_obstacles_at(contact->system, t, contact->obstacles);
    cs_vector_share(n, meet_part, &step);
    contact->counts.tests += step.tests;
    contact->counts.pushed += step.pushed;
    contact->known &= contact->touching;
    if (step.pushed > 0) {
        complete(&step);
        contact->energy = hold_energy(&step);
        contact->known = true;
        memcpy(x, contact->to, 3 * n * sizeof *x);
        memcpy(v, contact->to + 3 * n, 3 * n * sizeof *v);
    }
    contact->touching = step.pushed > 0;
    return contact->touching;
}

void cs_contact_keep(struct cs_contact *contact, const double *x, const double *v,
                     bool resolved) {
    const size_t n3 = 3 * count_of(contact);
    memcpy(contact->last, x, n3 * sizeof *x);
    memcpy(contact->last + n3, v, n3 * sizeof *v);
    contact->known &= resolved;
}

void cs_contact_record(struct cs_contact *contact, struct cs_record *record) {
    cs_record_bytes(record, contact->last, 6 * count_of(contact) * sizeof *contact->last);
    CS_RECORD(record, contact->energy);
    CS_RECORD(record, contact->most);
    CS_RECORD(record, contact->known);
    CS_RECORD(record, contact->touching);
    CS_RECORD(record, contact->counts);
    CS_RECORD(record, contact->response.solves);
    CS_RECORD(record, contact->response.iterations);
}

/* size of the parts that gravity's energy is the sum of, which may cancel */
static double weigh(const struct cs_system *system) {
    const size_t n = system->view.n;
    const double *g = system->scene->forces.gravity, *x = system->state;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += system->mass[i] * fabs(g[0] * x[i] + g[1] * x[n + i] + g[2] * x[2 * n + i]);
    return sum;
}

size_t cs_contact_bytes(const struct cs_scene *scene, size_t n, size_t n_springs, bool forced) {
    return scene->colliders.n * sizeof(struct cs_obstacle) + 15 * n * sizeof(double) +
           n * sizeof(bool) + cs_response_bytes(scene, n, n_springs, forced);
}

enum cs_status cs_contact_init(struct cs_contact *contact, const struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error) {
    const size_t n = system->view.n;
    *contact = (struct cs_contact){.system = system, .weight = weigh(system)};
    contact->obstacles =
        cs_arena_take_n(arena, system->scene->colliders.n, sizeof *contact->obstacles, error);
    contact->last = cs_arena_take_n(arena, 6 * n, sizeof(double), error);
    contact->to = cs_arena_take_n(arena, 6 * n, sizeof(double), error);
    contact->move = cs_arena_take_n(arena, 3 * n, sizeof(double), error);
    contact->pushed = cs_arena_take_n(arena, n, sizeof(bool), error);
    return error->status ? error->status
                         : cs_response_init(&contact->response, system, arena, error);
}
