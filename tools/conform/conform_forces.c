/* Checks the motion under one force at a time, with unequal masses, and under forces that
 * change with time, against the reference.
 *
 * Bound: with step h and rate w of the scene, a method of order p has the local error (h
 * w)^(p+1) of the motion. The T / h steps of a run of length T add up to (h w)^p w T. Twice
 * that is allowed, and never less than 1e-10. A force that is missed or applied twice causes an
 * error of the size of the motion at any step. Two levels of accuracy differ by 8 in h: a wrong
 * order fails at the fine level. */
#include "conform/conform_checks.h"
#include "model/plan.h"

#include <math.h>
#include <string.h>

#define DURATION (CS_FORCE_FRAMES * CS_FORCE_FRAME)

/* s; the error of the reference, (h w)^4 w T / 120, is near 1e-13 of the motion for w = 10/s */
#define REFERENCE_STEP (CS_FORCE_FRAME / 1024)

/* Lower limit of every bound: rounding, inner solves and the error of the reference. */
#define FLOOR 1e-10

/* h w of the coarse level */
#define COARSE 0.1

/* Reference solution of a scene, stored in the cache as an array of TRUTH doubles. */
struct truth {
    double state[2 * CS_FORCE_VALUES];
    double scale[2]; /* root mean square of the move, and of the change of velocity */
};
enum { TRUTH = sizeof(struct truth) / sizeof(double) };

/* Runs the reference over the scene; the changes since the start give the scales. */
static bool run_reference(const struct cs_conform *card, const struct cs_force_scene *scene,
                          struct truth *truth, struct cs_conform_row *row) {
    double start[2 * CS_FORCE_VALUES];
    struct cs_probe probe;
    const bool open = cs_probe_open(&probe, card, &cs_conform_reference, "%s", scene->json);
    if (open) {
        memcpy(start, probe.x, 6 * probe.n * sizeof *start);
        cs_probe_set_step(&probe, REFERENCE_STEP);
    }
    const bool done = open && cs_probe_run(&probe, CS_FORCE_FRAMES);
    if (!done)
        cs_row_fail(row, "%s: %s", scene->description, probe.error.message);
    for (size_t k = 0; k < 2 && done; k++) {
        const size_t part = k * 3 * probe.n;
        memcpy(truth->state + part, probe.x + part, 3 * probe.n * sizeof *start);
        truth->scale[k] = cs_rms_difference(probe.x + part, start + part, 3 * probe.n);
    }
    cs_probe_close(&probe);
    return done;
}

/* Takes the reference from the cache or runs it. The description is the key: it is unique. */
static bool compute_reference(const struct cs_conform *card, const struct cs_force_scene *scene,
                              struct truth *truth, struct cs_conform_row *row) {
    const double *kept = cs_conform_cache_find(card->cache, scene->description, TRUTH);
    if (kept) {
        memcpy(truth, kept, sizeof *truth);
        return true;
    }
    *truth = (struct truth){.scale = {0}};
    if (!run_reference(card, scene, truth, row))
        return false;
    cs_conform_cache_store(card->cache, scene->description, (const double *)truth, TRUTH);
    return true;
}

/* Accuracy of a run, and the order its bound is computed with. */
struct accuracy {
    uint32_t order;
    int level;
    bool fixed; /* steps of dt, also of a method that can choose its own */
};

/* Sets step or tolerance; returns the expected error (h w)^order, as cs_probe_set_level does.
 */
static double set_accuracy(struct cs_probe *probe, const struct cs_force_scene *scene,
                           const struct accuracy *accuracy) {
    const double h = COARSE / scene->rate;
    if (!accuracy->fixed)
        return cs_probe_set_level(probe, h, scene->rate, accuracy->order, accuracy->level);
    const double dt = accuracy->level ? h / 8 : h;
    cs_probe_set_step(probe, dt);
    return pow(dt * scene->rate, accuracy->order);
}

/* Compares one run with the reference, positions and velocities relative to their changes. */
static void follow(const struct cs_conform *card, struct cs_conform_row *row,
                   const struct cs_force_scene *scene, const struct accuracy *accuracy) {
    static const char *const parts[2] = {"position", "velocity"};
    struct truth truth;
    struct cs_probe probe;
    if (!compute_reference(card, scene, &truth, row))
        return;
    cs_probe_open(&probe, card, card->method, "%s", scene->json);
    const double share = set_accuracy(&probe, scene, accuracy);
    if (!cs_probe_run(&probe, CS_FORCE_FRAMES))
        cs_row_fail(row, "%s: %s", scene->description, probe.error.message);
    for (size_t k = 0; k < 2 && !probe.has_ended; k++) {
        const size_t part = k * 3 * probe.n;
        const double off =
            cs_rms_difference(probe.x + part, truth.state + part, 3 * probe.n) / truth.scale[k];
        /* twice the error that the order explains, but never less than rounding leaves */
        cs_row_state(row, off, fmax(2 * share * fmax(scene->rate * DURATION, 1), FLOOR),
                     "of the motion off the reference in %s, %s: %s", parts[k],
                     accuracy->level ? "fine" : "coarse", scene->description);
    }
    cs_probe_close(&probe);
}

/* True if the scene belongs to the check and suits the model of the method. */
static bool is_for(const struct cs_conform *card, const struct cs_force_scene *scene,
                   const char *check) {
    return !strcmp(scene->check, check) &&
           !(scene->deforms && card->method->fidelity == CS_FIDELITY_OTHER) &&
           !(strstr(scene->json, "\"elastic\"") && cs_plan_has_own_springs(card->method));
}

/* Runs all scenes of a check, at the order that the method claims for forces of that kind. */
static void check_scenes(const struct cs_conform *card, struct cs_conform_row *row) {
    bool any = false;
    if (!cs_probe_can_be_set(card, row))
        return;
    for (uint32_t k = 0; k < cs_n_force_scenes; k++) {
        const struct cs_force_scene *scene = cs_force_scenes + k;
        if (!is_for(card, scene, row->check))
            continue;
        any = true;
        for (int level = 0; level < 2; level++)
            follow(card, row, scene,
                   &(struct accuracy){.order = cs_method_order(card->method, card->options,
                                                               scene->depends_on_velocity),
                                      .level = level});
    }
    if (!any)
        cs_row_skip(row, card->method->fidelity == CS_FIDELITY_OTHER
                             ? "another model: it does not follow the motion of springs"
                             : "springs of its own: it refuses elastic bodies");
}

#define X(function)                                                                            \
    void cs_check_##function(const struct cs_conform *card, struct cs_conform_row *row) {      \
        check_scenes(card, row);                                                               \
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
#undef X

/* Tests whether forces are followed in time at all: at order 1, which also a method passes that
 * evaluates a force at the wrong end of the step. stage-times tests the order. */
void cs_check_time_dependence(const struct cs_conform *card, struct cs_conform_row *row) {
    if (!cs_probe_can_be_set(card, row))
        return;
    for (uint32_t k = 0; k < cs_n_force_scenes; k++)
        if (is_for(card, cs_force_scenes + k, row->check))
            follow(card, row, cs_force_scenes + k, &(struct accuracy){.order = 1, .level = 1});
}

/* A stage that evaluates forces at a time other than its own reduces the order to 1. Steps are
 * fixed: a method that chooses its steps would compensate for the lost order. */
void cs_check_stage_times(const struct cs_conform *card, struct cs_conform_row *row) {
    if (!cs_method_has(card->method, "dt")) {
        cs_row_skip(row, card->method->traits & CS_ADAPTIVE
                             ? "it chooses its own steps: see time-dependence"
                             : "it has no option dt");
        return;
    }
    if (cs_method_order(card->method, card->options, false) < 2) {
        cs_row_skip(row, "its order is 1: see time-dependence");
        return;
    }
    for (uint32_t k = 0; k < cs_n_force_scenes; k++) {
        const struct cs_force_scene *scene = cs_force_scenes + k;
        if (!is_for(card, scene, "time-dependence"))
            continue;
        /* fixed: a method that chose its own steps would hide the order */
        for (int level = 0; level < 2; level++)
            follow(card, row, scene,
                   &(struct accuracy){.order = cs_method_order(card->method, card->options,
                                                               scene->depends_on_velocity),
                                      .level = level,
                                      .fixed = true});
    }
}
