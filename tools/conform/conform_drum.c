/* Runs the drum, a stretched sheet in a fixed frame, and its reference solution. */
#include "conform/conform_checks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Scene text. The inverse of the mass is no number of single precision. The start is not at
 * rest: from rest the velocity of symplectic Euler would be right to h^2 by symmetry, and its
 * order would look like 2. */
#define DRUM                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [7, 7], \"stretch\": [1.05, 1.05], \"bump\": 0.08,"  \
    " \"velocity\": [0.05, 0.03, 0.4]}, \"mass\": {\"particle\": 0.1003}, \"springs\":"        \
    " {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": %g, \"damping_model\":"       \
    " \"axial\"}, \"pins\": [\"edges\"]}], \"forces\": {\"gravity\": [0, 0, 0]},"              \
    " \"time\": {\"fps\": %.17g}%s}"

/* A plane in range, no stiffer than the springs, so CS_DRUM_OMEGA and its steps hold with
 * contact. */
#define PLANE                                                                                  \
    ", \"colliders\": [{\"plane\": {\"point\": [0, 0, -0.3], \"normal\": [0, 0, 1]},"          \
    " \"thickness\": 0.6, \"friction\": 0.4}], \"contact\": {\"law\": \"force\", \"start\": "  \
    "\"allow\","                                                                               \
    " \"stiffness\": 15, \"damping\": 0.01, \"friction_speed\": 0.3}"

/* s; with w T = 21 radians over 0.3 s the error of the fourth-order reference, (h w)^4 w T /
 * 120, is near 1e-12 of the motion: (h w)^5 / 120 per step is the first term that the Taylor
 * series of rk4 lacks, over T / h steps. A run with twice the step removes that term; about
 * (h w)^5 w T / 720 = 1e-15 is left. */
#define REFERENCE_STEP (CS_DRUM_FRAME / 4096)

enum { FIRST_STEPS = 8 };

double cs_drum_step(void) {
    return CS_DRUM_FRAME / ceil(CS_DRUM_FRAME * CS_DRUM_OMEGA / 0.25);
}

/* Reverses and halves all velocities at the end of the first frame: a
 * change of the state that every method must restart from. Returns whether the state changed.
 */
static bool reverse_velocities(struct cs_probe *probe, double t, double dt, double *x,
                               double *v) {
    (void)x, (void)dt;
    if (fabs(t - CS_DRUM_FRAME) > 1e-9)
        return false;
    for (size_t i = 0; i < 3 * probe->n; i++)
        v[i] *= -0.5;
    return true;
}

/* Opens the scene with frames that are a whole part of CS_DRUM_FRAME. */
static bool open_frames(struct cs_probe *probe, const struct cs_conform *conform,
                        const struct cs_integrator *method, const struct cs_drum *drum,
                        double frame) {
    if (!cs_probe_open(probe, conform, method, DRUM, drum->damping, 1 / frame,
                       drum->has_contact ? PLANE : ""))
        return false;
    if (drum->has_velocity_jump)
        probe->on_commit = reverse_velocities;
    return true;
}

bool cs_drum_open(struct cs_probe *probe, const struct cs_conform *conform,
                  const struct cs_integrator *method, const struct cs_drum *drum) {
    return open_frames(probe, conform, method, drum, CS_DRUM_FRAME);
}

bool cs_drum_state(const struct cs_conform *conform, const struct cs_integrator *method,
                   const struct cs_drum *drum, double step_or_rtol, double *state,
                   struct cs_conform_row *row) {
    const bool by_tolerance = method->traits & CS_ADAPTIVE && !drum->fixed_steps;
    const bool by_frames = !by_tolerance && !cs_method_has(method, "dt");
    const double frame = by_frames ? step_or_rtol : CS_DRUM_FRAME;
    const uint32_t frames = (uint32_t)lround(CS_DRUM_FRAMES * CS_DRUM_FRAME / frame);
    struct cs_probe probe;
    open_frames(&probe, conform, method, drum, frame);
    if (by_tolerance)
        cs_probe_set_tolerance(&probe, step_or_rtol);
    else
        cs_probe_set_frames(&probe, step_or_rtol);
    bool done = cs_probe_run(&probe, frames);
    // the first step of a method that chooses it may be short
    const uint64_t most = frames + FIRST_STEPS, steps = probe.session.run.counts.steps;
    if (!done)
        cs_row_fail(row, "%s", probe.error.message);
    else if (by_frames && steps > most) {
        cs_row_skip(row, "it has no option dt, and takes several steps for a short frame");
        done = false;
    } else
        memcpy(state, probe.x, 2 * CS_DRUM_VALUES * sizeof *state);
    cs_probe_close(&probe);
    return done;
}

/* Runs the reference, and opens the scene once more for the start that the scale is taken from.
 */
static bool run_reference(const struct cs_conform *conform, const struct cs_drum *drum,
                          double *state, double scale[2], struct cs_conform_row *row) {
    struct cs_probe start;
    double coarse[2 * CS_DRUM_VALUES];
    if (!cs_drum_state(conform, &cs_conform_reference, drum, 2 * REFERENCE_STEP, coarse, row) ||
        !cs_drum_state(conform, &cs_conform_reference, drum, REFERENCE_STEP, state, row))
        return false;
    for (size_t i = 0; i < 2 * CS_DRUM_VALUES; i++)
        state[i] += (state[i] - coarse[i]) / 15;
    const bool opened = cs_drum_open(&start, conform, &cs_conform_reference, drum);
    if (opened) {
        scale[0] = cs_rms_difference(state, start.x, CS_DRUM_VALUES);
        scale[1] = cs_rms_difference(state + CS_DRUM_VALUES, start.v, CS_DRUM_VALUES);
    } else
        cs_row_fail(row, "%s", start.error.message);
    cs_probe_close(&start);
    return opened;
}

bool cs_drum_reference(const struct cs_conform *conform, const struct cs_drum *drum,
                       double *state, double scale[2], struct cs_conform_row *row) {
    enum { STATE = 2 * CS_DRUM_VALUES };
    double made[STATE + 2];
    char name[64];
    snprintf(name, sizeof name, "drum, damping %g%s%s", drum->damping,
             drum->has_velocity_jump ? ", kicked" : "", drum->has_contact ? ", touching" : "");
    const double *kept = cs_conform_cache_find(conform->cache, name, STATE + 2);
    if (!kept) {
        if (!run_reference(conform, drum, made, made + STATE, row))
            return false;
        cs_conform_cache_store(conform->cache, name, made, STATE + 2);
        kept = made;
    }
    memcpy(state, kept, STATE * sizeof *state);
    memcpy(scale, kept + STATE, 2 * sizeof *scale);
    return true;
}
