/* Gravity: f = m g, with the potential -m g.x, which is 0 at the origin. It has no derivative.
 */
#include "model/force/term.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"

#include <clothsim/clones.h>
#include <math.h>

static struct cs_plan_row plan_gravity(const struct cs_scene *scene) {
    const double *g = scene->forces->gravity;
    const double size = fabs(g[0]) + fabs(g[1]) + fabs(g[2]);
    const bool acts = cs_event_key_acts(scene, size, "forces.gravity");
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "forces.gravity" : "forces.gravity is 0"};
}

CS_CLONES static void add_force(const struct cs_system *system, const struct cs_eval *at,
                                double *f) {
    const size_t n = system->view.n;
    for (size_t c = 0; c < 3; c++) {
        const double g = system->scene->forces->gravity[c];
        for (size_t i = at->block->begin; i < at->block->end && g != 0; i++)
            f[c * n + i] += system->mass[i] * g;
    }
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    const uint32_t n = system->view.n;
    const double *g = system->scene->forces->gravity, *x = at->x;
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum -= system->mass[i] *
               (g[0] * x[i] + g[1] * x[n + (size_t)i] + g[2] * x[2 * (size_t)n + i]);
    return sum;
}

static double max_acceleration(const struct cs_system *system, size_t i) {
    const double *g = system->scene->forces->gravity;
    return system->mass[i] * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

static const char *const ramps[] = {"forces.gravity", NULL};

const struct cs_term cs_term_gravity = {
    .name = "gravity",
    .part_bits = CS_PART_GRAVITY,
    .plan = plan_gravity,
    .rampable_keys = ramps,
    .is_local = true,
    .add_force = add_force,
    .energy = energy,
    .energy_kind = CS_ENERGY_GRAVITY,
    .max_acceleration = max_acceleration,
};
