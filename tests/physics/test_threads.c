/* The state does not depend on the number of threads, to the last bit: of scenes whose blocks
 * cut rows, bodies and meshes, and of each kernel by itself. */
#include "allocations.h"
#include "methods.h"

#include "base/pool.h"
#include "model/force/terms.h"
#include "model/solver/linear.h"

#include <string.h>

/* a broad grid (rows of more than one piece of springs), a narrow one, a single row, a network
 * in a sphere that meets the floor, rows of pins; every force that there is */
#define BODIES                                                                                 \
    "{\"cloth\": {\"grid\": [300, 20], \"size\": [3, 0.2], \"bump\": 0.01}, \"mass\":"         \
    " {\"total\": 1}, \"springs\": {\"damping\": 0.02}, \"pins\": [\"top\"]},"                 \
    " {\"cloth\": {\"grid\": [7, 90], \"size\": [0.1, 1.2], \"bump\": 0.01}, \"mass\":"        \
    " {\"areal_density\": 0.3}, \"springs\": {\"damping\": 0.01, \"damping_model\":"           \
    " \"relative\"}, \"pins\": [\"left\", 5], \"strain_limit\": 1.2},"                         \
    " {\"cloth\": {\"grid\": [40, 1]}, \"mass\": {\"total\": 0.1}},"                           \
    " {\"mesh\": {\"shape\": \"sphere\", \"detail\": 9, \"place\": {\"translate\":"            \
    " [0, -0.5, 0]}, \"velocity\": [0, -1, 0]}, \"network\": {\"springs\": 3}, \"mass\":"      \
    " {\"total\": 0.5}, \"springs\": {\"stretch\": 40, \"bend\": 3, \"damping\": 0.02},"       \
    " \"pins\": [3, 500]}"
#define SCENE                                                                                  \
    "{\"bodies\": [" BODIES "], \"colliders\": [{\"floor\": {\"height\": -1}}, {\"sphere\":"   \
    " {\"centre\": [0.3, -0.2, 0.1], \"radius\": 0.15}}], \"contact\": {\"law\": "             \
    "\"project\", \"start\": "                                                                 \
    "\"move-out\"}, \"forces\": {\"drag\": 0.1,"                                               \
    " \"drag_unit\": \"Pa s/m\", \"velocity_loss\": 0.001, \"wind\": {\"direction\":"          \
    " [0.3, 0, 1], \"strength\": 2}}, \"time\": {\"fps\": 200}, \"events\": [{\"from\":"       \
    " 0.001, \"to\": 0.007, \"impact\": {\"direction\": [1, 0, 1], \"impulse\": 0.1}}]}"
/* without what moves the state after a step: for a method with a history */
#define CALM "{\"bodies\": [" BODIES "], \"time\": {\"fps\": 200}}"

static const uint32_t counts[] = {2, 3, 4, 7};
enum { COUNTS = sizeof counts / sizeof *counts, FRAMES = 2 };

/* Counts by which a method is run. What a sanitizer finds in it shows with any; it goes through
 * them from method to method, and kernels take all. */
#ifdef CS_SANITIZED
enum { METHOD_COUNTS = 1 };
#else
enum { METHOD_COUNTS = COUNTS };
#endif

static void threads(uint32_t n) {
    struct cs_error error = {0};
    cs_pool_start(n, &error);
    ck_assert_msg(!error.status, "%s", error.message);
}

/* a copy of the state after some frames with n threads; to be freed */
static double *run(const char *method, const char *scene, uint32_t n, size_t *length) {
    struct fixture all;
    threads(n);
    fixture_open(&all, method, "%s", scene);
    fixture_start(&all);
    fixture_frames(&all, FRAMES);
    *length = 6 * all.n;
    double *state = malloc(*length * sizeof *state);
    ck_assert_ptr_nonnull(state);
    memcpy(state, all.x, *length * sizeof *state);
    ck_assert_uint_gt(all.system->springs.n_blocks, n == 1 ? 0 : 4);
    ck_assert_uint_eq(all.system->springs.n_chunks == 0, n == 1);
    fixture_close(&all);
    cs_pool_stop();
    return state;
}

static void check_bits(const char *method, const char *scene) {
    static size_t next;
    size_t length;
    double *one = run(method, scene, 1, &length);
    for (size_t k = 0; k < METHOD_COUNTS; k++) {
        const uint32_t n = counts[next++ % COUNTS];
        double *several = run(method, scene, n, &length);
        ck_assert_msg(!memcmp(one, several, length * sizeof *one), "%s with %u threads", method,
                      n);
        free(several);
    }
    free(one);
}

/* Solvers are loose here, as bits do not depend on it. Of the libraries one is enough: what has
 * threads is the host under them. */
TEST(states_are_the_same_to_the_bit) {
    static const char *const more[] = {"cvode-bdf:rtol=0.001", NULL};
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "threads",
                                             .without = CS_LIBRARY_BITS,
                                             .rtol = 1e-2,
                                             .residual = 1e-3,
                                             .more = more});
    for (size_t k = 0; k < methods.n; k++) {
        check_bits(methods.list[k].text, SCENE);
        if (methods.list[k].traits & (CS_IMPLICIT | CS_MULTISTEP))
            check_bits(methods.list[k].text, CALM);
    }
}

TEST(methods_for_smooth_motion_are_the_same_to_the_bit) {
    check_bits(
        "symmetric-multistep",
        "{\"bodies\": [{\"cloth\": {\"grid\": [300, 20], \"size\": [3, 0.2], \"bump\":"
        " 0.01}, \"mass\": {\"total\": 1}, \"springs\": {\"damping\": 0.001}, \"pins\":"
        " [\"top\"]}, {\"mesh\": {\"shape\": \"sphere\", \"detail\": 9}, \"network\": "
        "{\"springs\": 3}, \"mass\": {\"total\":"
        " 0.5}, \"springs\": {\"stretch\": 40, \"bend\": 3}}], \"time\": {\"fps\": 20}}");
}

/* what the kernels give one by one, end to end, each in so many rows (3,n): the first is the
 * whole force, the last ones diagonal blocks, force with blocks */
enum { BLOCKS = 4, BOTH = 1 + BLOCKS, KERNELS = 12 + BLOCKS + BOTH };
static double *kernels(uint32_t n, size_t *length) {
    static const uint32_t parts[] = {CS_PART_ALL,     CS_PART_STRETCH, CS_PART_BEND,
                                     CS_PART_DAMPING, CS_PART_WIND,    CS_PART_DRAG};
    struct fixture all;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_linear linear;
    threads(n);
    fixture_open(&all, "implicit-linearised", SCENE);
    cs_perturb_smooth(all.system, 0.01, 1);
    *length = KERNELS * 3 * all.n;
    double *found = calloc(*length, sizeof *found), *to = found;
    ck_assert_ptr_nonnull(found);
    cs_normals_update(all.system, all.x);
    for (size_t p = 0; p < sizeof parts / sizeof *parts; p++, to += 3 * all.n)
        cs_terms_force(all.system, &(struct cs_eval){.x = all.x, .v = all.v, .parts = parts[p]},
                       to);
    cs_terms_jvp(all.system,
                 &(struct cs_eval){
                     .x = all.x, .v = all.v, .parts = CS_PART_ALL, .dx = all.v, .dv = all.x},
                 to);
    cs_terms_jvp(all.system,
                 &(struct cs_eval){.x = all.x, .v = all.v, .parts = CS_PART_ALL, .dx = all.v},
                 to += 3 * all.n);
    cs_terms_jvp(
        all.system,
        &(struct cs_eval){.x = all.x, .v = all.v, .parts = CS_PART_DAMPING, .dv = all.x},
        to += 3 * all.n);
    memcpy(to += 3 * all.n, all.system->normals, 3 * all.n * sizeof *to);
    ck_assert(!cs_linear_init(&linear, all.system, &arena, &error));
    for (int psd = 0; psd < 2; psd++) {
        cs_linear_setup(
            &linear,
            &(struct cs_matrix){.x = all.x, .cm = 1, .cd = -0.01, .ck = -0.0001, .psd = psd});
        cs_linear_mul(&linear, all.v, to += 3 * all.n);
    }
    const struct cs_eval whole = {.x = all.x, .v = all.v, .parts = CS_PART_ALL};
    to += 3 * all.n;
    cs_terms_diagonal(all.system, &whole, to, to + 6 * all.n);
    to += 3 * BLOCKS * all.n;
    cs_terms_force_diagonal(all.system, &whole, to, to + 3 * all.n);
    ck_assert_ptr_eq(to + 3 * BOTH * all.n, found + *length);
    cs_arena_finish(&arena);
    fixture_close(&all);
    cs_pool_stop();
    return found;
}

TEST(kernels_are_the_same_to_the_bit) {
    size_t length;
    double *one = kernels(1, &length);
    for (size_t k = 0; k < COUNTS; k++) {
        double *several = kernels(counts[k], &length);
        for (size_t i = 0; i < length; i++)
            if (memcmp(one + i, several + i, sizeof *one)) // Check's own is slow in such loops
                ck_abort_msg("%u threads, kernel %zu, value %zu: %.17g, not %.17g", counts[k],
                             i / (length / KERNELS), i % (length / KERNELS), several[i],
                             one[i]);
        free(several);
    }
    for (size_t k = 0; k < KERNELS; k++) {
        double sum = 0;
        for (size_t i = 0; i < length / KERNELS; i++)
            sum += one[k * (length / KERNELS) + i] * one[k * (length / KERNELS) + i];
        ck_assert_double_gt(sum, 0); /* each has something to say */
    }
    const size_t n3 = length / KERNELS;
    const double *both = one + (KERNELS - BOTH) * n3;
    ck_assert(!memcmp(both, one, n3 * sizeof *one));
    ck_assert(!memcmp(both + n3, both - BLOCKS * n3, BLOCKS * n3 * sizeof *one));
    free(one);
}

/* a system may be shared among other threads than it was built for */
TEST(threads_may_change_under_a_system) {
    size_t length;
    struct fixture all;
    double *one = run("symplectic-euler:dt=0.0005", SCENE, 1, &length);
    threads(4);
    fixture_open(&all, "symplectic-euler:dt=0.0005", "%s", SCENE);
    fixture_start(&all);
    fixture_frames(&all, 1);
    cs_pool_stop();
    threads(2);
    fixture_frames(&all, 1);
    ck_assert(!memcmp(one, all.x, length * sizeof *one));
    fixture_close(&all);
    cs_pool_stop();
    free(one);
}

TEST(steps_take_nothing) {
    struct fixture all;
    struct cs_error error = {0};
    allocations_begin();
    threads(3);
    fixture_open(&all, "implicit-linearised", "%s", SCENE);
    fixture_start(&all);
    fixture_frames(&all, 1);
    const uint64_t before = allocations;
    for (int frame = 0; frame < 2; frame++)
        cs_run_frame(&all.session.run, &error);
    const uint64_t taken = allocations - before;
    ck_assert_uint_eq(taken, 0);
    ck_assert_uint_eq(all.session.run.frame, 3);
    fixture_close(&all);
    cs_pool_stop();
}
