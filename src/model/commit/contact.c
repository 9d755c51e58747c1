/* contact.c - all particles against all obstacles, and the energy of it; see contact.h. */
#include "model/commit/contact.h"

#include "base/vector.h"
#include "model/commit/touch.h"

#include <stdatomic.h>
#include <string.h>

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
    double p[3], v[3], last[3];
    unsigned pushed = 0;
    take(step->x, n, i, p);
    take(step->v, n, i, v);
    take(contact->last, n, i, last);
    for (uint32_t k = 0; k < contact->system->scene->colliders.n; k++) {
        const enum cs_touch touch =
            cs_touch_resolve(contact->obstacles + k, step->dt, last, p, v);
        if (touch == CS_TOUCH_NONE)
            continue;
        pushed++;
        contact->stick.on[i] = touch == CS_TOUCH_STUCK ? k + 1 : 0;
    }
    put(p, n, i, contact->to);
    put(v, n, i, contact->to + 3 * n);
    return pushed;
}

static void meet_part(void *arg, size_t begin, size_t end) {
    struct step *step = arg;
    struct cs_contact *contact = step->contact;
    const struct cs_system *system = contact->system;
    uint64_t tested = 0, pushed = 0;
    for (size_t i = begin; i < end; i++) {
        const bool free = system->inv_mass[i] > 0 && !contact->stick.held[i];
        tested += free;
        contact->pushed[i] = free && is_behind_any(step, i);
        if (contact->pushed[i])
            pushed += meet_all(step, i);
        else if (free)
            contact->stick.on[i] = 0;
    }
    step->tests += tested * system->scene->colliders.n;
    step->pushed += pushed;
}

/* the particles that were not pushed; to those that are held the body gives way as to pushed
 * ones */
static void complete(const struct step *step) {
    struct cs_contact *contact = step->contact;
    const size_t n = count_of(contact);
    for (size_t i = 0; i < n; i++) {
        if (contact->pushed[i])
            continue;
        for (size_t c = 0; c < 3; c++) {
            contact->to[c * n + i] = step->x[c * n + i];
            contact->to[(3 + c) * n + i] = step->v[c * n + i];
        }
        contact->pushed[i] = contact->stick.held[i];
    }
}

/* what the pushes come to */
static void push(const struct step *step) {
    struct cs_contact *contact = step->contact;
    const size_t n3 = 3 * count_of(contact);
    const struct cs_blow blow = {.t = step->t,
                                 .dt = step->dt,
                                 .obstacles = contact->obstacles,
                                 .last = contact->last,
                                 .x = step->x,
                                 .v = step->v,
                                 .to = contact->to,
                                 .pushed = contact->pushed};
    complete(step);
    // who is left behind a surface is not at rest on it
    if (!cs_balance_hold(&contact->balance, &blow))
        cs_stick_reject(&contact->stick);
    memcpy(step->x, contact->to, n3 * sizeof *step->x);
    memcpy(step->v, contact->to + n3, n3 * sizeof *step->v);
}

bool cs_contact_resolve(struct cs_contact *contact, double t, double dt, double *x, double *v) {
    const size_t n = count_of(contact);
    struct step step = {.contact = contact, .t = t, .dt = dt, .x = x, .v = v};
    const bool restored = cs_stick_restore(&contact->stick, dt, contact->last, x, v);
    cs_obstacles_at(contact->system, t, contact->obstacles);
    cs_vector_share(n, meet_part, &step);
    contact->counts.tests += step.tests;
    contact->counts.pushed += step.pushed;
    if (step.pushed > 0)
        push(&step);
    contact->balance.known = step.pushed > 0;
    contact->balance.touching &= step.pushed > 0 || contact->stick.n > 0;
    return step.pushed > 0 || restored;
}

bool cs_contact_hold(struct cs_contact *contact, double t, const double *x, const double *v) {
    return cs_stick_choose(&contact->stick, contact->obstacles, t, x, v, contact->to);
}

void cs_contact_keep(struct cs_contact *contact, const double *x, const double *v,
                     bool resolved) {
    const size_t n3 = 3 * count_of(contact);
    memcpy(contact->last, x, n3 * sizeof *x);
    memcpy(contact->last + n3, v, n3 * sizeof *v);
    contact->balance.known &= resolved;
}

void cs_contact_record(struct cs_contact *contact, struct cs_record *record) {
    cs_record_bytes(record, contact->last, 6 * count_of(contact) * sizeof *contact->last);
    CS_RECORD(record, contact->counts);
    cs_stick_record(&contact->stick, record);
    cs_balance_record(&contact->balance, record);
}

void cs_contact_start(struct cs_contact *contact, double t, const double *x, const double *v) {
    cs_contact_keep(contact, x, v, false);
    contact->balance.touching = false;
    cs_obstacles_at(contact->system, t, contact->obstacles);
    cs_stick_start(&contact->stick, contact->obstacles, t, x, v, contact->to);
}

enum cs_status cs_contact_init(struct cs_contact *contact, struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error) {
    const size_t n = system->view.n;
    *contact = (struct cs_contact){.system = system};
    contact->obstacles =
        cs_arena_take_n(arena, system->scene->colliders.n, sizeof *contact->obstacles, error);
    contact->last = cs_arena_take_n(arena, 6 * n, sizeof(double), error);
    contact->to = cs_arena_take_n(arena, 6 * n, sizeof(double), error);
    contact->pushed = cs_arena_take_n(arena, n, sizeof(bool), error);
    if (error->status || cs_stick_init(&contact->stick, system, arena, error))
        return error->status;
    return cs_balance_init(&contact->balance, system, arena, error);
}
