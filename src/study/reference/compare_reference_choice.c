/* Chooses two families of methods for a reference, and tightens their settings. */
#include "session/recorded_run.h"
#include "session/scene_view.h"
#include "study/reference/compare_reference_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Candidates, best first: explicit one-step methods; and implicit or multistep ones.
 * velocity-verlet is the last resort of both families. "@" stands for 2/omega, the longest
 * stable step of the leap-frog. */
static const char *const one_step[] = {"ark-erk:order=8,rtol=1e-12,atol=1e-12",
                                       "dop853:order=8,rtol=1e-12,atol=1e-12",
                                       "ark-erk:rtol=1e-12,atol=1e-12",
                                       "dopri5:rtol=1e-12,atol=1e-12",
                                       "rk4:dt=@0.04",
                                       "velocity-verlet:dt=@0.01",
                                       NULL};
static const char *const other[] = {"gauss:order=8,rtol=1e-12,dt=@0.4",
                                    "cvode-adams:rtol=1e-12,atol=1e-12",
                                    "cvode-bdf:rtol=1e-11,atol=1e-11,max_order=5",
                                    "implicit-midpoint:dt=@0.02",
                                    "tr-bdf2:dt=@0.02",
                                    "velocity-verlet:dt=@0.005",
                                    NULL};
/* The same where explicit methods are too dear: "@" stands for a frame. The second family damps
 * what its step does not resolve, so that agreement with the first tells that nothing of it
 * matters. */
static const char *const implicit[] = {"tr-bdf2:dt=@0.25", "implicit-linearised:dt=@0.25",
                                       NULL};
static const char *const implicit_other[] = {"implicit-midpoint:dt=@0.25", "newmark:dt=@0.25",
                                             "bdf2:dt=@0.25", NULL};

/* Families by whether explicit methods are too dear. */
static const char *const *const families[2][2] = {{one_step, other},
                                                  {implicit, implicit_other}};

/* Evaluations of the forces by the four explicit runs over a time 1/omega, about: ark-erk of
 * order 8 takes 13 a step of 0.5/omega, a tighter twin 1.3 times as many, an implicit family as
 * many again. */
#define EXPLICIT_PASSES 120
/* The same by the four implicit runs over a frame: 24 steps, each with about 70 evaluations,
 * products and iterations on three garments of 64 to 1488 particles. */
#define IMPLICIT_PASSES 1700

/* Scales of a scene that its reference depends on. */
struct scale {
    double length; /* s, that "@" stands for */
    bool is_implicit;
};

/* Replaces "dt=@0.04" by that fraction of a length in s. */
static void fill_step(const char *pattern, double length, char *out, size_t size) {
    const char *at = strchr(pattern, '@');
    char number[CS_REAL_DIGITS] = "";
    if (at)
        cs_print_real(length * strtod(at + 1, NULL), number);
    snprintf(out, size, "%.*s%s", at ? (int)(at - pattern) : (int)strlen(pattern), pattern,
             number);
}

/* True if the method is available and accepts the scene. */
static bool is_there(const struct cs_compare_reference_settings *settings,
                     const char *integrator) {
    struct cs_session session;
    struct cs_session_settings asked = settings->run->session;
    struct cs_error ignored = {0};
    asked.integrator = integrator;
    const bool there = !cs_session_open_plan(&session, &asked, &ignored);
    cs_session_close(&session);
    return there;
}

/* Scales of the smooth scene, with a frequency of at least 1/s, whether explicit runs are too
 * dear, and the work of the four runs. */
static enum cs_status measure_scale(const struct cs_compare_reference_settings *settings,
                                    struct scale *scale, struct cs_compare_reference *reference,
                                    struct cs_error *error) {
    struct cs_recorded_run recording;
    if (!cs_recorded_run_open(&recording, settings->run, "velocity-verlet", error)) {
        const struct cs_system *system = &recording.session.system;
        const double fps = recording.session.scene->time.fps,
                     omega = fmax(system->view.omega, 1);
        const double passes = EXPLICIT_PASSES * omega * settings->run->frames / fps;
        scale->is_implicit = passes * cs_pass_seconds(system) > settings->explicit_seconds;
        scale->length = scale->is_implicit ? 1 / fps : 2 / omega;
        reference->explicit_passes = scale->is_implicit ? passes : 0;
        reference->passes =
            scale->is_implicit ? (double)IMPLICIT_PASSES * settings->run->frames : passes;
    }
    cs_recorded_run_close(&recording);
    return error->status;
}

/* Chooses the first available candidate of a family from number *k on; *k is then the next
 * number, and the choice "" if there is none. One method must not stand for both families. */
static void take_first(const struct cs_compare_reference_settings *settings, int family,
                       const struct scale *scale, int *k, const char *first, char chosen[256]) {
    const char *const *const list = families[scale->is_implicit][family];
    for (bool found = false; !found && list[*k]; ++*k) {
        fill_step(list[*k], scale->length, chosen, 256);
        found = is_there(settings, chosen) &&
                (family == 0 || strncmp(first, chosen, strcspn(chosen, ":") + 1) != 0);
        if (!found)
            *chosen = 0;
    }
}

/* Takes both families from --reference. */
static enum cs_status copy_given(const struct cs_compare_reference_settings *settings,
                                 char chosen[2][256], struct cs_error *error) {
    for (int k = 0; k < 2; k++)
        if (snprintf(chosen[k], sizeof chosen[k], "%s", settings->methods[k]) >=
            (int)sizeof chosen[k])
            return cs_fail(error, CS_ERR_USAGE,
                           "--reference: \"%.60s...\" is longer than %zu characters",
                           settings->methods[k], sizeof chosen[k] - 1);
    return CS_OK;
}

enum cs_status cs_compare_reference_choose(const struct cs_compare_reference_settings *settings,
                                           char chosen[2][256],
                                           struct cs_compare_reference *reference,
                                           struct cs_error *error) {
    struct scale scale;
    int next[2] = {0, 0};
    *reference->replacement = 0;
    if (settings->methods[0] && settings->methods[1])
        return copy_given(settings, chosen, error);
    if (measure_scale(settings, &scale, reference, error))
        return error->status;
    for (int family = 0; family < 2; family++) {
        *chosen[family] = 0;
        take_first(settings, family, &scale, next + family, chosen[0], chosen[family]);
        if (!*chosen[family])
            return cs_fail(
                error, CS_ERR_MODULE,
                "a reference needs methods of two families, but fewer are available");
    }
    take_first(settings, 1, &scale, next + 1, chosen[0], reference->replacement);
    return CS_OK;
}

/* Adds one option, tightened if it sets the accuracy. */
static void tighten(const char *key, const char *text, struct cs_text *out) {
    double value;
    cs_text_add(out, "%s=", key);
    if (!strcmp(key, "dt") && cs_parse_real(text, &value))
        cs_text_add_real(out, value / 2);
    else if ((!strcmp(key, "rtol") || !strcmp(key, "atol")) && cs_parse_real(text, &value))
        cs_text_add(out, "%.6g", value / 10); // 1e-12 / 10 must read 1e-13
    else
        cs_text_add(out, "%s", text);
}

enum cs_status cs_compare_reference_tighten(const char *integrator, char *out, size_t size,
                                            struct cs_error *error) {
    char *copy = strdup(integrator), *rest = copy;
    const char *name = copy ? strsep(&rest, ":") : "", *key, *value;
    struct cs_text text = {0};
    cs_text_add(&text, "%s", name);
    /* a pair that cannot be read ends the loop: its message is in *error */
    for (char mark = ':'; rest && !cs_method_parse_pair(name, &rest, &key, &value, error);
         mark = ',') {
        cs_text_add(&text, "%c", mark);
        tighten(key, value, &text);
    }
    if (!copy || text.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a reference");
    else if (text.length >= size)
        cs_fail(error, CS_ERR_USAGE, "--reference: \"%.60s...\" is longer than %zu characters",
                integrator, size - 1);
    else
        memcpy(out, cs_text_get(&text), text.length + 1);
    cs_text_finish(&text);
    free(copy);
    return error->status;
}

/* Measures the predictability horizon: how fast runs with nearly equal starts separate. */

/* Fraction of the motion that the bar of implicit families may be, for errors of position to
 * tell methods apart. */
#define RESOLVED 0.1

/* Displaces the free particle in the middle of the list by CS_HORIZON_START, along the space
 * diagonal: a displacement within a plane of symmetry would stay in it. Returns false if all
 * particles are pinned. */
static bool perturb_one(struct cs_recorded_run *recording) {
    const struct cs_view *view = &recording->session.system.view;
    uint32_t free = 0, seen = 0;
    for (uint32_t i = 0; i < view->n; i++)
        free += view->inv_mass[i] > 0;
    for (uint32_t i = 0; i < view->n; i++)
        if (view->inv_mass[i] > 0 && seen++ == free / 2) {
            // out of every plane of symmetry
            for (size_t c = 0; c < 3; c++)
                recording->initial_state[c * view->n + i] += CS_HORIZON_START / sqrt(3);
            return true;
        }
    return false;
}

/* Distance of the two runs at each frame: time of the horizon and total growth. */
static void compare(struct cs_horizon *horizon, const struct cs_recorded_run *recording,
                    const struct cs_trajectory *a, const struct cs_trajectory *b,
                    double accuracy) {
    const struct cs_system *system = &recording->session.system;
    const double start =
        cs_distance_rms(system, a, 0, cs_trajectory_state(a, 0), cs_trajectory_state(b, 0));
    horizon->time = HUGE_VAL;
    for (uint32_t k = 1; k <= a->frames; k++) {
        horizon->separation =
            cs_distance_rms(system, a, k, cs_trajectory_state(a, k), cs_trajectory_state(b, k));
        if (horizon->separation >= accuracy && horizon->time == HUGE_VAL)
            horizon->time = k / a->fps;
    }
    horizon->growth = start > 0 ? horizon->separation / start : 0;
}

/* Runs the scene and its perturbed twin. *done: both reached their last frame. */
static enum cs_status run_twins(struct cs_horizon *horizon, struct cs_recorded_run *recording,
                                double accuracy, bool *done, struct cs_error *error) {
    struct cs_trajectory trajectories[2] = {0};
    struct cs_recorded_run_result ends[2];
    *done = false;
    for (int k = 0; k < 2 && !error->status; k++) {
        if (k == 1)
            perturb_one(recording);
        if (!cs_trajectory_init(trajectories + k, recording, error))
            cs_recorded_run_execute(recording, 0, trajectories + k, ends + k, error);
    }
    if (!error->status && trajectories[0].n_recorded == recording->frames &&
        trajectories[1].n_recorded == recording->frames) {
        compare(horizon, recording, trajectories, trajectories + 1, accuracy);
        *done = true;
    }
    cs_trajectory_finish(trajectories);
    cs_trajectory_finish(trajectories + 1);
    return error->status;
}

enum cs_status cs_horizon_measure(struct cs_horizon *horizon,
                                  const struct cs_recorded_run_settings *settings,
                                  double accuracy, const char *first, const char *fallback,
                                  struct cs_error *error) {
    const char *const methods[] = {first, fallback};
    bool done = false;
    *horizon = (struct cs_horizon){.growth = (double)NAN, .separation = (double)NAN};
    for (int k = 0; k < 2 && !done && !error->status; k++) {
        struct cs_recorded_run recording;
        if (!methods[k])
            continue;
        if (!cs_recorded_run_open(&recording, settings, methods[k], error))
            run_twins(horizon, &recording, accuracy, &done, error);
        cs_recorded_run_close(&recording);
    }
    return error->status;
}

/* Decides whether there are pointwise errors. */
static void judge(struct cs_compare_reference *reference) {
    const double time = reference->trajectory.frames / reference->trajectory.fps;
    const struct cs_horizon *horizon = &reference->horizon;
    reference->pointwise = false;
    if (!reference->families_agree)
        return;
    if (!(horizon->time > time))
        snprintf(reference->reason, sizeof reference->reason,
                 "a displacement of %.0g m in one particle grows %.2g times and reaches %.0g m "
                 "at %.3g s: errors of single particles have no meaning after that time",
                 CS_HORIZON_START, horizon->growth, reference->accuracy, horizon->time);
    else if (reference->error_bar > reference->accuracy)
        snprintf(reference->reason, sizeof reference->reason,
                 "the reference is accurate only to %.2g m, but %.2g m was requested",
                 reference->error_bar, reference->accuracy);
    else
        reference->pointwise = true;
}

enum cs_status
cs_compare_reference_judge_horizon(struct cs_compare_reference *reference,
                                   const struct cs_recorded_run_settings *settings,
                                   struct cs_error *error) {
    const bool is_implicit = reference->explicit_passes > 0;
    reference->horizon = (struct cs_horizon){(double)NAN, (double)NAN, HUGE_VAL};
    if (is_implicit && reference->error_bar <= RESOLVED * reference->motion_scale)
        reference->accuracy = fmax(reference->accuracy, reference->error_bar);
    if (!is_implicit || reference->error_bar <= reference->accuracy)
        cs_horizon_measure(&reference->horizon, settings, reference->accuracy,
                           is_implicit ? NULL : "velocity-verlet", reference->methods[0],
                           error);
    judge(reference);
    return error->status;
}
