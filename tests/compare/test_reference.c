/* The reference: its own error, a planted bug, the horizon, the cache. */
#include "scene.h"

#include "study/reference/compare_reference_state.h"

#include <math.h>
#include <string.h>

enum { FRAMES = 6 };

/* the reference of the small scene by two methods */
static void get(struct cs_compare_reference *reference, const char *first, const char *second,
                const char *cache) {
    const char *const plugins[] = {BIASED};
    char path[64];
    struct cs_error error = {0};
    scene_write(path, SMALL_SCENE, "0.02");
    const struct cs_recorded_run_settings recording = {
        .session = {.scene = path, .plugins = plugins, .n_plugins = 1}, .frames = FRAMES};
    const struct cs_compare_reference_settings settings = {.run = &recording,
                                                           .methods = {first, second},
                                                           .accuracy = 1e-6,
                                                           .explicit_seconds = 100,
                                                           .cache = cache};
    cs_compare_reference_get(reference, &settings, &error);
    ck_assert_msg(!error.status, "%s", error.message);
}

TEST(two_families_agree) {
    struct cs_compare_reference reference;
    get(&reference, "rk4:dt=2e-4", "dopri5:rtol=1e-12,atol=1e-12", NULL);
    ck_assert_msg(reference.families_agree, "%s", reference.reason);
    ck_assert(reference.pointwise);
    ck_assert_double_lt(reference.error_bar, 1e-9 * reference.motion_scale);
    ck_assert_double_gt(reference.error_bar, 0);
    cs_compare_reference_finish(&reference);
}

TEST(planted_bug_is_found) {
    struct cs_compare_reference reference;
    for (int side = 0; side < 2; side++) {
        const char *good = "dopri5:rtol=1e-12,atol=1e-12", *bad = "biased-rk4:dt=2e-4";
        get(&reference, side ? good : bad, side ? bad : good, NULL);
        ck_assert_msg(!reference.families_agree, "found to agree: families %g, twins %g and %g",
                      reference.differences[2], reference.differences[0],
                      reference.differences[1]);
        ck_assert_ptr_nonnull(strstr(reference.reason, "biased-rk4"));
        ck_assert_ptr_nonnull(strstr(reference.reason, "same problem"));
        cs_compare_reference_finish(&reference);
    }
}

/* Of a small scene: largest distance of the reference's states from those of a far tighter run.
 */
static double true_error(const struct cs_compare_reference *reference, const char *integrator) {
    char path[64];
    struct cs_error error = {0};
    struct cs_recorded_run recording;
    struct cs_recorded_run_result result = {0};
    struct cs_trajectory trajectory;
    double found = 0;
    scene_write(path, SMALL_SCENE, "0.02");
    const struct cs_recorded_run_settings asked = {.session = {.scene = path},
                                                   .frames = FRAMES};
    ck_assert(!cs_recorded_run_open(&recording, &asked, integrator, &error));
    ck_assert(!cs_trajectory_init(&trajectory, &recording, &error));
    ck_assert(!cs_recorded_run_execute(&recording, 0, &trajectory, &result, &error));
    ck_assert(result.result.outcome == CS_RUNNING);
    for (uint32_t k = 1; k <= FRAMES; k++)
        found = fmax(found, cs_distance_rms(&recording.session.system, &trajectory, k,
                                            cs_trajectory_state(&reference->trajectory, k),
                                            cs_trajectory_state(&trajectory, k)));
    cs_trajectory_finish(&trajectory);
    cs_recorded_run_close(&recording);
    return found;
}

/* The bar is neither below the true error nor 30 times above it, also where the second family
 * is the far better or the far worse one. */
TEST(bar_is_near_the_true_error) {
    static const struct {
        const char *first, *second;
    } pairs[] = {
        {"dopri5:rtol=1e-8,atol=1e-8", "gauss:order=8,rtol=1e-12,dt=0.01"},
        {"dopri5:rtol=1e-10,atol=1e-10", "gauss:order=8,rtol=1e-12,dt=0.005"},
        {"rk4:dt=2e-3", "gauss:order=8,rtol=1e-12,dt=0.005"},
        {"gauss:order=4,rtol=1e-12,dt=0.005", "dopri5:rtol=1e-11,atol=1e-11"},
        {"rk4:dt=1e-3", "dopri5:rtol=1e-9,atol=1e-9"},
    };
    struct cs_compare_reference reference;
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        get(&reference, pairs[k].first, pairs[k].second, NULL);
        const double error = true_error(&reference, "rk4:dt=5e-5");
        ck_assert_msg(reference.families_agree, "%s: %s", pairs[k].first, reference.reason);
        ck_assert_msg(reference.error_bar >= error && reference.error_bar <= 30 * error,
                      "%s and %s: bar %.3g m, true error %.3g m", pairs[k].first,
                      pairs[k].second, reference.error_bar, error);
        cs_compare_reference_finish(&reference);
    }
}

/* By default the second family is collocation, with a step of the scene's own. */
TEST(defaults_are_two_families_of_high_order) {
    struct cs_compare_reference reference;
    get(&reference, NULL, NULL, NULL);
    ck_assert_msg(strncmp(reference.methods[2], "gauss:order=8,", 14) == 0, "%s",
                  reference.methods[2]);
    ck_assert_msg(reference.families_agree, "%s", reference.reason);
    ck_assert_double_lt(reference.error_bar, 1e-12 * reference.motion_scale);
    cs_compare_reference_finish(&reference);
}

/* Slow friction bends forces within a thousandth of a metre a second: fixed steps lose their
 * order there, and their place to a method that chooses its own. */
#define ROUGH                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"start\": \"flat\", \"place\": "            \
    "{\"translate\": [0.06, 0.47, "                                                            \
    "0.03],"                                                                                   \
    " \"rotate\": [0, 0.2, 0, 1]}}, \"mass\": {\"areal_density\": 0.3}, \"springs\": "         \
    "{\"stretch\": 100, \"shear\": 35, \"bend\": 3.5, \"damping\": 0.01}}], \"colliders\": "   \
    "[{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.35}, \"friction\": 0.3, "             \
    "\"thickness\": 0.1}], \"contact\": {\"law\": \"force\", \"friction_speed\": %s}, "        \
    "\"time\": {\"fps\": 20}}"

TEST(rough_scenes_take_adaptive_steps) {
    char path[64];
    struct cs_error error = {0};
    struct cs_compare_reference reference;
    scene_write(path, ROUGH, "0.001");
    const struct cs_recorded_run_settings recording = {.session = {.scene = path},
                                                       .frames = FRAMES};
    const struct cs_compare_reference_settings settings = {
        .run = &recording, .accuracy = 1e-6, .explicit_seconds = 100};
    cs_compare_reference_get(&reference, &settings, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert_msg(reference.families_agree, "%s", reference.reason);
    // where a build has both of the library
    if (!strncmp(reference.methods[0], "ark-erk", 7)) {
        ck_assert_msg(!strncmp(reference.methods[2], "cvode-adams:", 12), "%s",
                      reference.methods[2]);
        ck_assert_double_lt(reference.error_bar, 1e-9);
    }
    cs_compare_reference_finish(&reference);
}

TEST(twin_is_tighter) {
    char twin[256];
    struct cs_error error = {0};
    cs_compare_reference_tighten("a:order=8,rtol=1e-12,atol=1e-10", twin, sizeof twin, &error);
    ck_assert_str_eq(twin, "a:order=8,rtol=1e-13,atol=1e-11");
    cs_compare_reference_tighten("b:dt=0.5", twin, sizeof twin, &error);
    ck_assert_str_eq(twin, "b:dt=0.25");
    cs_compare_reference_tighten("c", twin, sizeof twin, &error);
    ck_assert_str_eq(twin, "c");
}

TEST(cache_gives_the_same_states) {
    char folder[] = "cache-XXXXXX";
    struct cs_compare_reference first, second;
    ck_assert_ptr_nonnull(mkdtemp(folder));
    get(&first, "rk4:dt=1e-3", "dopri5:rtol=1e-10,atol=1e-10", folder);
    get(&second, "rk4:dt=1e-3", "dopri5:rtol=1e-10,atol=1e-10", folder);
    ck_assert(!first.cached);
    ck_assert(second.cached);
    ck_assert_double_eq(first.error_bar, second.error_bar);
    ck_assert_mem_eq(cs_trajectory_state(&first.trajectory, FRAMES),
                     cs_trajectory_state(&second.trajectory, FRAMES), 6 * 36 * sizeof(double));
    cs_compare_reference_finish(&first);
    cs_compare_reference_finish(&second);
    // other settings are another reference
    get(&second, "rk4:dt=2e-3", "dopri5:rtol=1e-10,atol=1e-10", folder);
    ck_assert(!second.cached);
    cs_compare_reference_finish(&second);
}

/* A sheet let go 10 degrees from the upright, held by two corners, 20 s. Without damping twins
 * 1e-13 m apart in one particle part a hundred- to a thousandfold in 2 s, until the difference
 * can be seen, at 9 s whatever the step; with damping they stay together. */
#define DRAPE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [16, 16],"                                           \
    " \"place\": {\"rotate\": [-0.087, 0, 0, 0.996]}},"                                        \
    " \"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 200, \"shear\": 75,"           \
    " \"bend\": 25, \"damping\": %s}, \"pins\": [\"top-left\", \"top-right\"]}],"              \
    " \"time\": {\"fps\": 10}}"

static struct cs_horizon drape(const char *damping, double accuracy) {
    struct cs_horizon horizon;
    struct cs_error error = {0};
    char path[64];
    scene_write(path, DRAPE, damping);
    const struct cs_recorded_run_settings recording = {.session = {.scene = path},
                                                       .frames = 200};
    cs_horizon_measure(&horizon, &recording, accuracy, "velocity-verlet", NULL, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    return horizon;
}

TEST(horizon_of_an_undamped_drape) {
    const struct cs_horizon horizon = drape("0", 0.02);
    ck_assert_msg(horizon.time >= 8 && horizon.time <= 12, "horizon at %g s", horizon.time);
}

TEST(horizon_of_a_damped_drape) {
    const struct cs_horizon horizon = drape("0.5", 1e-6);
    ck_assert_msg(horizon.time == HUGE_VAL, "horizon at %g s", horizon.time);
    ck_assert_double_lt(horizon.separation, 1e-9);
}

/* A run with events begins as the one before it did: a gust, a corner dragged and let go. */
#define EVENTS                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6]}, \"mass\": {\"total\": 0.2},"                \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": %s},"            \
    " \"pins\": [\"top-left\", \"top-right\"]}], \"forces\": {\"drag\": 0.01},"                \
    " \"events\": [{\"from\": 0.03, \"to\": 0.16, \"wind\": {\"direction\": [0, 0, 1],"        \
    " \"strength\": 3}}, {\"from\": 0.02, \"to\": 0.21, \"grab\": {\"particles\":"             \
    " [\"bottom-right\"], \"path\": [{\"at\": 0.11, \"point\": [0.6, -0.4, 0.3]}]}},"          \
    " {\"at\": 0.17, \"release\": {\"particles\": [\"top-right\"]}}], \"time\": {\"fps\": "    \
    "20}}"

/* Two particles without springs, the first one held for 0.1 s and then let fall. */
#define RELEASED                                                                               \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 1}, \"pins\": "    \
    "[0], "                                                                                    \
    "\"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}], \"forces\": {\"gravity\": "   \
    "[0, "                                                                                     \
    "-10, 0]}, \"events\": [{\"at\": 0.1, \"release\": {\"particles\": [0]}}], \"time\": "     \
    "{\"fps\": 20}}"

/* The place of a particle that falls from rest for t is off by g h t / 2 with symplectic Euler,
 * and exact with rk4. The released one counts from its release on: alone, the other one is off
 * by 10 * 0.005 / 2 * 0.1 m at 0.1 s; at 0.3 s both are, by 0.3 and 0.2 s of fall. */
TEST(a_released_particle_counts_from_its_release_on) {
    char path[64];
    struct cs_error error = {0};
    struct cs_recorded_run recordings[2];
    struct cs_recorded_run_result result;
    struct cs_trajectory trajectories[2];
    const char *const methods[2] = {"symplectic-euler:dt=0.005", "rk4:dt=0.005"};
    scene_write(path, RELEASED, "");
    const struct cs_recorded_run_settings asked = {.session = {.scene = path}, .frames = 6};
    for (int k = 0; k < 2; k++) {
        ck_assert(!cs_recorded_run_open(recordings + k, &asked, methods[k], &error));
        ck_assert(!cs_trajectory_init(trajectories + k, recordings + k, &error));
        ck_assert(
            !cs_recorded_run_execute(recordings + k, 0, trajectories + k, &result, &error));
    }
    struct cs_trajectory_error early, late;
    const struct cs_system *system = &recordings[0].session.system;
    cs_trajectory_error_compute(&early, system, trajectories, trajectories + 1, 1, 1);
    cs_trajectory_error_compute(&late, system, trajectories, trajectories + 1, 6, 6);
    ck_assert_double_eq_tol(early.end, 0.025 * 0.05, 1e-12);
    ck_assert_double_eq_tol(late.end, 0.025 * sqrt((0.3 * 0.3 + 0.2 * 0.2) / 2), 1e-12);
    for (int k = 0; k < 2; k++) {
        cs_trajectory_finish(trajectories + k);
        cs_recorded_run_close(recordings + k);
    }
}

TEST(events_are_hit_again_in_every_run) {
    char path[64];
    struct cs_error error = {0};
    struct cs_compare_reference reference;
    struct cs_recorded_run recording;
    struct cs_recorded_run_result result;
    struct cs_trajectory trajectories[2];
    scene_write(path, EVENTS, "0.02");
    const struct cs_recorded_run_settings asked = {.session = {.scene = path},
                                                   .frames = FRAMES};
    const struct cs_compare_reference_settings settings = {
        .run = &asked,
        .methods = {"rk4:dt=2e-4", "dopri5:rtol=1e-12,atol=1e-12"},
        .accuracy = 1e-6};
    ck_assert(!cs_compare_reference_get(&reference, &settings, &error));
    ck_assert_msg(reference.pointwise, "%s", reference.reason);
    ck_assert_double_lt(reference.error_bar, 1e-9);
    ck_assert(!cs_recorded_run_open(&recording, &asked, "rk4:dt=1e-3", &error));
    for (int k = 0; k < 2; k++) {
        ck_assert(!cs_trajectory_init(trajectories + k, &recording, &error));
        ck_assert(!cs_recorded_run_execute(&recording, 0, trajectories + k, &result, &error));
        ck_assert_double_lt(cs_distance_rms(&recording.session.system, trajectories, FRAMES,
                                            cs_trajectory_state(trajectories + k, FRAMES),
                                            cs_trajectory_state(&reference.trajectory, FRAMES)),
                            1e-5);
    }
    const size_t bytes = (FRAMES + 1) * 6 * trajectories->n * sizeof(double);
    ck_assert_mem_eq(trajectories[0].states, trajectories[1].states, bytes);
    for (int k = 0; k < 2; k++)
        cs_trajectory_finish(trajectories + k);
    cs_recorded_run_close(&recording);
    cs_compare_reference_finish(&reference);
}

/* A sheet that hardly resists, hence of a low frequency and a low estimate; 16 points of a step
 * cost more in every frame. */
#define SLACK                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"velocity\": [0, 0, 0.5]},"                 \
    " \"mass\": {\"total\": 0.2}, \"springs\": {\"stretch\": 1e-3, \"shear\": 1e-3,"           \
    " \"bend\": 0}, \"pins\": [\"top-left\"]}], \"time\": {\"fps\": 20}%s}"

/* counted, not timed: the reference is the same on every machine */
TEST(a_used_up_budget_leaves_implicit_families) {
    char path[64], key[CS_HASH_DIGITS];
    struct cs_error error = {0};
    struct cs_compare_reference planned, found[2];
    struct cs_recorded_run recording;
    scene_write(path, SLACK, "");
    const struct cs_recorded_run_settings asked = {.session = {.scene = path},
                                                   .frames = FRAMES};
    struct cs_compare_reference_settings settings = {
        .run = &asked, .accuracy = 1e-6, .explicit_seconds = 100};
    ck_assert(!cs_recorded_run_open(&recording, &asked, "velocity-verlet", &error));
    const double pass_seconds = cs_pass_seconds(&recording.session.system);
    cs_recorded_run_close(&recording);
    ck_assert(!cs_compare_reference_plan(&planned, &settings, key, &error));
    ck_assert_double_gt(planned.passes, 0);
    settings.explicit_seconds = 1.01 * planned.passes * pass_seconds;
    ck_assert(!cs_compare_reference_plan(&planned, &settings, key, &error));
    ck_assert(planned.explicit_passes == 0);
    for (int k = 0; k < 2; k++) {
        ck_assert(!cs_compare_reference_get(found + k, &settings, &error));
        ck_assert_msg(found[k].families_agree, "%s", found[k].reason);
        ck_assert_double_gt(found[k].explicit_passes, 0);
        ck_assert_str_eq(found[k].methods[0], "tr-bdf2:dt=0.0125");
    }
    ck_assert(found[0].error_bar == found[1].error_bar);
    cs_compare_reference_finish(found);
    cs_compare_reference_finish(found + 1);
    // a budget that suffices leaves the explicit ones
    settings.explicit_seconds = 100;
    ck_assert(!cs_compare_reference_get(found, &settings, &error));
    ck_assert(found->explicit_passes == 0 && found->families_agree);
    ck_assert_double_lt(found->error_bar, 1e-9);
    cs_compare_reference_finish(found);
}
