/* Springs with dampers as a term: the kernels of springs.h. */
#include "model/force/term.h"
#include "scene/body_particles.h"
#include "scene/scene.h"

/* the plan has a line for springs, with the bytes of their arrays */
static struct cs_plan_row plan_springs(const struct cs_scene *scene) {
    uint32_t n_springs = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        cs_springs_of_body(cs_scene_body(scene, b), b, 0, NULL, NULL, &n_springs);
    return (struct cs_plan_row){.built = n_springs > 0};
}

static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    if (at->dx || at->dv)
        cs_springs_jvp_to_slots(&system->springs, system->view.n, at);
    else
        cs_springs_force_to_slots(&system->springs, system->view.n, at);
}

static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    cs_springs_add_force(&system->springs, system->view.n, at, f);
}

static void add_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    cs_springs_add_jvp(&system->springs, system->view.n, at, df);
}

static double energy(const struct cs_system *system, const struct cs_eval *at) {
    return cs_springs_energy(&system->springs, system->view.n, at->x, CS_PART_SPRINGS);
}

static void add_diagonal(const struct cs_system *system, const struct cs_eval *at) {
    cs_springs_finish_diagonal(&system->springs, system->view.n, at);
}

/* Row sums of the springs at a particle. While L / l <= 2, the eigenvalues k and k (1 - L/l) of
 * a spring's block are at most k in magnitude. The block stands at the particle and again at
 * the other end: 2 k. A damper has 2 c. The bound fails if a spring is shorter than half its
 * rest length. */
static void add_bound(const struct cs_system *system, const struct cs_gershgorin *sums) {
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const uint32_t ends[2] = {cs_spring_a(run, i), cs_spring_b(run, i)};
            for (int e = 0; e < 2; e++) {
                sums->stiffness[ends[e]] += 2 * cs_spring_stiffness(run, i);
                sums->damping[ends[e]] += 2 * run->damping;
            }
        }
    }
}

static const char *const ramps[] = {"bodies.springs.stretch", "bodies.springs.shear",
                                    "bodies.springs.bend", "bodies.springs.damping", NULL};

const struct cs_term cs_term_springs = {
    .name = "springs",
    .part_bits = CS_PART_DAMPED_SPRINGS,
    .plan = plan_springs,
    .rampable_keys = ramps,
    .prepare = prepare,
    .add_force = add_force,
    .add_jvp = add_jvp,
    .energy = energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .work_column = "dampers",
    .add_diagonal = add_diagonal,
    .add_bound = add_bound,
};
