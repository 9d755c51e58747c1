/* Flights of particles in impact, and what a linearised step takes from them. */
#include "model/contact/rebound.h"

#include "base/vec3.h"
#include "base/vector.h"
#include "model/contact/bristle_law.h"
#include "model/contact/collider_params.h"
#include "model/contact/point_query.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"

#include <math.h>
#include <string.h>

/* Steps of a flight at most; one that needs more is no impact. */
enum { FLIGHT_STEPS_MAX = 2000 };
/* A step of a flight in units of sqrt(m/K), and in ranges: energy is then kept to 1 %. */
#define FLIGHT_PHASE 0.1
#define FLIGHT_RANGE 0.03
/* Fraction of E that the linear model may miss before a particle is in impact. */
#define MISSED_MAX 0.01

bool cs_rebounds_possible(const struct cs_scene *scene) {
    if (!cs_scene_contact_is_force(scene))
        return false;
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (!cs_scene_colliders(scene)[c].mesh)
            return true;
    return false;
}

enum cs_status cs_rebounds_init(struct cs_system *system, struct cs_arena *arena,
                                struct cs_error *error) {
    struct cs_rebounds *rebounds = cs_arena_alloc_array(arena, 1, sizeof *rebounds, error);
    if (!rebounds)
        return error->status;
    rebounds->list = cs_arena_alloc_array(arena, system->view.n, sizeof *rebounds->list, error);
    CS_ARENA_ARRAY(arena, rebounds->change, 3 * (size_t)system->view.n, error);
    CS_ARENA_ARRAY(arena, rebounds->rows, system->view.n / CS_COLLIDER_ROW + (size_t)1, error);
    system->rebounds = rebounds;
    return error->status;
}

/* One particle before one collider at the begin of a step, with d as its coordinate: as d' =
 * g.v, its mass along d is m/g.g, and its force g.f/g.g. */
struct flight {
    double mass, h;           /* kg, s */
    double range, k, damping; /* m, N/m, s: the law */
    double loss, rate;        /* 1, 1/s2: of restitution */
    double other;             /* N, f0 */
    double d, u;              /* m, m/s: at the begin */
    double d1, w1;            /* at the end */
};

/* The time in s until a free flight with acceleration a comes into range, `beyond` m away:
 * the first positive root of beyond + w t + a t^2/2. HUGE_VAL: never. */
static double time_to_range(double beyond, double w, double a) {
    const double square = w * w - 2 * a * beyond;
    if (!(square > 0) || (w >= 0 && a >= 0))
        return HUGE_VAL;
    // without cancellation for either sign of w
    return w < 0 ? 2 * beyond / (sqrt(square) - w) : (w + sqrt(square)) / -a;
}

/* The longest step in s of a flight at distance d with speed w, acceleration a and stiffness K:
 * to the range in one step, then as the law wants it here and where the step leads. */
static double flight_step(const struct flight *flight, double d, double w, double a,
                          double stiffness) {
    const double range = flight->range, beyond = d - range;
    if (beyond > 1e-9 * range)
        return time_to_range(beyond, w, a);
    const double step = FLIGHT_RANGE * range / fmax(fabs(w), 1e-12);
    if (w < 0)
        stiffness = cs_barrier_at(d + w * step, range, flight->k).stiffness;
    return fmin(step, FLIGHT_PHASE * sqrt(flight->mass / fmax(stiffness, 1e-300)));
}

/* N s/m, of the approach */
static double drag_of(const struct flight *flight, const struct cs_barrier *barrier, double d,
                      double w) {
    const double square = cs_restitution_square(d, flight->range, flight->rate, w);
    return flight->damping * barrier->stiffness + flight->loss * barrier->force / sqrt(square);
}

/* Sets d1 and w1. Returns false if it takes too many steps. */
static bool fly(struct flight *flight) {
    const double m = flight->mass;
    double d = flight->d, w = flight->u, t = 0;
    struct cs_barrier barrier = cs_barrier_at(d, flight->range, flight->k);
    double a = (barrier.force - drag_of(flight, &barrier, d, w) * w + flight->other) / m;
    for (int step = 0; t < flight->h; step++) {
        if (step == FLIGHT_STEPS_MAX)
            return false;
        const double dt = fmin(flight_step(flight, d, w, a, barrier.stiffness), flight->h - t);
        w += 0.5 * dt * a;
        d += dt * w;
        t = dt < flight->h - t ? t + dt : flight->h;
        barrier = cs_barrier_at(d, flight->range, flight->k);
        // the damper's half of the second kick is implicit, so that a stiff one stays stable
        const double drag = drag_of(flight, &barrier, d, w) / m;
        a = (barrier.force + flight->other) / m;
        w = (w + 0.5 * dt * a) / (1 + 0.5 * dt * drag);
        a -= drag * w;
    }
    flight->d1 = d;
    flight->w1 = w;
    return true;
}

/* Tells whether the particle is in impact, and flies it. energy: E. */
static bool rebounds(struct flight *flight, double energy) {
    const double m = flight->mass, h = flight->h, range = flight->range, k = flight->k;
    const struct cs_barrier_model model = cs_barrier_model_at(flight->d, range, k, true);
    const double load = fabs(flight->other) * h;
    // approach without contact, and by the linear step
    const double free = -h * (flight->u + h * flight->other / m);
    const double linear = (m * free - h * h * model.force) / (m + h * h * model.stiffness);
    if ((flight->d >= range && flight->d - free >= range) ||
        !(load < 0.5 * m * (fabs(flight->u) + sqrt(2 * energy / m))) || !fly(flight))
        return false;
    const double impulse = m * (flight->w1 - flight->u) - h * flight->other;
    const double leaving = m * fmin(flight->u, flight->w1);
    if (!(load < 0.5 * fmax(impulse, leaving)))
        return false;
    const double by_step = 0.5 * m * linear * linear / (h * h) +
                           cs_barrier_energy(flight->d - linear, range, k) +
                           flight->other * linear;
    const double by_flight = 0.5 * m * flight->w1 * flight->w1 +
                             cs_barrier_energy(flight->d1, range, k) +
                             flight->other * (flight->d - flight->d1);
    const double missed = fmax(cs_barrier_missed(&model, flight->d - free, free),
                               cs_barrier_missed(&model, flight->d - linear, linear));
    return fmax(missed, fabs(by_step - by_flight)) > MISSED_MAX * energy;
}

/* One collider and the step, for all particles. */
struct search {
    const struct cs_system *system;
    struct cs_posed_collider_law law;
    uint32_t collider;
    double h;
    double fastest; /* m/s of the collider's matter near particles; HUGE_VAL: it turns */
    const double *x, *v, *f;
};

/* A particle at the begin of a step: velocity v relative to the surface, force of the contact
 * itself, and gradient of the distance. */
struct start {
    double v[3], own[3], g[3];
    double square; /* g.g */
};

/* g.g, below 1 in the smoothed bands at the edges of a box; exactly 1 where it is but for
 * rounding. */
static double squared_gradient(const double g[3]) {
    const double square = cs_vec3_dot(g, g);
    return fabs(square - 1) < 1e-12 ? 1 : square;
}

/* Sets *start and *flight of particle i. Returns false if the distance has no direction. */
static bool approach(const struct search *search, size_t i, struct start *start,
                     struct flight *flight) {
    const size_t n = search->system->view.n;
    const struct cs_posed_collider_law *law = &search->law;
    double p[3], v[3], w[3], f[3];
    cs_point_read(search->x, n, i, p);
    cs_point_read(search->v, n, i, v);
    cs_point_read(search->f, n, i, f);
    memset(start->own, 0, sizeof start->own);
    struct cs_point_contact contact;
    if (cs_posed_collider_law_in_range(law, p, v, &contact)) {
        const struct cs_contact_force_parts parts = {1, 1};
        const struct cs_contact_sample_point point = {
            .n = 1, .particles = {(uint32_t)i}, .w = {1}};
        struct cs_bristle bristle;
        cs_point_contact_force(&contact, parts, start->own);
        if (cs_bristle_of_point(search->system, search->collider, law, &point, p, &bristle))
            cs_bristle_add_force(&contact, &bristle, start->own);
    } else {
        contact.d = cs_posed_collider_smooth_distance(&law->collider, p, contact.g, contact.h);
        cs_posed_collider_velocity(&law->collider, p, w);
        for (int c = 0; c < 3; c++)
            contact.v[c] = v[c] - w[c];
    }
    memcpy(start->v, contact.v, sizeof start->v);
    memcpy(start->g, contact.g, sizeof start->g);
    start->square = squared_gradient(start->g);
    if (!(start->square > 0))
        return false;
    *flight = (struct flight){
        .mass = search->system->mass[i] / start->square,
        .h = search->h,
        .range = law->params.range,
        .k = law->params.k,
        .damping = law->damping,
        .loss = law->loss,
        .rate = law->rate,
        .other = (cs_vec3_dot(start->g, f) - cs_vec3_dot(start->g, start->own)) / start->square,
        .d = contact.d,
        .u = cs_vec3_dot(start->g, start->v)};
    return true;
}

/* Sets the impact and the change of velocity of particle i, if it is in impact. */
static void find_rebound(const struct search *search, size_t i) {
    const size_t n = search->system->view.n;
    struct cs_rebound *rebound = search->system->rebounds->list + i;
    double *change = search->system->rebounds->change + i;
    struct flight flight;
    struct start start;
    double tangent[3];
    if (!approach(search, i, &start, &flight))
        return;
    const double *g = start.g, square = start.square, h = flight.h;
    const double m = search->system->mass[i];
    const double energy = 0.5 * flight.mass * flight.u * flight.u +
                          cs_barrier_energy(flight.d, flight.range, flight.k);
    if (!rebounds(&flight, energy))
        return;
    const double impulse = flight.mass * (flight.w1 - flight.u) - h * flight.other;
    for (int c = 0; c < 3; c++)
        tangent[c] = start.v[c] - flight.u * g[c] / square;
    memcpy(rebound->g, g, sizeof rebound->g);
    rebound->collider = search->collider + 1;
    rebound->stiffness = cs_barrier_at(flight.d1, flight.range, flight.k).stiffness;
    // friction that sticks is as smooth as smooth friction, for r to be finite
    const double mu = search->law.friction + search->law.sticking_friction;
    const double speed = sqrt(cs_vec3_dot(tangent, tangent)), ev = search->law.friction_speed;
    const double taken = mu * fmax(sqrt(square) * impulse, 0) / m;
    const double slid = fmin(taken, fmax(speed - ev, 0));
    const double drag = (taken - slid) / sqrt(speed * speed + ev * ev);
    // T1 is (1 - part)/(1 + drag) of T
    const double part = speed > 0 ? slid / speed : 0;
    rebound->drag = m / h * drag;
    rebound->displacement = (flight.d1 - flight.d - h * flight.w1) / square;
    rebound->distance = flight.d1;
    rebound->energy = energy;
    // the force of the step's begin is among all forces, and is taken out
    const double along = impulse + h * h * rebound->stiffness * (flight.w1 - flight.u);
    for (size_t c = 0; c < 3; c++) {
        rebound->impulse[c] = along * g[c] - m * (part + drag) * tangent[c] - h * start.own[c];
        change[c * n] =
            (flight.w1 - flight.u) * g[c] / square - (part + drag) / (1 + drag) * tangent[c];
    }
}

/* The range, and the longest way of each particle of a row by the forces of the step's begin:
 * no other can come into range. */
CS_CLONES static void find_reaches(const struct search *search, size_t row, size_t count,
                                   double *restrict reach) {
    const size_t n = search->system->view.n;
    const double *v = search->v + row, *f = search->f + row;
    const double *mass = search->system->mass + row;
    const double h = search->h, range = search->law.params.range;
    for (size_t i = 0; i < count; i++) {
        const double speed =
            sqrt(v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        const double force =
            sqrt(f[i] * f[i] + f[n + i] * f[n + i] + f[2 * n + i] * f[2 * n + i]);
        reach[i] = range + (h * (speed + search->fastest) + h * h / mass[i] * force);
    }
}

/* Rows are of one thread: its first particle is the first of a row. */
static void find_all(void *arg, size_t begin, size_t end) {
    const struct search *search = arg;
    const struct cs_rebounds *rebounds = search->system->rebounds;
    const size_t n = search->system->view.n;
    for (size_t row = begin; row < end; row += CS_COLLIDER_ROW) {
        const size_t count = end - row < CS_COLLIDER_ROW ? end - row : CS_COLLIDER_ROW;
        double reach[CS_COLLIDER_ROW];
        uint8_t near[CS_COLLIDER_ROW];
        find_reaches(search, row, count, reach);
        const uint32_t listed = cs_posed_collider_list_near(&search->law.collider, reach, n,
                                                            search->x + row, count, near);
        for (uint32_t k = 0; k < listed; k++) {
            const struct cs_rebound *rebound = rebounds->list + row + near[k];
            if (search->system->inv_mass[row + near[k]] > 0 && rebound->collider == 0)
                find_rebound(search, row + near[k]);
            rebounds->rows[row / CS_COLLIDER_ROW] |= rebound->collider > 0;
        }
    }
}

bool cs_rebound_next(const struct cs_system *system, uint32_t collider, size_t end, size_t *i) {
    const struct cs_rebounds *rebounds = system->rebounds;
    while (*i < end) {
        const uint32_t number = rebounds->list[*i].collider;
        if (!rebounds->rows[*i / CS_COLLIDER_ROW])
            *i += CS_COLLIDER_ROW - *i % CS_COLLIDER_ROW;
        else if (collider == CS_ANY_COLLIDER ? number > 0 : number == collider + 1)
            return true;
        else
            ++*i;
    }
    return false;
}

void cs_rebounds_find(const struct cs_system *system, double t, double h, const double *x,
                      const double *v, const double *f) {
    struct cs_rebounds *rebounds = system->rebounds;
    const size_t n = system->view.n;
    size_t i = 0;
    rebounds->judged = false;
    for (; cs_rebound_next(system, CS_ANY_COLLIDER, n, &i); i++) {
        rebounds->list[i].collider = 0;
        for (size_t c = 0; c < 3; c++)
            rebounds->change[c * n + i] = 0;
    }
    memset(rebounds->rows, 0, n / CS_COLLIDER_ROW + 1);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        if (cs_scene_colliders(system->scene)[c].mesh)
            continue;
        struct search search = {
            .system = system, .collider = c, .h = h, .x = x, .v = v, .f = f};
        cs_posed_collider_law_at(system, c, t, &search.law);
        const struct cs_posed_collider *collider = &search.law.collider;
        search.fastest = cs_vec3_dot(collider->spin, collider->spin) > 0
                             ? HUGE_VAL
                             : sqrt(cs_vec3_dot(collider->velocity, collider->velocity));
        cs_vector_parallel_for(n, find_all, &search);
    }
    i = 0;
    rebounds->any = cs_rebound_next(system, CS_ANY_COLLIDER, n, &i);
}

void cs_rebounds_move(const struct cs_system *system, double h, double *x, double *v) {
    const size_t n = system->view.n;
    const double *change = system->rebounds->change;
    system->rebounds->judged = true;
    for (size_t i = 0; cs_rebound_next(system, CS_ANY_COLLIDER, n, &i); i++) {
        const struct cs_rebound *rebound = system->rebounds->list + i;
        for (size_t k = i, c = 0; c < 3; k += n, c++) {
            v[k] += change[k];
            x[k] += h * change[k] + rebound->displacement * rebound->g[c];
        }
    }
}

double cs_rebounds_work(const struct cs_system *system, double t, const double *x) {
    const size_t n = system->view.n;
    double work = 0;
    for (uint32_t k = 0; system->rebounds->any && k < system->scene->colliders.n; k++) {
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, k, t, &collider);
        for (size_t i = 0; cs_rebound_next(system, k, n, &i); i++) {
            const double p[3] = {x[i], x[n + i], x[2 * n + i]};
            double u[3];
            cs_posed_collider_velocity(&collider, p, u);
            for (size_t c = 0; c < 3; c++)
                work += system->mass[i] * system->rebounds->change[c * n + i] * u[c];
        }
    }
    return work;
}

void cs_rebound_add_block(const struct cs_rebound *rebound, const struct cs_matrix *matrix,
                          double b[6]) {
    const double drag = -matrix->cd * rebound->drag;
    const double along = -matrix->ck * rebound->stiffness - drag / squared_gradient(rebound->g);
    for (int e = 0; e < 6; e++)
        b[e] += along * rebound->g[cs_sym3_row[e]] * rebound->g[cs_sym3_column[e]] +
                (cs_sym3_row[e] == cs_sym3_column[e] ? drag : 0);
}
