/* friction_chord.h - friction of one contact as a method that is linear in a step should take
 * it.
 *
 * Friction f(T) = -L T/s(T), s(T) = sqrt(T.T + ev^2), turns within about ev. Its slope at the
 * velocity T where a step begins says nothing of where the step ends: with the slope L/ev at
 * rest a body that should slide sticks, and with the slope next to 0 while it slides it is
 * thrown back beyond rest, to and fro. The chord from T to the velocity at the end of the step
 * makes the linear step exact, and that velocity is known well enough from the contact alone:
 * with its mass m, the force F on it and the tangential projector P, implicit Euler has
 *
 *   T_free = T + (h/m) (P F + L T/s(T)),   e = T_free/|T_free|
 *   u + (h L/m) u/s(u) = |T_free|          the velocity at the end is u e
 *
 * and then, along = T.e, the slope -[p (P - e e^T) + c e e^T] with
 *
 *   c = L (u/s(u) - along/s(T)) / (u - along),   p = max(c, L/max(s(T), s(u)))
 *
 * L is the load of the step's end. At colliders it is mu times the F1 that the linear step has
 * there, by the contact alone along its normal: with the approach w = g.v, the force f0 along
 * it without the damper's and the drag r = tau K + alpha F/s of the normal,
 *
 *   F1 = max(F - h K w1, 0),   w1 = (w + (h/m) f0) / (1 + (h/m) (r + h K))
 *
 * so that friction takes mu times the impulse of the normal, also in a landing, and b loses h
 * (L1 - L) T/s(T). By the F of the begin a sheet that landed stopped 2 cm early. F serves
 * pairs, stacks, where others move the contact too, and round surfaces, around which the
 * clamped matrix already holds what slides.
 *
 * c is L ev^2/s^3 where u and `along` agree. Several contacts of a point are taken as one with
 * the sum of their loads, of whose slope each has its fraction.
 *
 * F has the friction of other contacts as it is at the begin of the step. In a stack, where it
 * turns too, that is a wrong guess. After a solve the velocity at the end is known instead
 * (is_end_known): u e is the tangential part of T + h F/m with the F of the whole step, and the
 * chord goes there. Inlined and without branches,
 * because loops over lanes are hot. */
#ifndef CS_CONTACT_FRICTION_CHORD_H
#define CS_CONTACT_FRICTION_CHORD_H

#include "base/vector.h"
#include "model/contact/point_contact.h"

#include <float.h>

/* Accelerations of a contact point in a step. */
struct cs_contact_pull {
    double h;          /* s, of the step */
    double inverse;    /* 1/kg: 1/m = sum w_k^2/m_k over the particles behind the point */
    double motion[3];  /* m/s2: F/m = sum w_k F_k/m_k of all forces F_k */
    double push[3];    /* m/s2: the same of the elastic forces of contact alone */
    bool is_end_known; /* motion is that of the whole step */
};

/* Newton's iterations for the velocity: from the start below 5 are enough for all digits, for
 * h L/(m ev) from 1e-6 to 1e12. Tested by physics friction_chord. */
enum { CS_FRICTION_CHORD_ITERATIONS = 6 };

/* u >= 0 of u + a u/s(u) = length, for a >= 0. The left side is concave, so that Newton's
 * iteration comes from below from its first step on. It starts at a lower bound, or closer: at
 * ev length/sqrt(a^2 - length^2) below the limit of friction, which is its root without the
 * first u, and near that limit at ev (a/2 ev)^(1/3), by square roots. */
CS_INLINE double cs_friction_chord_speed(double a, double ev, double length) {
    const double low = cs_fmax(length - a, length * ev / (ev + a));
    const double fourth = sqrt(sqrt(0.5 * a / ev)), sixteenth = sqrt(sqrt(fourth));
    const double limit = ev * fourth * sixteenth * sqrt(sqrt(sixteenth));
    const double inside = cs_fmax(a * a - length * length, DBL_MIN);
    const double below = cs_fmin(ev * length / sqrt(inside), limit);
    double u = cs_fmin(length < a ? below : limit, length);
    u = cs_fmax(low, u);
    CS_UNROLLED
    for (int k = 0; k < CS_FRICTION_CHORD_ITERATIONS; k++) {
        const double s = sqrt(u * u + ev * ev), slope = 1 + a * ev * ev / (s * s * s);
        u = cs_fmax(low, u - (u + a * u / s - length) / slope);
    }
    return u;
}

/* A contact that slides: unit normal, relative velocity in m/s, force of the barrier in N at
 * the begin and at the end, negative for a feature that is subtracted; mu and ev. */
struct cs_sliding_contact {
    double n[3], v[3], force, end_force, friction, friction_speed;
};

/* The fraction that a contact has of all contact at its point, 0..1, by what both push along n.
 */
CS_INLINE double cs_friction_chord_fraction(const struct cs_contact_pull *pull,
                                            const struct cs_sliding_contact *contacts) {
    const double force = contacts->force < 0 ? -contacts->force : contacts->force;
    const double own = force * pull->inverse + DBL_MIN;
    return own / cs_fmax(own, cs_vec3_dot(contacts->n, pull->push));
}

/* F1 in N along g, of a contact at a collider; F where that is round, or other contacts push
 * the point too. */
CS_INLINE double cs_friction_chord_end_force(const struct cs_point_contact *contact,
                                             const struct cs_contact_pull *pull) {
    const double h = pull->h, square = cs_point_contact_square(contact->g);
    const double approach = cs_vec3_dot(contact->g, contact->v);
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const double drag = contact->damping * barrier.stiffness +
                        cs_point_contact_loss(contact, &barrier, approach);
    const double inverse = square * pull->inverse, own = inverse * barrier.force;
    const double others = cs_vec3_dot(contact->g, pull->push) - own;
    const double change = h * (cs_vec3_dot(contact->g, pull->motion) +
                               (pull->is_end_known ? 0 : inverse * drag * approach));
    const double held = h * (drag + h * barrier.stiffness) * inverse;
    const double end = (approach + change) / (1 + (pull->is_end_known ? 0 : held));
    double curvature = 0;
    for (int e = 0; e < 6; e++)
        curvature += contact->h[e] * contact->h[e];
    return curvature > 0 || others > 1e-6 * own || others < -1e-6 * own
               ? barrier.force
               : cs_fmax(0, barrier.force - h * barrier.stiffness * end);
}

/* b (6) += h times the block p (P - e e^T) + c e e^T of a contact. */
CS_INLINE void cs_friction_chord_add(const struct cs_contact_pull *pull,
                                     const struct cs_sliding_contact *contacts, double b[6]) {
    const double *n = contacts->n, *v = contacts->v, ev = contacts->friction_speed;
    const double force = contacts->force, mu = contacts->friction;
    const double end = contacts->end_force;
    double free[3], e[3], t[3];
    const double speed = cs_sliding_velocity(n, 1, v, ev, t);
    cs_sliding_velocity(n, 1, pull->motion, 0, free);
    const double load =
        mu * (force < 0 ? -force : force) / cs_friction_chord_fraction(pull, contacts);
    const double more = mu * ((end < 0 ? -end : end) - (force < 0 ? -force : force));
    const double a = pull->h * (load + more) * pull->inverse;
    const double begin = pull->h * load * pull->inverse;
    CS_UNROLLED
    for (int c = 0; c < 3; c++)
        free[c] = t[c] + pull->h * free[c] + (pull->is_end_known ? 0 : begin * t[c] / speed);
    const double length = sqrt(cs_vec3_dot(free, free));
    CS_UNROLLED
    for (int c = 0; c < 3; c++)
        e[c] = free[c] / (length + DBL_MIN);
    const double u = pull->is_end_known ? length : cs_friction_chord_speed(a, ev, length);
    const double s = sqrt(u * u + ev * ev);
    const double along = cs_vec3_dot(t, e), way = u - along;
    const double size = 1e-9 * (s + speed);
    const bool apart = way > size || way < -size;
    const double chord = (u / s - along / speed) / (apart ? way : 1);
    // where T and e differ in direction it may be negative, or above the greatest slope
    const double held = cs_fmin(cs_fmax(chord, 0), 1 / ev);
    const double c = apart ? held : ev * ev / (s * s * s);
    const double p = cs_fmax(c, 1 / cs_fmax(s, speed));
    CS_UNROLLED
    for (int k = 0; k < 6; k++) {
        const int r = cs_sym3_row[k], q = cs_sym3_column[k];
        b[k] += pull->h * mu * end * (p * ((r == q) - n[r] * n[q]) - (p - c) * e[r] * e[q]);
    }
}

/* cs_point_contact_add_block with friction by the chord. cd = -h. */
CS_INLINE void cs_friction_chord_add_block(const struct cs_point_contact *contact,
                                           const struct cs_matrix *matrix,
                                           const struct cs_contact_pull *pull, double b[6]) {
    const double length = sqrt(cs_point_contact_square(contact->g));
    const struct cs_sliding_contact contacts = {
        .n = {contact->g[0] / length, contact->g[1] / length, contact->g[2] / length},
        .v = {contact->v[0], contact->v[1], contact->v[2]},
        .force = cs_barrier_at(contact->d, contact->range, contact->k).force * length,
        .end_force = cs_friction_chord_end_force(contact, pull) * length,
        .friction = contact->friction,
        .friction_speed = contact->friction_speed};
    struct cs_point_contact frictionless = *contact;
    frictionless.friction = 0;
    cs_point_contact_add_block(&frictionless, matrix, b);
    cs_friction_chord_add(pull, &contacts, b);
}

/* y += h (L1 - L) T/s(T), which b loses. */
CS_INLINE void cs_friction_chord_add_approach(const struct cs_point_contact *contact,
                                              const struct cs_contact_pull *pull, double y[3]) {
    const double square = cs_point_contact_square(contact->g);
    const double more = cs_friction_chord_end_force(contact, pull) -
                        cs_barrier_at(contact->d, contact->range, contact->k).force;
    double t[3];
    const double speed =
        cs_sliding_velocity(contact->g, square, contact->v, contact->friction_speed, t);
    for (int c = 0; c < 3; c++)
        y[c] += pull->h * contact->friction * more * sqrt(square) / speed * t[c];
}

/* The pull of a point without particles yet; cd = -h. */
CS_INLINE struct cs_contact_pull cs_contact_pull_begin(const struct cs_matrix *matrix) {
    return (struct cs_contact_pull){
        .h = -matrix->cd, .is_end_known = matrix->chord && matrix->chord->is_end_known};
}

/* Adds what a particle with weight w contributes to the point. */
CS_INLINE void cs_contact_pull_add(struct cs_contact_pull *pull, const struct cs_matrix *matrix,
                                   size_t n, size_t i, double inverse_mass, double w) {
    pull->inverse += w * w * inverse_mass;
    for (size_t c = 0; c < 3; c++) {
        pull->motion[c] += w * inverse_mass * matrix->chord->all[c * n + i];
        pull->push[c] += w * inverse_mass * matrix->chord->contact[c * n + i];
    }
}

#endif
