/* balance.c - energies before and after, and what is done where there is too much; see
 * balance.h. */
#include "model/commit/balance.h"

#include "base/vector.h"
#include "model/force/measure.h"

#include <math.h>
#include <string.h>

/* share of what was lost since the first touch that one commit may give back, to lift what is
 * still behind a surface */
#define GIVEN_BACK 0.01
/* of the energy: what rounding may make of equal ones */
#define ROUNDING 1e-13
enum { HALVINGS = 8 };

static struct cs_balance_energy energy_of(const struct cs_balance *balance, double t,
                                          const double *x, const double *v) {
    const struct cs_energy energy = cs_measure_energy(balance->system, t, x, v);
    return (struct cs_balance_energy){.whole = cs_energy_whole(&energy),
                                      .size = energy.kinetic + energy.elastic +
                                              fabs(energy.other) + balance->weight};
}

/* of where the commit would take the state */
static struct cs_balance_energy energy_to(struct cs_balance *balance,
                                          const struct cs_blow *blow) {
    return energy_of(balance, blow->t, blow->to, blow->to + 3 * balance->system->view.n);
}

/* The energy with obstacles having done their work: particles taken along, and the velocities
 * that they are given. */
static double energy_carried(struct cs_balance *balance, const struct cs_blow *blow) {
    const size_t n = balance->system->view.n;
    memcpy(balance->move, blow->x, 3 * n * sizeof(double));
    for (uint32_t k = 0; k < balance->system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            double p[3], normal[3], carried[3];
            for (size_t c = 0; c < 3; c++)
                p[c] = balance->move[c * n + i];
            if (!blow->pushed[i])
                continue;
            const double gap = cs_obstacle_gap(blow->obstacles + k, p, normal);
            cs_obstacle_velocity(blow->obstacles + k, p, carried);
            const double along = blow->dt * (carried[0] * normal[0] + carried[1] * normal[1] +
                                             carried[2] * normal[2]);
            for (size_t c = 0; c < 3 && gap < 0 && along > 0; c++)
                balance->move[c * n + i] += fmin(along, -gap) * normal[c];
        }
    return energy_of(balance, blow->t, balance->move, blow->to + 3 * n).whole;
}

/* kinetic energy in J that the blows of this commit take away */
static double find_taken(struct cs_balance *balance, const struct cs_blow *blow) {
    const size_t n = balance->system->view.n;
    const double *before = blow->v, *after = blow->to + 3 * n;
    double sum = 0;
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++, k++)
            if (blow->pushed[i])
                sum += balance->system->mass[i] *
                       (before[k] * before[k] - after[k] * after[k]) / 2;
    return fmax(sum, 0);
}

/* J, of a fall through one step: a body that rests cannot be told from it by its energy */
static double find_fall(struct cs_balance *balance, const struct cs_blow *blow) {
    const struct cs_system *system = balance->system;
    const double *g = system->scene->forces.gravity;
    double mass = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        mass += system->inv_mass[i] > 0 ? system->mass[i] : 0;
    return mass * (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) * blow->dt * blow->dt / 2;
}

/* what the energy may come to beside work from outside: what the commit before has left, and a
 * little of what was lost, or is in this one, up to what there was at the first touch */
static double find_kept(const struct cs_balance *balance) {
    const double kept = balance->energy.whole;
    const double lost = fmax(balance->most - kept, balance->taken);
    return fmin(kept + GIVEN_BACK * lost, fmax(balance->most, kept));
}

/* with the work that the step has brought in, from outside and by obstacles */
static double find_allowed(struct cs_balance *balance, const struct cs_blow *blow) {
    const struct cs_balance_energy before = energy_of(balance, blow->t, blow->x, blow->v);
    balance->most = fmax(balance->most, before.whole);
    double allowed = fmax(before.whole, find_kept(balance));
    if (balance->system->motions)
        allowed = fmax(allowed, energy_carried(balance, blow));
    return allowed + ROUNDING * fmax(before.size, balance->energy.size);
}

/* 1/s, the change of velocity that goes with a push: g h with g h^2 in a step of implicit
 * Euler, with g h^2 / 2 in one of second order; of a blow no more than that */
static double find_rate(const struct cs_blow *blow, size_t n, const double *u) {
    double along = 0, squared = 0;
    for (size_t c = 0, k = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++, k++) {
            if (!blow->pushed[i])
                continue;
            along += u[k] * (blow->to[3 * n + k] - blow->v[k]);
            squared += u[k] * u[k];
        }
    return along > 0 ? fmin(along / squared, 2 / blow->dt) : 0;
}

/* the rest of the body follows the pushes, in its velocity too */
static void respond(struct cs_balance *balance, const struct cs_blow *blow) {
    const size_t n = balance->system->view.n;
    double *u = balance->move;
    const struct cs_matrix matrix = {.t = blow->t,
                                     .x = blow->x,
                                     .v = blow->v,
                                     .cm = 1,
                                     .cd = -blow->dt,
                                     .ck = -blow->dt * blow->dt,
                                     .psd = true};
    cs_vector_kernels.linear_sum(3 * n, 1, blow->to, -1, blow->x, u);
    balance->rate = find_rate(blow, n, u);
    cs_response_find(&balance->response, &matrix, blow->pushed, u);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            if (blow->pushed[i])
                continue;
            blow->to[c * n + i] += u[c * n + i];
            blow->to[(3 + c) * n + i] += balance->rate * u[c * n + i];
        }
}

/* what of a correction is done */
struct share {
    double way, speed; /* of the pushes and what follows them, of the velocity that it gets */
};

/* The energy of the state that the step has left with a share of the correction; pushed
 * particles have their new velocity in any case. */
static struct cs_balance_energy try_share(struct cs_balance *balance,
                                          const struct cs_blow *blow, struct share share) {
    const size_t n = balance->system->view.n;
    const double *way = balance->move, speed = share.speed * balance->rate;
    cs_vector_kernels.linear_sum(3 * n, 1, blow->x, share.way, way, blow->to);
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (!blow->pushed[i])
                blow->to[(3 + c) * n + i] = blow->v[c * n + i] + speed * way[c * n + i];
    return energy_to(balance, blow);
}

/* Of *part of share, from 0 to 1, as much as keeps to the energy. */
static void halve(struct cs_balance *balance, const struct cs_blow *blow, double allowed,
                  struct share *share, double *part) {
    double low = 0, high = 1;
    for (int k = 0; k < HALVINGS; k++) {
        *part = (low + high) / 2;
        *(try_share(balance, blow, *share).whole <= allowed ? &low : &high) = *part;
    }
    *part = low;
}

/* First the velocities, which take the momentum of the blow away, then the pushes; returns the
 * energy that is left. */
static struct cs_balance_energy shorten(struct cs_balance *balance, const struct cs_blow *blow,
                                        double allowed) {
    const size_t n = balance->system->view.n;
    struct share share = {0, 1};
    cs_vector_kernels.linear_sum(3 * n, 1, blow->to, -1, blow->x, balance->move);
    if (try_share(balance, blow, share).whole > allowed)
        halve(balance, blow, allowed, &share, &share.speed);
    halve(balance, blow, allowed, &share, &share.way);
    balance->shortened++;
    return try_share(balance, blow, share);
}

bool cs_balance_hold(struct cs_balance *balance, const struct cs_blow *blow) {
    const size_t n = balance->system->view.n;
    if (!balance->known)
        balance->energy = energy_of(balance, blow->t, blow->last, blow->last + 3 * n);
    balance->taken = find_taken(balance, blow);
    if (!balance->touching)
        balance->most =
            balance->energy.whole + GIVEN_BACK * balance->taken + find_fall(balance, blow);
    balance->known = balance->touching = true;
    balance->rate = 0;
    struct cs_balance_energy found = energy_to(balance, blow);
    if (found.whole > find_kept(balance)) {
        const double allowed = find_allowed(balance, blow);
        if (found.whole > allowed && cs_response_is_due(&balance->response, blow->dt)) {
            respond(balance, blow);
            found = energy_to(balance, blow);
        }
        if (found.whole > allowed) {
            balance->energy = shorten(balance, blow, allowed);
            return false;
        }
    }
    balance->energy = found;
    return true;
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

enum cs_status cs_balance_init(struct cs_balance *balance, struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error) {
    *balance = (struct cs_balance){.system = system, .weight = weigh(system)};
    balance->move = cs_arena_take_n(arena, 3 * (size_t)system->view.n, sizeof(double), error);
    return error->status ? error->status
                         : cs_response_init(&balance->response, system, arena, error);
}

void cs_balance_record(struct cs_balance *balance, struct cs_record *record) {
    CS_RECORD(record, balance->energy);
    CS_RECORD(record, balance->most);
    CS_RECORD(record, balance->known);
    CS_RECORD(record, balance->touching);
    CS_RECORD(record, balance->shortened);
    CS_RECORD(record, balance->response.solves);
    CS_RECORD(record, balance->response.iterations);
}
