/* Checks the motion under one force at a time, with unequal masses, and under forces that
 * change with time, against the reference.
 *
 * Bound: with step h and rate w of the scene, a method of order p has the local error (h
 * w)^(p+1) of the motion. The T / h steps of a run of length T add up to (h w)^p w T. Twice
 * that is allowed, and never less than 1e-10. A force that is missed or applied twice causes an
 * error of the size of the motion at any step. A wrong order fails at the finer of two steps.
 * A small fault moves the limit h -> 0, which is compared as well. */
#include "conform/conform_checks.h"
#include "session/session.h"

#include <math.h>
#include <string.h>

#define DURATION (CS_FORCE_FRAMES * CS_FORCE_FRAME)

/* s; the error of the reference, (h w)^4 w T / 120, is near 1e-12 of the motion for w = 12/s. A
 * run with twice the step removes that term. */
#define REFERENCE_STEP (CS_FORCE_FRAME / 512)

/* Lower limit of every bound: rounding, inner solves and the error of the reference. */
#define FLOOR 1e-10

/* h w at which forces are followed to order 1 */
#define FINE 0.0125

/* Reference solution of a scene, stored in the cache as an array of TRUTH doubles. */
struct truth {
    double state[2 * CS_FORCE_VALUES];
    double scale[2]; /* root mean square of the move, and of the change of velocity */
};
enum { TRUTH = sizeof(struct truth) / sizeof(double) };

/* A scene that a card's method is compared in. Pointers are borrowed. */
struct trial {
    const struct cs_conform *conform;
    struct cs_conform_row *row;
    const struct cs_force_scene *scene;
    struct truth truth;
    uint32_t order;                    /* that the method claims for such forces */
    size_t n;                          /* particles of the last run */
    double start[2 * CS_FORCE_VALUES]; /* (2, 3n): the state before it */
};

/* State (2, 3n) after a run with steps of `accuracy` in s, or with a tolerance of -accuracy.
 * Returns false if the run ended early: the row says why. */
static bool run_to(struct trial *trial, const struct cs_integrator *method, double accuracy,
                   double *state) {
    struct cs_probe probe;
    if (cs_probe_open(&probe, trial->conform, method, "%s", trial->scene->json))
        memcpy(trial->start, probe.x, 6 * probe.n * sizeof *state);
    if (accuracy > 0)
        cs_probe_set_step(&probe, accuracy);
    else
        cs_probe_set_tolerance(&probe, -accuracy);
    trial->n = probe.n;
    const bool done = cs_probe_run(&probe, CS_FORCE_FRAMES);
    if (done)
        memcpy(state, probe.x, 6 * probe.n * sizeof *state);
    else
        cs_row_fail(trial->row, "%s: %s", trial->scene->description, probe.error.message);
    cs_probe_close(&probe);
    return done;
}

/* Runs the reference over the scene; the changes since the start give the scales. */
static bool run_reference(struct trial *trial) {
    double states[2][2 * CS_FORCE_VALUES];
    struct truth *truth = &trial->truth;
    for (int k = 0; k < 2; k++)
        if (!run_to(trial, &cs_conform_reference, ldexp(REFERENCE_STEP, 1 - k), states[k]))
            return false;
    const size_t half = 3 * trial->n;
    cs_extrapolate(states[0], 2, 2 * CS_FORCE_VALUES, 2 * half, 4);
    memcpy(truth->state, states[1], 2 * half * sizeof *truth->state);
    for (size_t k = 0; k < 2; k++)
        truth->scale[k] =
            cs_rms_difference(truth->state + k * half, trial->start + k * half, half);
    return true;
}

/* Takes the reference from the cache or runs it. The description is the key: it is unique. */
static bool compute_reference(struct trial *trial) {
    struct cs_conform_cache *cache = trial->conform->cache;
    const char *key = trial->scene->description;
    const double *kept = cs_conform_cache_find(cache, key, TRUTH);
    if (kept)
        memcpy(&trial->truth, kept, sizeof trial->truth);
    else if (run_reference(trial))
        cs_conform_cache_store(cache, key, (const double *)&trial->truth, TRUTH);
    else
        return false;
    return true;
}

/* States errors of position and velocity, relative to their changes. state: (2, 3n). */
static void state_errors(const struct trial *trial, const double *state, double bound,
                         const char *how) {
    static const char *const parts[2] = {"position", "velocity"};
    const size_t half = 3 * trial->n;
    for (size_t k = 0; k < 2; k++)
        cs_row_state(trial->row,
                     cs_rms_difference(state + k * half, trial->truth.state + k * half, half) /
                         trial->truth.scale[k],
                     bound, "of the motion off the reference in %s, %s: %s", parts[k], how,
                     trial->scene->description);
}

/* Twice the error of the motion that an error of a fraction of it per 1 / w explains, but never
 * less than rounding leaves. */
static double bound_of(const struct cs_force_scene *scene, double fraction) {
    return fmax(2 * fraction * fmax(scene->rate * DURATION, 1), FLOOR);
}

/* Longest step of an extrapolation: h w, and a whole part of the time between events, s. */
#define LIMIT_COARSE 0.25
#define LIMIT_PART   0.05
enum { LEVELS = 6, HIGH_ORDER_LEVELS = 5 };

/* Runs with steps h, h/2, h/4, ..., and compares the second, the last, and the limit h -> 0
 * that all together are extrapolated to. A coefficient that is off by little, or a stage that
 * loses an order, leaves less error at one step than the method's own: the limit shows it.
 *
 * The columns leave a term of (h w)^(order + levels); of right methods of order 1, 2 and more
 * at most 1.2e-5, 5e-9 and 2e-10 were measured. */
static void follow_steps(struct trial *trial) {
    static const double bounds[] = {2e-5, 2e-8, 1e-9};
    const struct cs_integrator *method = trial->conform->method;
    const double w = trial->scene->rate,
                 longest = LIMIT_PART / ceil(LIMIT_PART * w / LIMIT_COARSE);
    const uint32_t order = trial->order;
    const int levels = order > 3 ? HIGH_ORDER_LEVELS : LEVELS;
    const bool extrapolated = method->fidelity == CS_FIDELITY_ODE;
    double states[LEVELS][2 * CS_FORCE_VALUES];
    for (int k = extrapolated ? 0 : 1; k < levels; k += extrapolated ? 1 : levels - 2) {
        const double h = ldexp(longest, -k);
        if (!run_to(trial, method, h, states[k]))
            return;
        if (k == 1 || k == levels - 1)
            state_errors(trial, states[k], bound_of(trial->scene, pow(h * w, order)),
                         k == 1 ? "coarse" : "fine");
    }
    if (extrapolated) {
        cs_extrapolate(states[0], levels, 2 * CS_FORCE_VALUES, 6 * trial->n, order);
        state_errors(trial, states[levels - 1], bounds[order < 3 ? order - 1 : 2],
                     "in the limit");
    }
}

/* Runs with three tolerances. A tolerance of the local error of a step of order p leaves a
 * global error of tolerance^(p / (p + 1)) (Hairer, Norsett, Wanner 1993, sec. II.4): at the
 * tightest one a few times that are allowed. */
static void follow_tolerances(struct trial *trial) {
    static const char *const texts[] = {"coarse", "fine", "in the limit"};
    const struct cs_integrator *method = trial->conform->method;
    const double tight = cs_probe_tightest_tolerance(trial->conform), p = trial->order;
    const double rtol[] = {1e-5, 1e-7, tight};
    const double allowed[] = {CS_TOLERANCE_FACTOR * rtol[0], CS_TOLERANCE_FACTOR * rtol[1],
                              5 * pow(tight, p / (p + 1))};
    const int levels = method->fidelity == CS_FIDELITY_ODE ? 3 : 2;
    double state[2 * CS_FORCE_VALUES];
    for (int k = 0; k < levels && run_to(trial, method, -rtol[k], state); k++)
        state_errors(trial, state, bound_of(trial->scene, allowed[k]), texts[k]);
}

/* A trial without runs. */
static struct trial trial_of(const struct cs_conform *conform, struct cs_conform_row *row,
                             const struct cs_force_scene *scene) {
    return (struct trial){.conform = conform,
                          .row = row,
                          .scene = scene,
                          .order = cs_conform_order(conform, scene->depends_on_velocity)};
}

/* At fixed steps, or at tolerances. */
static void follow(const struct cs_conform *conform, struct cs_conform_row *row,
                   const struct cs_force_scene *scene, bool fixed) {
    struct trial trial = trial_of(conform, row, scene);
    if (!compute_reference(&trial))
        return;
    if (fixed)
        follow_steps(&trial);
    else
        follow_tolerances(&trial);
}

/* True if the scene belongs to the check and suits the model of the method. */
static bool is_for(const struct cs_conform *conform, const struct cs_force_scene *scene,
                   const char *check) {
    return !strcmp(scene->check, check) &&
           !(scene->deforms && conform->method->fidelity == CS_FIDELITY_OTHER) &&
           !(strstr(scene->json, "\"elastic\"") && cs_plan_has_own_springs(conform->method));
}

/* Runs all scenes of a check, at the order that the method claims for forces of that kind. */
static void check_scenes(const struct cs_conform *conform, struct cs_conform_row *row) {
    bool any = false;
    if (!cs_probe_can_be_set(conform, row))
        return;
    for (uint32_t k = 0; k < cs_n_force_scenes; k++) {
        if (!is_for(conform, cs_force_scenes + k, row->check))
            continue;
        any = true;
        follow(conform, row, cs_force_scenes + k, !(conform->method->traits & CS_ADAPTIVE));
    }
    if (!any)
        cs_row_skip(row, conform->method->fidelity == CS_FIDELITY_OTHER
                             ? "another model: it does not follow the motion of springs"
                             : "springs of its own: it refuses elastic bodies");
}

#define X(function)                                                                            \
    void cs_check_##function(const struct cs_conform *conform, struct cs_conform_row *row) {   \
        check_scenes(conform, row);                                                            \
    }
X(force_gravity)
X(force_springs)
X(force_damping)
X(force_membrane)
X(force_bending)
X(force_drag)
X(force_wind)
X(force_push)
X(force_contact)
X(unequal_masses)
X(mixed_laws)
#undef X

/* True if the order is measured by fixed steps. */
static bool has_stage_times(const struct cs_conform *conform) {
    return cs_method_has(conform->method, "dt") && cs_conform_order(conform, false) > 1;
}

/* Tests whether forces are followed in time at all: at order 1, which also a method passes that
 * evaluates a force at the wrong end of the step. stage-times tests the order. */
void cs_check_time_dependence(const struct cs_conform *conform, struct cs_conform_row *row) {
    double state[2 * CS_FORCE_VALUES];
    if (!cs_probe_can_be_set(conform, row))
        return;
    for (uint32_t k = 0; k < cs_n_force_scenes; k++) {
        const struct cs_force_scene *scene = cs_force_scenes + k;
        struct trial trial = trial_of(conform, row, scene);
        if (!is_for(conform, scene, row->check))
            continue;
        if (!has_stage_times(conform))
            follow(conform, row, scene, !(conform->method->traits & CS_ADAPTIVE));
        else if (compute_reference(&trial) &&
                 run_to(&trial, conform->method, FINE / scene->rate, state))
            state_errors(&trial, state, bound_of(scene, FINE), "fine");
    }
}

/* A stage that evaluates forces at a time other than its own reduces the order to 1. Steps are
 * fixed: a method that chooses its steps would compensate for the lost order. */
void cs_check_stage_times(const struct cs_conform *conform, struct cs_conform_row *row) {
    if (!has_stage_times(conform)) {
        cs_row_skip(row, cs_method_has(conform->method, "dt")
                             ? "its order is 1: see time-dependence"
                         : conform->method->traits & CS_ADAPTIVE
                             ? "it chooses its own steps: see time-dependence"
                             : "it has no option dt");
        return;
    }
    for (uint32_t k = 0; k < cs_n_force_scenes; k++)
        if (is_for(conform, cs_force_scenes + k, "time-dependence"))
            follow(conform, row, cs_force_scenes + k, true);
}
