/* What a scene or a method does not need costs nothing: no call, no array; and a frame takes
 * nothing from the heap. */
#include "allocations.h"
#include "fixture.h"

#include "mesh/trimesh.h"
#include "sim/run_host.h"

#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2}, \"springs\": "  \
    "{\"damping\": 0.01}, \"pins\": [\"top-left\", \"top-right\"]%s}]%s}"
#define WIND                                                                                   \
    ", \"forces\": {\"drag\": 0.01, \"wind\": {\"direction\": [0, 0, 1], \"strength\": 2}}"
#define COLLIDERS_THAT(keys)                                                                   \
    ", \"colliders\": [{\"floor\": {\"height\": -0.45}, "                                      \
    "\"friction\": 0.3" keys "},"                                                              \
    " {\"sphere\": {\"centre\": [0, 0, -0.3], \"radius\": 0.25}" keys "}], \"contact\": "      \
    "{\"law\": \"project\", \"start\": \"move-out\"}"
#define COLLIDERS COLLIDERS_THAT("")
/* off which particles bounce: none is held by friction, and left out by contact */
#define TRAMPOLINES COLLIDERS_THAT(", \"absorption\": -0.5")

/* methods that ask for nothing, for the solver, and for own blocks */
static const char *const methods[] = {"symplectic-euler", "velocity-verlet",
                                      "implicit-linearised", "implicit-block"};
enum { METHODS = sizeof methods / sizeof *methods };

static const struct cs_counts *run(struct fixture *cloth, const char *method, const char *body,
                                   const char *scene) {
    fixture_open(cloth, method, SCENE, body, scene);
    fixture_start(cloth);
    fixture_frames(cloth, 3);
    return &cloth->session.run.counts;
}

TEST(bare_scene_makes_no_calls) {
    for (size_t k = 0; k < METHODS; k++) {
        struct fixture cloth;
        const struct cs_counts *counts = run(&cloth, methods[k], "", "");
        ck_assert_uint_gt(counts->steps, 0);
        ck_assert_uint_gt(counts->forces, 0);
        ck_assert_uint_eq(counts->normals, 0);
        ck_assert_uint_eq(counts->contact_tests, 0);
        ck_assert_uint_eq(counts->projected_particles, 0);
        ck_assert_uint_eq(counts->strain_limit_moves, 0);
        ck_assert_uint_eq(counts->energies, 0);
        ck_assert_ptr_null(cloth.system->normals);
        ck_assert_ptr_null(cloth.system->area);
        fixture_close(&cloth);
    }
}

/* and where they are needed they are made: once a force with wind, once a particle, collider
 * and step */
TEST(full_scene_makes_its_calls) {
    for (size_t k = 0; k < METHODS; k++) {
        struct fixture cloth;
        const struct cs_counts *counts =
            run(&cloth, methods[k], ", \"strain_limit\": 1.001", WIND TRAMPOLINES);
        ck_assert_uint_ge(counts->normals, counts->steps);
        ck_assert_uint_eq(counts->contact_tests,
                          (counts->steps + counts->subdivided_steps) * 2 * 34);
        ck_assert_uint_gt(counts->projected_particles, 0);
        ck_assert_uint_gt(counts->strain_limit_moves, 0);
        fixture_close(&cloth);
    }
}

TEST(method_gets_what_it_needs_and_no_more) {
    for (size_t k = 0; k < METHODS; k++) {
        struct fixture cloth;
        run(&cloth, methods[k], "", "");
        const uint32_t needs = cloth.session.method.integrator->needs;
        const struct cs_run_host *host = cloth.session.run.host;
        const struct cs_plan_row *rows = cloth.system->plan.rows;
        ck_assert((needs & CS_NEED_SOLVE) == 0 ? !host->linear.factors
                                               : !!host->linear.factors);
        ck_assert((needs & CS_NEED_SOLVE) == 0 ? !host->setup_x : !!host->setup_x);
        ck_assert(rows[CS_FEATURE_SOLVER].built == !!(needs & CS_NEED_SOLVE));
        /* the solver's vectors, the positions it was made for, and four numbers a spring: those
         * of a direction lie as the particles do, and eight apart */
        const size_t numbers = 6 * 4 * ((size_t)cloth.n + 8) + (16 + 3) * (size_t)cloth.n;
        ck_assert_uint_eq(cloth.session.run.plan.rows[CS_FEATURE_SOLVER].bytes,
                          needs & CS_NEED_SOLVE ? numbers * sizeof(double) : 0);
        ck_assert(rows[CS_FEATURE_SPRING_LIST].built == !!(needs & CS_NEED_SPRINGS));
        ck_assert(!cloth.system->view.ends == !(needs & CS_NEED_SPRINGS));
        fixture_close(&cloth);
    }
}

/* all rows of a run's plan */
static size_t sum_of(const struct cs_run *run) {
    size_t bytes = run->plan.state_bytes + run->method_bytes;
    for (uint32_t f = 0; f < CS_FEATURES; f++)
        bytes += run->plan.rows[f].bytes;
    for (uint32_t k = 0; k < CS_TERMS_MAX; k++)
        bytes += run->plan.forces[k].bytes;
    return bytes;
}

/* also where the same system is run a second time */
TEST(bytes_of_a_run_are_in_its_plan) {
    static const char *const scenes[][2] = {{"", ""},
                                            {", \"strain_limit\": 1.001", WIND COLLIDERS},
                                            {", \"self_contact\": true, \"thickness\": 0.01",
                                             ", \"contact\": {\"law\": \"force\"}"}};
    for (size_t k = 0; k < METHODS; k++)
        for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++) {
            struct fixture cloth;
            struct cs_error error = {0};
            run(&cloth, methods[k], scenes[s][0], scenes[s][1]);
            const struct cs_run *done = &cloth.session.run;
            const size_t bytes = cs_run_bytes(done);
            ck_assert_uint_gt(done->method_bytes, 0);
            ck_assert_uint_eq(sum_of(done), bytes);
            ck_assert_int_eq(done->plan.rows[CS_FEATURE_CONTACT].bytes > 0, s == 1);
            ck_assert_int_eq(cs_session_begin(&cloth.session, NULL, &error), CS_OK);
            ck_assert_uint_eq(sum_of(done), bytes);
            fixture_close(&cloth);
        }
}

TEST(mesh_is_planned_with_its_geometry) {
    struct fixture box;
    fixture_open(&box, "symplectic-euler",
                 "{\"bodies\": [{\"mesh\": {\"shape\": \"box\", \"detail\": 3}, \"mass\": "
                 "{\"total\": 1}, \"network\": {\"springs\": 2}}]}");
    fixture_start(&box);
    const struct cs_trimesh *mesh = box.system->bodies[0].mesh;
    const size_t corners = 3 * (size_t)mesh->n_triangles, link = 2 * sizeof(uint32_t);
    ck_assert_uint_eq(mesh->n, 56);
    /* places and area; triangles and those around a vertex; edges, as many for the springs
     * across them, and inner springs */
    ck_assert_uint_eq(box.system->plan.rows[CS_FEATURE_MESHES].bytes,
                      sizeof *mesh + mesh->n * (4 * sizeof(double) + sizeof(uint32_t)) +
                          2 * corners * sizeof(uint32_t) +
                          link * ((size_t)2 * mesh->n_edges + mesh->n_network_springs));
    ck_assert_uint_eq(cs_run_bytes(&box.session.run), sum_of(&box.session.run));
    fixture_close(&box);
}

/* counted, not measured */
TEST(large_explicit_run_takes_little_a_particle) {
    struct fixture sheet;
    fixture_open(
        &sheet, "symplectic-euler",
        "{\"bodies\": [{\"cloth\": {\"grid\": [1000, 1000]}, \"mass\": {\"total\": 1}}]}");
    fixture_start(&sheet);
    ck_assert_uint_eq(sheet.system->view.n, 1000000);
    ck_assert_uint_le(cs_run_bytes(&sheet.session.run), 250 * (size_t)1000000);
    fixture_close(&sheet);
}

/* the counter sees this program and what it loads */
TEST(allocations_are_counted) {
    allocations_begin();
    const uint64_t before = allocations;
    void *volatile memory = malloc(10);
    ck_assert_uint_gt(allocations, before);
    free(memory);
    const uint64_t later = allocations;
    char *volatile copy = strdup("in the library");
    ck_assert_uint_gt(allocations, later);
    free(copy);
}

/* allocations of three frames of a method, in a scene that has everything */
static uint64_t taken_by(const struct cs_integrator *method) {
    struct fixture cloth;
    struct cs_error error = {0};
    const bool matches = method->needs & CS_NEED_CLUSTERS;
    if (method->traits & CS_SMOOTH_ONLY)
        fixture_open(&cloth, method->name,
                     "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5]}, \"mass\": {\"total\": 1},"
                     " \"pins\": [\"top\"]}]}");
    else
        fixture_open(&cloth, method->name, SCENE,
                     matches
                         ? ", \"strain_limit\": 1.01, \"shape_matching\": {\"springs\": true}"
                         : ", \"strain_limit\": 1.01",
                     WIND COLLIDERS);
    fixture_start(&cloth);
    const uint64_t before = allocations;
    for (int frame = 0; frame < 3 && !error.status; frame++)
        cs_run_frame(&cloth.session.run, &error);
    const uint64_t taken = allocations - before;
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert_uint_gt(cloth.session.run.counts.steps, 0);
    fixture_close(&cloth);
    return taken;
}

/* Every method that is not a foreign library's. */
TEST(frame_takes_nothing_from_the_heap) {
    allocations_begin();
    struct cs_registry registry = {0};
    struct cs_error error = {0};
    uint32_t tried = 0;
    cs_registry_open_all(&registry, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    for (uint32_t k = 0; k < registry.n; k++) {
        const struct cs_integrator *integrator = registry.entries[k].integrator;
        if (!integrator || integrator->traits & CS_LIBRARY_BITS)
            continue;
        const uint64_t taken = taken_by(integrator);
        ck_assert_msg(taken == 0, "%s took memory %llu times", integrator->name,
                      (unsigned long long)taken);
        tried++;
    }
    ck_assert_uint_ge(tried, METHODS);
    cs_registry_finish(&registry);
}
