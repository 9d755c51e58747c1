/* bristle_law.c - the force of a bristle, its derivatives, and the spring that a step leaves.
 */
#include "model/contact/bristle_law.h"

#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* Relative distance from the limit within which a point that slides on counts as slipping: the
 * rounding of an anchor that followed. */
#define AT_LIMIT 1e-9

/* State of a bristle: its trial force and what is left of it. */
struct trial {
    double square;                 /* g.g, never 0 */
    double stretch[3], sliding[3]; /* P (x - a) in m, T in m/s */
    double force[3], length;       /* trial and |trial| in N */
    double load, fraction;         /* mu N, and min(1, mu N/|trial|) */
    bool slips;
};

static struct trial trial_of(const struct cs_point_contact *contact,
                             const struct cs_bristle *bristle) {
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    struct trial trial = {.square = cs_point_contact_square(contact->g)};
    cs_sliding_velocity(contact->g, trial.square, bristle->stretch, 0, trial.stretch);
    cs_sliding_velocity(contact->g, trial.square, contact->v, 0, trial.sliding);
    for (int c = 0; c < 3; c++)
        trial.force[c] =
            bristle->stiffness * trial.stretch[c] + bristle->damping * trial.sliding[c];
    trial.length = sqrt(cs_vec3_dot(trial.force, trial.force));
    trial.load = bristle->friction * barrier.force * sqrt(trial.square);
    trial.fraction = trial.length > trial.load ? trial.load / trial.length : 1;
    // a spring at the limit: in slip if the point goes on
    trial.slips = trial.length > trial.load * (1 + AT_LIMIT) ||
                  (trial.length > trial.load * (1 - AT_LIMIT) &&
                   cs_vec3_dot(trial.force, trial.sliding) > 0);
    return trial;
}

void cs_bristle_add_force(const struct cs_point_contact *contact,
                          const struct cs_bristle *bristle, double f[3]) {
    const struct trial trial = trial_of(contact, bristle);
    for (int c = 0; c < 3; c++)
        f[c] -= trial.fraction * trial.force[c];
}

/* A change of g and of g.g along a motion. */
struct turn {
    const double *g;
    double dg[3], square, dsquare;
};

/* out += factor d(P u), with d(P u) = du - dg a - g da and a = g.u/g.g. */
static void add_projected_change(const struct turn *turn, const double u[3], const double du[3],
                                 double factor, double out[3]) {
    const double *g = turn->g, *dg = turn->dg, a = cs_vec3_dot(g, u) / turn->square;
    const double da =
        (cs_vec3_dot(dg, u) + cs_vec3_dot(g, du) - a * turn->dsquare) / turn->square;
    for (int c = 0; c < 3; c++)
        out[c] += factor * (du[c] - dg[c] * a - g[c] * da);
}

void cs_bristle_add_jvp(const struct cs_point_contact *contact,
                        const struct cs_bristle *bristle,
                        const struct cs_point_contact_motion *motion, double df[3]) {
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const struct trial trial = trial_of(contact, bristle);
    const double *g = contact->g, *dp = motion->dp;
    struct turn turn = {.g = g, .square = trial.square};
    cs_sym3_multiply(contact->h, dp, turn.dg);
    const double across = cs_vec3_dot(g, turn.dg), length = sqrt(trial.square);
    double dtrial[3] = {0};
    turn.dsquare = 2 * across;
    add_projected_change(&turn, bristle->stretch, dp, bristle->stiffness, dtrial);
    add_projected_change(&turn, contact->v, motion->dv, bristle->damping, dtrial);
    if (!trial.slips || trial.length == 0) {
        for (int c = 0; c < 3; c++)
            df[c] -= dtrial[c];
        return;
    }
    // in slip f = -L e with e = trial/|trial|: L changes with the load, e across itself
    const double dd = cs_vec3_dot(g, dp) + motion->extra_dd;
    const double dload =
        bristle->friction * (barrier.force * across / length - barrier.stiffness * dd * length);
    const double along = cs_vec3_dot(trial.force, dtrial) / (trial.length * trial.length);
    const double fraction = trial.load / trial.length;
    for (int c = 0; c < 3; c++)
        df[c] -= fraction * (dtrial[c] - along * trial.force[c]) +
                 dload / trial.length * trial.force[c];
}

/* b (6) += the symmetric part that the solver uses, with s = min(1, mu N/|trial|) and e =
 * trial/|trial|:
 *
 *   -(ck k_t + cd c_t) s (I - n n^T - e e^T)      e e^T only where it slips
 *
 * Left out: the change of the load and of the normal. It is never negative with cd, ck <= 0.
 * bound: leaves out e e^T too, an upper bound. */
static void add_block(const struct cs_point_contact *contact, const struct cs_bristle *bristle,
                      const struct cs_matrix *matrix, double b[6]) {
    const struct trial trial = trial_of(contact, bristle);
    const double *g = contact->g, *e = trial.force;
    // along a trial that slips the force does not grow
    const bool turns = trial.slips && !matrix->bound && trial.length > 0;
    const double slope =
        -(matrix->ck * bristle->stiffness + matrix->cd * bristle->damping) * trial.fraction;
    const double slip = turns ? 1 / (trial.length * trial.length) : 0;
    for (int k = 0; k < 6; k++) {
        const int r = cs_sym3_row[k], s = cs_sym3_column[k];
        b[k] += slope * ((r == s) - g[r] * g[s] / trial.square - slip * e[r] * e[s]);
    }
}

/* h K T of an approach: in slip the bristle is stretched across the trial alone. */
static void elastic_change(const struct cs_bristle *bristle, const struct trial *trial,
                           bool bound, double h, double out[3]) {
    const double squared = trial->length * trial->length;
    const double along = trial->slips && !bound && squared > 0
                             ? cs_vec3_dot(trial->force, trial->sliding) / squared
                             : 0;
    for (int c = 0; c < 3; c++)
        out[c] = h * bristle->stiffness * trial->fraction *
                 (trial->sliding[c] - along * trial->force[c]);
}

/* The slopes of a linear step: c r r^T + p (P - d d^T) with unit vectors r and d. */
struct chord {
    double r[3], d[3], c, p;
};

/* Makes a vector one of length 1 if it is longer than `tiny`, else 0; returns its length. */
static double unit(double v[3], double tiny) {
    const double length = sqrt(cs_vec3_dot(v, v));
    for (int c = 0; c < 3; c++)
        v[c] = length > tiny ? v[c] / length : 0;
    return length;
}

/* Returns false if the point rests now and at the end of the step: the exact slopes hold. */
static bool find_chord(const struct cs_bristle *bristle, const struct trial *trial,
                       const struct cs_contact_pull *pull, const double g[3], bool bound,
                       struct chord *chord) {
    const double h = pull->h, stiff = h * bristle->stiffness + bristle->damping;
    double free[3], z[3], then[3], change[3], speed = 0;
    cs_sliding_velocity(g, trial->square, pull->motion, 0, free);
    for (int c = 0; c < 3; c++) {
        free[c] = trial->sliding[c] +
                  h * (free[c] + trial->fraction * trial->force[c] * pull->inverse);
        z[c] = (bristle->stiffness * trial->stretch[c] + stiff * free[c]) /
               (1 + h * pull->inverse * stiff);
    }
    const double size = sqrt(cs_vec3_dot(z, z));
    const double fraction = size > trial->load ? trial->load / size : 1;
    if (!trial->slips && fraction == 1)
        return false;
    // from the velocity now to that at the end, and the change of friction on the way
    elastic_change(bristle, trial, bound, h, change);
    for (int c = 0; c < 3; c++) {
        const double u = free[c] - h * pull->inverse * fraction * z[c];
        chord->d[c] = u - trial->sliding[c];
        chord->r[c] = fraction * z[c] - trial->fraction * trial->force[c] - change[c];
        then[c] = bristle->stiffness * trial->stretch[c] + stiff * u;
        speed += fabs(u) + fabs(trial->sliding[c]);
    }
    const double both = cs_vec3_dot(chord->r, chord->d), end = sqrt(cs_vec3_dot(then, then));
    const double way = unit(chord->d, 1e-9 * speed), r = unit(chord->r, 1e-12 * trial->load);
    if (way <= 1e-9 * speed)
        memcpy(chord->d, z, sizeof z), unit(chord->d, 0);
    chord->c = both > 1e-9 * r * way ? fmin(r * r / both, stiff) : 0;
    chord->p = end > trial->load ? stiff * trial->load / end : stiff;
    return true;
}

void cs_bristle_add_matrix(const struct cs_point_contact *contact,
                           const struct cs_bristle *bristle, const struct cs_matrix *matrix,
                           const struct cs_contact_pull *pull, double b[6]) {
    const struct trial trial = trial_of(contact, bristle);
    const double *g = contact->g;
    struct chord chord;
    if (!matrix->chord || !find_chord(bristle, &trial, pull, g, matrix->bound, &chord)) {
        add_block(contact, bristle, matrix, b);
        return;
    }
    // cd = -h and ck = -h^2 are in c and p
    for (int k = 0; k < 6; k++) {
        const int i = cs_sym3_row[k], j = cs_sym3_column[k];
        const double plane = (i == j) - g[i] * g[j] / trial.square - chord.d[i] * chord.d[j];
        b[k] += pull->h * (chord.p * plane + chord.c * chord.r[i] * chord.r[j]);
    }
}

void cs_bristle_add_approach(const struct cs_point_contact *contact,
                             const struct cs_bristle *bristle, const struct cs_matrix *matrix,
                             double y[3]) {
    const struct cs_matrix elastic = {.ck = matrix->ck, .bound = matrix->bound};
    double b[6] = {0}, change[3];
    add_block(contact, bristle, &elastic, b);
    cs_sym3_multiply(b, contact->v, change);
    for (int c = 0; c < 3; c++)
        y[c] += change[c];
}

bool cs_bristle_slips(const struct cs_point_contact *contact, const struct cs_bristle *bristle,
                      double stretch[3]) {
    const struct trial trial = trial_of(contact, bristle);
    const double length = sqrt(cs_vec3_dot(trial.stretch, trial.stretch));
    const double spring = bristle->stiffness * length;
    if (trial.fraction == 1 || spring <= trial.load)
        return false;
    for (int c = 0; c < 3; c++)
        stretch[c] = trial.stretch[c] * (trial.load / spring);
    return true;
}
