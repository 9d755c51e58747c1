/* Forces that only tests have: one of each kind, with closed forms. */
#include "planted_terms.h"
#include "scene/scene.h"

#include "model/force/terms.h"

#include <math.h>

#ifndef PLANTED_START
#define PLANTED_START                                                                          \
    { 0 }
#endif

struct planted planted = PLANTED_START;
const double planted_direction[3] = {0.6, 0, 0.8};

static struct cs_plan_row row_of(bool acts) {
    return (struct cs_plan_row){.built = acts, .reason = acts ? "planted" : "not planted"};
}

static struct cs_plan_row resist_plan(const struct cs_scene *scene) {
    return row_of(scene->bodies.n > 0 && planted.resist != 0);
}

static void add_resistance(const struct cs_system *system, const double *v,
                           const struct cs_block *block, double *f) {
    const size_t n = system->view.n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = block->begin; i < block->end; i++)
            f[c * n + i] -= planted.resist * system->mass[i] * v[c * n + i];
}

static void resist_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    add_resistance(system, at->v, at->block, f);
}

static void resist_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    if (at->dv)
        add_resistance(system, at->dv, at->block, df);
}

static void resist_scalar(const struct cs_system *system, const struct cs_matrix *matrix,
                          size_t begin, size_t end, double *diagonal) {
    for (size_t i = begin; i < end; i++)
        diagonal[i] -= matrix->cd * planted.resist * system->mass[i];
}

static void resist_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    for (size_t i = 0; i < system->view.n; i++)
        sums->damping[i] += planted.resist * system->mass[i];
}

const struct cs_term cs_term_resist = {
    .name = "planted resistance",
    .part_bits = CS_PART_DISSIPATIVE,
    .plan = resist_plan,
    .add_force = resist_force,
    .add_jvp = resist_jvp,
    .add_scalar = resist_scalar,
    .add_bound = resist_bound,
};

static struct cs_plan_row trap_plan(const struct cs_scene *scene) {
    return row_of(scene->bodies.n > 0 && planted.trap != 0);
}

/* n.p of particle i */
static double along(size_t n, const double *p, size_t i) {
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
        sum += planted_direction[c] * p[c * n + i];
    return sum;
}

static double depth(const struct cs_system *system, const double *x, size_t i) {
    return along(system->view.n, x, i) - along(system->view.n, system->start, i);
}

static void trap_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const size_t n = system->view.n;
    for (size_t i = at->block->begin; i < at->block->end; i++) {
        const double q = depth(system, at->x, i), speed = along(n, at->v, i);
        for (size_t c = 0; c < 3; c++) {
            const double u = planted_direction[c];
            if (at->parts & CS_PART_POTENTIAL)
                f[c * n + i] -= planted.trap * q * q * q * u;
            if (at->parts & CS_PART_DISSIPATIVE)
                f[c * n + i] -= planted.trap_damping * q * q * (at->v[c * n + i] - speed * u);
        }
    }
}

static void trap_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    const size_t n = system->view.n;
    for (size_t i = at->block->begin; i < at->block->end; i++) {
        const double q = depth(system, at->x, i), speed = along(n, at->v, i);
        const double dq = at->dx ? along(n, at->dx, i) : 0;
        const double turned = at->dv ? along(n, at->dv, i) : 0;
        for (size_t c = 0; c < 3; c++) {
            const double u = planted_direction[c], dv = at->dv ? at->dv[c * n + i] : 0;
            if (at->parts & CS_PART_POTENTIAL)
                df[c * n + i] -= planted.trap * 3 * q * q * dq * u;
            if (at->parts & CS_PART_DISSIPATIVE)
                df[c * n + i] -=
                    planted.trap_damping *
                    (2 * q * dq * (at->v[c * n + i] - speed * u) + q * q * (dv - turned * u));
        }
    }
}

static double trap_energy(const struct cs_system *system, const struct cs_eval *at) {
    double sum = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        const double q = depth(system, at->x, i);
        sum += planted.trap * q * q * q * q / 4;
    }
    return sum;
}

/* the derivative of the damping by x is left out: it is not symmetric */
static void trap_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                        size_t begin, size_t end, double *blocks) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const size_t n = system->view.n;
    for (size_t i = begin; i < end; i++) {
        const double q = depth(system, matrix->x, i);
        const double k = -matrix->ck * 3 * planted.trap * q * q;
        const double d = -matrix->cd * planted.trap_damping * q * q;
        for (size_t e = 0; e < 6; e++) {
            const double both = planted_direction[row[e]] * planted_direction[column[e]];
            blocks[e * n + i] += k * both + d * ((row[e] == column[e]) - both);
        }
    }
}

static void trap_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                          double *y) {
    const size_t n = system->view.n;
    for (size_t i = 0; i < n; i++) {
        const double q = depth(system, matrix->x, i);
        const double come = -matrix->ck * 3 * planted.trap * q * q * along(n, matrix->v, i);
        for (size_t c = 0; c < 3; c++)
            y[c * n + i] += come * planted_direction[c];
    }
}

static void trap_bound(const struct cs_system *system, const struct cs_eval *at,
                       const struct cs_gershgorin *sums) {
    for (size_t i = 0; i < system->view.n; i++) {
        const double q = depth(system, at->x, i);
        sums->stiffness[i] += 3 * planted.trap * q * q;
        sums->damping[i] += planted.trap_damping * q * q;
    }
}

const struct cs_term cs_term_trap = {
    .name = "planted trap",
    .part_bits = CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,
    .plan = trap_plan,
    .add_force = trap_force,
    .add_jvp = trap_jvp,
    .energy = trap_energy,
    .energy_kind = CS_ENERGY_OTHER,
    .add_blocks = trap_blocks,
    .add_approach = trap_approach,
    .add_state_bound = trap_bound,
};

static struct cs_plan_row attract_plan(const struct cs_scene *scene) {
    return row_of(scene->bodies.n > 0 && planted.attract != 0);
}

static void attract_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const size_t n = system->view.n;
    for (size_t i = at->block->begin; i < at->block->end; i++) {
        const double s = planted.distance + depth(system, at->x, i);
        const double pull = planted.attract * system->mass[i] / (s * fabs(s));
        for (size_t c = 0; c < 3; c++)
            f[c * n + i] -= pull * planted_direction[c];
    }
}

static void attract_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    const size_t n = system->view.n;
    for (size_t i = at->block->begin; at->dx && i < at->block->end; i++) {
        const double s = fabs(planted.distance + depth(system, at->x, i));
        const double slope = 2 * planted.attract * system->mass[i] / (s * s * s);
        for (size_t c = 0; c < 3; c++)
            df[c * n + i] += slope * along(n, at->dx, i) * planted_direction[c];
    }
}

static double attract_energy(const struct cs_system *system, const struct cs_eval *at) {
    double sum = 0;
    for (size_t i = 0; i < system->view.n; i++)
        sum -= planted.attract * system->mass[i] /
               fabs(planted.distance + depth(system, at->x, i));
    return sum;
}

/* the slope only pulls apart: a definite matrix has none of it */
static void attract_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                           size_t begin, size_t end, double *blocks) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    const size_t n = system->view.n;
    for (size_t i = begin; i < end && !matrix->psd; i++) {
        const double s = fabs(planted.distance + depth(system, matrix->x, i));
        const double k = matrix->ck * 2 * planted.attract * system->mass[i] / (s * s * s);
        for (size_t e = 0; e < 6; e++)
            blocks[e * n + i] += k * planted_direction[row[e]] * planted_direction[column[e]];
    }
}

static void attract_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                             double *y) {
    const size_t n = system->view.n;
    for (size_t i = 0; i < n && !matrix->psd; i++) {
        const double s = fabs(planted.distance + depth(system, matrix->x, i));
        const double k = matrix->ck * 2 * planted.attract * system->mass[i] / (s * s * s);
        for (size_t c = 0; c < 3; c++)
            y[c * n + i] += k * along(n, matrix->v, i) * planted_direction[c];
    }
}

static void attract_bound(const struct cs_system *system, const struct cs_eval *at,
                          const struct cs_gershgorin *sums) {
    for (size_t i = 0; i < system->view.n; i++) {
        const double s = fabs(planted.distance + depth(system, at->x, i));
        sums->stiffness[i] += 2 * planted.attract * system->mass[i] / (s * s * s);
    }
}

const struct cs_term cs_term_attract = {
    .name = "planted attraction",
    .part_bits = CS_PART_POTENTIAL,
    .plan = attract_plan,
    .add_force = attract_force,
    .add_jvp = attract_jvp,
    .energy = attract_energy,
    .energy_kind = CS_ENERGY_GRAVITY,
    .add_blocks = attract_blocks,
    .add_approach = attract_approach,
    .add_state_bound = attract_bound,
};

static struct cs_plan_row swing_plan(const struct cs_scene *scene) {
    return row_of(scene->bodies.n > 0 && planted.swing != 0);
}

static void swing_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    planted.calls++;
    for (size_t i = at->block->begin; i < at->block->end; i++)
        f[i] += system->mass[i] * planted.swing * cos(3 * at->t);
}

static double swing_strongest(const struct cs_system *system, size_t i) {
    return system->mass[i] * planted.swing;
}

const struct cs_term cs_term_swing = {
    .name = "planted swing",
    .part_bits = CS_PART_EXTERNAL,
    .plan = swing_plan,
    .add_force = swing_force,
    .max_acceleration = swing_strongest,
};
