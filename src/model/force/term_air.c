/* Air: drag f = -c v of still air, and wind f = s w |w.n| with unit direction w and the
 * particle's unit normal n (cloth thesis, eq. 5.34). Either is per particle, or times the
 * particle's share of the area. */
#include "model/force/normals.h"
#include "model/force/terms.h"

#include <math.h>

static double share_of(const struct cs_system *system, bool by_area, uint32_t i) {
    return by_area ? system->area[i] : 1;
}

static void drag_force(const struct cs_system *system, double t, const double *x,
                       const double *v, uint32_t parts, const struct cs_block *block,
                       double *f) {
    (void)t, (void)x, (void)parts;
    const uint32_t n = system->view.n;
    const struct cs_forces *forces = &system->scene->forces;
    for (uint32_t c = 0; c < 3; c++, f += n, v += n)
        for (uint32_t i = block->begin; i < block->end; i++)
            f[i] -=
                forces->drag * share_of(system, forces->drag_unit == CS_DRAG_AREA, i) * v[i];
}

static void drag_jvp(const struct cs_system *system, double t, const double *x, const double *v,
                     uint32_t parts, const double *dx, const double *dv,
                     const struct cs_block *block, double *df) {
    (void)dx, (void)v;
    if (dv)
        drag_force(system, t, x, dv, parts, block, df);
}

static void drag_diagonal(const struct cs_system *system, const double *x, double *kxx,
                          double *dvv) {
    (void)x, (void)kxx;
    const uint32_t n = system->view.n;
    const struct cs_forces *forces = &system->scene->forces;
    for (uint32_t i = 0; i < n; i++) {
        const double c = forces->drag * share_of(system, forces->drag_unit == CS_DRAG_AREA, i);
        dvv[i] -= c;
        dvv[3 * (size_t)n + i] -= c;
        dvv[5 * (size_t)n + i] -= c;
    }
}

const struct cs_term cs_term_drag = {
    .parts = CS_PART_DRAG,
    .feature = CS_FEATURE_DRAG,
    .add_force = drag_force,
    .add_jvp = drag_jvp,
    .add_diagonal = drag_diagonal,
};

static void wind_force(const struct cs_system *system, double t, const double *x,
                       const double *v, uint32_t parts, const struct cs_block *block,
                       double *f) {
    (void)t, (void)x, (void)v, (void)parts;
    const uint32_t n = system->view.n;
    const struct cs_wind *wind = &system->scene->forces.wind;
    const double *w = wind->direction;
    const double *nx = system->normals, *ny = nx + n, *nz = ny + n;
    for (uint32_t i = block->begin; i < block->end; i++) {
        const double push = wind->strength *
                            share_of(system, wind->strength_unit == CS_WIND_PA, i) *
                            fabs(w[0] * nx[i] + w[1] * ny[i] + w[2] * nz[i]);
        f[i] += push * w[0];
        f[n + (size_t)i] += push * w[1];
        f[2 * (size_t)n + i] += push * w[2];
    }
}

/* d|w.n| = sign(w.n) w.dn */
static void wind_jvp(const struct cs_system *system, double t, const double *x, const double *v,
                     uint32_t parts, const double *dx, const double *dv,
                     const struct cs_block *block, double *df) {
    (void)t, (void)v, (void)parts, (void)dv;
    if (!dx)
        return;
    const uint32_t n = system->view.n;
    const struct cs_wind *wind = &system->scene->forces.wind;
    const double *w = wind->direction;
    const double *nx = system->normals, *ny = nx + n, *nz = ny + n;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        const uint32_t end = body->first + body->count;
        for (uint32_t i = block->begin > body->first ? block->begin : body->first;
             i < end && i < block->end; i++) {
            double dn[3];
            cs_normal_derivative(system, body, i, x, dx, dn);
            const double facing = w[0] * nx[i] + w[1] * ny[i] + w[2] * nz[i];
            const double turn = w[0] * dn[0] + w[1] * dn[1] + w[2] * dn[2];
            const double push = (facing < 0 ? -wind->strength : wind->strength) *
                                share_of(system, wind->strength_unit == CS_WIND_PA, i) * turn;
            df[i] += push * w[0];
            df[n + (size_t)i] += push * w[1];
            df[2 * (size_t)n + i] += push * w[2];
        }
    }
}

const struct cs_term cs_term_wind = {
    .parts = CS_PART_WIND,
    .feature = CS_FEATURE_WIND,
    .add_force = wind_force,
    .add_jvp = wind_jvp,
};
