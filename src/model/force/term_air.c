/* Air: drag f = -c v of still air, and wind f = s w |w.n| with unit direction w and the
 * particle's unit normal n (cloth thesis, eq. 5.34). Coefficients are per particle, or per
 * area, times the particle's fraction of the surface.
 *
 * Drag is linear in v and in the solver's matrix. Wind depends on x through n; its derivative
 * is exact in add_jvp but not symmetric, so the matrix leaves it out. */
#include "model/force/term.h"
#include "model/force/terms.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"

#include <clothsim/clones.h>
#include <math.h>

/* Area of particle i in m2, or 1 if the coefficient is per particle. */
static double fraction_of(const struct cs_system *system, bool by_area, size_t i) {
    return by_area ? system->area[i] : 1;
}

/* c of particle i in N s/m */
static double drag_of(const struct cs_system *system, size_t i) {
    const struct cs_forces *forces = system->scene->forces;
    return forces->drag * fraction_of(system, forces->drag_unit == CS_DRAG_AREA, i);
}

static struct cs_plan_row drag_plan(const struct cs_scene *scene) {
    const bool acts = cs_event_key_acts(scene, scene->forces->drag, "forces.drag");
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "forces.drag is above 0" : "forces.drag is 0"};
}

static uint32_t drag_uses(const struct cs_scene *scene) {
    return scene->forces->drag_unit == CS_DRAG_AREA ? CS_USE_AREA : 0;
}

/* f -= c v, which is linear: v may be a direction */
CS_CLONES static void add_drag(const struct cs_system *system, const double *v,
                               const struct cs_block *block, double *f) {
    const uint32_t n = system->view.n;
    for (uint32_t c = 0; c < 3; c++, f += n, v += n)
        for (uint32_t i = block->begin; i < block->end; i++)
            f[i] -= drag_of(system, i) * v[i];
}

static void drag_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    add_drag(system, at->v, at->block, f);
}

static void drag_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    if (at->dv)
        add_drag(system, at->dv, at->block, df);
}

/* df/dv = -c I, so cd df/dv = -cd c I >= 0. */
static void drag_scalar(const struct cs_system *system, const struct cs_matrix *matrix,
                        size_t begin, size_t end, double *diagonal) {
    for (size_t i = begin; i < end; i++)
        diagonal[i] -= matrix->cd * drag_of(system, i);
}

static void drag_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    for (size_t i = 0; i < system->view.n; i++)
        sums->damping[i] += drag_of(system, i);
}

static const char *const drag_ramps[] = {"forces.drag", NULL};

const struct cs_term cs_term_drag = {
    .name = "drag",
    .part_bits = CS_PART_DRAG,
    .plan = drag_plan,
    .uses = drag_uses,
    .rampable_keys = drag_ramps,
    .is_local = true,
    .add_force = drag_force,
    .add_jvp = drag_jvp,
    .add_scalar = drag_scalar,
    .add_bound = drag_bound,
};

/* Tells whether an event brings wind. */
static bool has_gust(const struct cs_scene *scene) {
    for (uint32_t e = 0; e < scene->events.n; e++)
        if (cs_scene_events(scene)[e].wind.present)
            return true;
    return false;
}

/* Wind is built if it blows at some time: from the start, by a ramp, or as a gust of an event.
 */
static struct cs_plan_row wind_plan(const struct cs_scene *scene) {
    const struct cs_wind *wind = &scene->forces->wind;
    const double strength = wind->present ? wind->strength : 0;
    const bool acts =
        has_gust(scene) || cs_event_key_acts(scene, strength, "forces.wind.strength");
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "forces.wind blows; it needs normals"
                                          : wind->present ? "forces.wind.strength is 0"
                                                          : "no forces.wind"};
}

static uint32_t wind_uses(const struct cs_scene *scene) {
    const bool by_area = scene->forces->wind.strength_unit == CS_WIND_PA;
    return CS_USE_NORMALS | (by_area ? CS_USE_AREA : 0);
}

/* s of particle i in N. |w.n| is at most 1, so this is also the greatest force. */
static double strength_of(const struct cs_system *system, size_t i) {
    const struct cs_wind *wind = &system->scene->forces->wind;
    return wind->strength * fraction_of(system, wind->strength_unit == CS_WIND_PA, i);
}

/* Either side of the cloth catches the wind: |w.n|, in N along w. */
static double push_on(const struct cs_system *system, size_t i) {
    const size_t n = system->view.n;
    const double *w = system->scene->forces->wind.direction, *normal = system->normals + i;
    return strength_of(system, i) *
           fabs(w[0] * normal[0] + w[1] * normal[n] + w[2] * normal[2 * n]);
}

static void wind_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const size_t n = system->view.n;
    const double *w = system->scene->forces->wind.direction, *v = at->v;
    for (size_t i = at->block->begin; i < at->block->end; i++) {
        const double push = push_on(system, i);
        f[i] += push * w[0];
        f[n + i] += push * w[1];
        f[2 * n + i] += push * w[2];
    }
    // a loop of its own, as the account is not asked at every evaluation
    for (size_t i = at->block->begin; i < at->block->end && at->power; i++)
        at->power[i] +=
            push_on(system, i) * (w[0] * v[i] + w[1] * v[n + i] + w[2] * v[2 * n + i]);
}

/* d|w.n| = sign(w.n) w.dn, of the particles [begin, end) of a body */
static void add_turned(const struct cs_system *system, const struct cs_eval *at,
                       const struct cs_body_range *body, uint32_t begin, uint32_t end,
                       double *df) {
    const size_t n = system->view.n;
    const double *w = system->scene->forces->wind.direction;
    const double *nx = system->normals, *ny = nx + n, *nz = ny + n;
    for (uint32_t i = begin; i < end; i++) {
        double dn[3];
        cs_normal_derivative(system, body, i, at, dn);
        const double facing = w[0] * nx[i] + w[1] * ny[i] + w[2] * nz[i];
        const double turn = w[0] * dn[0] + w[1] * dn[1] + w[2] * dn[2];
        const double strength = strength_of(system, i);
        const double push = (facing < 0 ? -strength : strength) * turn;
        df[i] += push * w[0];
        df[n + i] += push * w[1];
        df[2 * n + i] += push * w[2];
    }
}

/* Body by body, because neighbours depend on the body's shape. Only dx matters: n does not
 * depend on v. */
static void wind_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    for (uint32_t b = 0; at->dx && b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        const uint32_t end = body->first + body->count;
        add_turned(system, at, body,
                   at->block->begin > body->first ? at->block->begin : body->first,
                   end < at->block->end ? end : at->block->end, df);
    }
}

static const char *const wind_ramps[] = {"forces.wind.strength", NULL};

const struct cs_term cs_term_wind = {
    .name = "wind",
    .part_bits = CS_PART_WIND,
    .plan = wind_plan,
    .uses = wind_uses,
    .rampable_keys = wind_ramps,
    .add_force = wind_force,
    .add_jvp = wind_jvp,
    .max_acceleration = strength_of,
};
