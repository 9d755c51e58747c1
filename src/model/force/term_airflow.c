/* term_airflow.c - the force of air that moves at forces.wind.velocity.
 *
 * With the velocity u of the air against a particle, its unit normal n, the area A and the
 * density rho,
 *   F(u, n) = rho A / 2 c |u.n| (u.n) n,
 * the pressure of the flow across the surface (Hoerner 1965, ch. 3: c is 1.2 of a plate that
 * faces it); along u it is drag, across u lift. F is the slope by u of the convex
 * rho A c |u.n|^3 / 6.
 *
 * The force F(w - v, n) of wind w is two parts. F(w, n), as if the cloth stood still, has the
 * bit of the wind: its derivative by places is not symmetric. F(w - v, n) - F(w, n) is against
 * the velocity: as the slope of a convex function it takes energy at any v, and its derivative
 * by v, -rho A c |u.n| n n^T, is in the solver's matrix. */
#include "model/force/term.h"
#include "model/force/terms.h"

#include "base/vec3.h"
#include "scene/force_keys.h"

#include <math.h>

static struct cs_plan_row plan_airflow(const struct cs_scene *scene) {
    const bool flows = scene->forces->wind.present && !isnan(scene->forces->wind.velocity[0]);
    return (struct cs_plan_row){
        .built = flows, .reason = flows ? "forces.wind.velocity; it needs normals" : NULL};
}

static uint32_t uses(const struct cs_scene *scene) {
    (void)scene;
    return CS_USE_NORMALS | CS_USE_AREA;
}

/* rho A c / 2 of particle i, in kg/m. */
static double scale_of(const struct cs_system *system, size_t i) {
    const struct cs_wind *wind = &system->scene->forces->wind;
    return 0.5 * wind->density * wind->drag * system->area[i];
}

/* u = w - v of particle i; v NULL: w. */
static void flow_past(const struct cs_system *system, const double *v, size_t i, double u[3]) {
    for (size_t c = 0; c < 3; c++)
        u[c] = system->scene->forces->wind.velocity[c] - (v ? v[c * system->view.n + i] : 0);
}

/* Force of the chosen parts on particle i along its normal n, in N. */
static double push_on(const struct cs_system *system, const double *v, uint32_t parts, size_t i,
                      const double n[3]) {
    double w[3], u[3];
    flow_past(system, NULL, i, w);
    flow_past(system, v, i, u);
    const double still = cs_vec3_dot(w, n), s = cs_vec3_dot(u, n);
    const double wind = fabs(still) * still;
    return scale_of(system, i) * ((parts & CS_PART_WIND ? wind : 0) +
                                  (parts & CS_PART_DISSIPATIVE ? fabs(s) * s - wind : 0));
}

static void read_normal(const struct cs_system *system, size_t i, double n[3]) {
    for (size_t c = 0; c < 3; c++)
        n[c] = system->normals[c * system->view.n + i];
}

static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    for (size_t i = at->block->begin; i < at->block->end; i++) {
        double n[3];
        read_normal(system, i, n);
        const double push = push_on(system, at->v, at->parts, i, n);
        for (size_t c = 0; c < 3; c++)
            f[c * system->view.n + i] += push * n[c];
        // only the wind can give energy, the rest takes it
        const double given = at->power ? push_on(system, at->v, CS_PART_WIND, i, n) : 0;
        for (size_t c = 0; c < 3 && at->power; c++)
            at->power[i] += given * n[c] * at->v[c * system->view.n + i];
    }
}

/* The change of the force on particle i of a body: of the number along n, and of n. */
static void add_change(const struct cs_system *system, const struct cs_eval *at,
                       const struct cs_body_range *body, uint32_t i, double *df) {
    double n[3], dn[3] = {0}, du[3] = {0}, w[3], u[3];
    read_normal(system, i, n);
    if (at->dx)
        cs_normal_derivative(system, body, i, at, dn);
    for (size_t c = 0; c < 3 && at->dv; c++)
        du[c] = -at->dv[c * system->view.n + i];
    flow_past(system, NULL, i, w);
    flow_past(system, at->v, i, u);
    const double wind = 2 * fabs(cs_vec3_dot(w, n)) * cs_vec3_dot(w, dn);
    const double both = 2 * fabs(cs_vec3_dot(u, n)) * (cs_vec3_dot(u, dn) + cs_vec3_dot(du, n));
    const double change =
        scale_of(system, i) * ((at->parts & CS_PART_WIND ? wind : 0) +
                               (at->parts & CS_PART_DISSIPATIVE ? both - wind : 0));
    const double push = push_on(system, at->v, at->parts, i, n);
    for (size_t c = 0; c < 3; c++)
        df[c * system->view.n + i] += change * n[c] + push * dn[c];
}

static void add_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        const uint32_t begin = at->block->begin > body->first ? at->block->begin : body->first;
        for (uint32_t i = begin; i < at->block->end && i < body->first + body->count; i++)
            add_change(system, at, body, i, df);
    }
}

/* The blocks need normals, of the matrix's state. */
static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    (void)kept;
    cs_normals_update(system, matrix->x);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    for (size_t i = begin; i < end; i++) {
        double u[3], n[3];
        flow_past(system, matrix->v, i, u);
        read_normal(system, i, n);
        const double rate = -2 * matrix->cd * scale_of(system, i) * fabs(cs_vec3_dot(u, n));
        for (size_t m = 0; m < 6; m++)
            blocks[m * system->view.n + i] += rate * n[cs_sym3_row[m]] * n[cs_sym3_column[m]];
    }
}

/* Blocks are all of the matrix, and nothing of places is in it. */
static void add_product(const struct cs_system *system, const double *p, double *y) {
    (void)system, (void)p, (void)y;
}
static void add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    (void)system, (void)matrix, (void)y;
}

/* |df/dv| <= rho A c |u| */
static void add_state_bound(const struct cs_system *system, const struct cs_eval *at,
                            const struct cs_gershgorin *sums) {
    for (size_t i = 0; i < system->view.n; i++) {
        double u[3];
        flow_past(system, at ? at->v : NULL, i, u);
        sums->damping[i] += 2 * scale_of(system, i) * sqrt(cs_vec3_dot(u, u));
    }
}

static void add_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    add_state_bound(system, NULL, sums);
}

/* N: the wind on cloth that stands still. */
static double max_force(const struct cs_system *system, size_t i) {
    const double *w = system->scene->forces->wind.velocity;
    return scale_of(system, i) * cs_vec3_dot(w, w);
}

static const char *const ramps[] = {"forces.wind.velocity", "forces.wind.density",
                                    "forces.wind.drag", NULL};

const struct cs_term cs_term_airflow = {
    .name = "airflow",
    .part_bits = CS_PART_WIND | CS_PART_DISSIPATIVE,
    .plan = plan_airflow,
    .uses = uses,
    .rampable_keys = ramps,
    .add_force = add_force,
    .add_jvp = add_jvp,
    .work_column = "wind",
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = add_product,
    .add_approach = add_approach,
    .add_bound = add_bound,
    .add_state_bound = add_state_bound,
    .max_acceleration = max_force,
};
