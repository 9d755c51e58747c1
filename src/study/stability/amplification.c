/* Measures the amplification matrix of a method's step on a damped oscillator. */
#include "study/stability/amplification.h"

#include "study/follow.h"
#include "study/session.h"

#include <math.h>
#include <string.h>

/* the free particle at 0, where its place is the stretch to the last bit; mass 1; frames of h
 */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"place\": {\"translate\": [-0.5, 0, 0]}},"  \
    " \"mass\": {\"particle\": 1}, \"springs\": {\"stretch\": 1, \"damping\": 0}, "            \
    "\"pins\": [0]}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": 64}}"
#define FRAME 0x1p-6
/* small against the rest length of 1, so that a clamped matrix is the exact one */
#define SMALL 0x1p-20

/* A method that remembers more than (s, w) is looked at between two later steps, when its start
 * is forgotten; the number of steps between is a power of 2. */
enum { STEPS_BEFORE = 8, STEPS_BETWEEN = 16 };
/* two steps are the square of one to this part of what a step does where nothing is
 * remembered */
#define SAME 1e-6

/* one run from (s, h w) = start; looks[k] = (s, h w) after steps[k]; false: it blew up */
static bool run_once(struct cs_session *session, const double start[2], const uint32_t steps[2],
                     double looks[2][2], struct cs_error *error) {
    struct cs_follow follow = {.run = &session->run};
    struct cs_error refused = {0};
    const double *x = session->system.state, *v = x + 6;
    const double state[12] = {[0] = -1, [1] = SMALL * start[0], [7] = SMALL * start[1] / FRAME};
    if (cs_session_begin(session, state, &refused)) {
        if (refused.status == CS_ERR_MEMORY)
            *error = refused;
        return false;
    }
    for (uint32_t k = 0; k < 2; k++) {
        follow.last = steps[k];
        cs_follow_next(&follow, &refused);
        looks[k][0] = x[1] / SMALL;
        looks[k][1] = v[1] * FRAME / SMALL;
    }
    return !refused.status && session->run.outcome == CS_RUNNING;
}

/* Spectral radius of the 2x2 matrix of trace and determinant. */
static double radius_of(double trace, double determinant) {
    const double root = trace * trace / 4 - determinant;
    return root < 0 ? sqrt(determinant) : fabs(trace) / 2 + sqrt(root);
}

/* columns of what is between two looks; false where the earlier one says nothing */
static bool matrix_between(double earlier[2][2], double later[2][2], double m[2][2]) {
    const double det = earlier[0][0] * earlier[1][1] - earlier[0][1] * earlier[1][0];
    if (!(fabs(det) > 0))
        return false;
    for (int r = 0; r < 2; r++) {
        m[0][r] = (later[0][r] * earlier[1][1] - later[1][r] * earlier[0][1]) / det;
        m[1][r] = (later[1][r] * earlier[0][0] - later[0][r] * earlier[1][0]) / det;
    }
    return true;
}

static double radius_of_matrix(double m[2][2]) {
    return radius_of(m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]);
}

/* true if the second look is what the matrix of the first does to itself */
static bool is_square(double one[2][2], double two[2][2], double same) {
    double off = 0, size = 0;
    for (int c = 0; c < 2; c++)
        for (int r = 0; r < 2; r++) {
            off = fmax(off, fabs(one[0][r] * one[c][0] + one[1][r] * one[c][1] - two[c][r]));
            size = fmax(size, fabs(one[c][r]));
        }
    return off <= same * size * size;
}

/* runs from both unit vectors: looks[k] has their images as columns; false: it blew up */
static bool measure_columns(struct cs_session *session, const uint32_t steps[2],
                            double looks[2][2][2], struct cs_error *error) {
    static const double starts[2][2] = {{1, 0}, {0, 1}};
    for (int c = 0; c < 2; c++) {
        double images[2][2];
        if (!run_once(session, starts[c], steps, images, error))
            return false;
        memcpy(looks[0][c], images[0], sizeof images[0]);
        memcpy(looks[1][c], images[1], sizeof images[1]);
    }
    return true;
}

static void measure(struct cs_session *session, double same, double *radius,
                    struct cs_error *error) {
    static const uint32_t first[2] = {1, 2};
    static const uint32_t late[2] = {STEPS_BEFORE, STEPS_BEFORE + STEPS_BETWEEN};
    double looks[2][2][2], m[2][2];
    *radius = HUGE_VAL;
    if (!measure_columns(session, first, looks, error))
        return;
    if (is_square(looks[0], looks[1], same)) {
        *radius = radius_of_matrix(looks[0]);
        return;
    }
    if (!measure_columns(session, late, looks, error))
        return;
    *radius = matrix_between(looks[0], looks[1], m) ? radius_of_matrix(m) : 0;
    for (int k = 1; k < STEPS_BETWEEN; k *= 2)
        *radius = sqrt(*radius);
}

/* the spring of s'' + rate s' + square s = 0 */
struct oscillator {
    double square, rate;
};

static void set_spring(struct cs_scene *scene, void *ctx) {
    const struct oscillator *oscillator = ctx;
    struct cs_spring_law *law = &cs_scene_bodies(scene)->springs;
    law->stretch = oscillator->square;
    law->damping = oscillator->rate;
    law->shear = law->bend = 0;
}

enum cs_status cs_amplification_measure(const struct cs_amplification *amplify, double h,
                                        double square, double rate, double *radius,
                                        struct cs_error *error) {
    /* only h^2 square and h rate decide: the frame keeps its length */
    struct oscillator oscillator = {square * (h / FRAME) * (h / FRAME), rate * (h / FRAME)};
    struct cs_session session;
    const struct cs_session_settings settings = {.scene = "one-spring",
                                                 .text = SCENE,
                                                 .edit_scene = set_spring,
                                                 .ctx = &oscillator,
                                                 .method = amplify->integrator,
                                                 .options = amplify->options,
                                                 .dt = FRAME};
    if (cs_session_open_system(&session, &settings, error))
        return error->status;
    measure(&session, SAME * fmin(1, h * h * square + h * rate), radius, error);
    cs_session_close(&session);
    return error->status;
}

/* growth beyond rounding, which is larger for a method with history, and beyond what is allowed
 */
static enum cs_status is_growing(const struct cs_amplification *amplify, double h,
                                 double square, double rate, bool *out,
                                 struct cs_error *error) {
    const bool remembers = amplify->integrator->traits & CS_MULTISTEP;
    double radius = 0;
    cs_amplification_measure(amplify, h, square, rate, &radius, error);
    const double rounding =
        (remembers ? 1e-9 : 1e-13) + (remembers ? 1e-6 : 1e-8) * h * h * square;
    *out = !(radius <= 1 + rounding + amplify->growth * h);
    return error->status;
}

enum cs_status cs_amplification_limit(const struct cs_amplification *amplify, double square,
                                      double rate, double *limit, struct cs_error *error) {
    const double fast = fmax(sqrt(square > 0 ? square : 0), rate);
    double below = 0, above = 1e-4 / fast;
    bool unstable = false;
    *limit = HUGE_VAL;
    if (!(fast > 0 && fast < HUGE_VAL))
        return CS_OK;
    while (above * fast < 1e4 && !unstable) {
        if (is_growing(amplify, above, square, rate, &unstable, error))
            return error->status;
        if (!unstable) {
            below = above;
            above *= 1.189207115002721; // 2^(1/4)
        }
    }
    if (!unstable)
        return CS_OK;
    for (int k = 0; k < 12 && below > 0; k++) {
        const double middle = (below + above) / 2;
        if (is_growing(amplify, middle, square, rate, &unstable, error))
            return error->status;
        *(unstable ? &above : &below) = middle;
    }
    *limit = below > 0 ? (below + above) / 2 : 0;
    return CS_OK;
}

enum cs_status cs_amplification_normal(const struct cs_amplification *amplify, double h,
                                       double square, double rate, double normal[2],
                                       struct cs_error *error) {
    const double step = 0.01;
    double here = 0, along_square = 0, along_rate = 0;
    const double extra = step * fmax(rate, sqrt(square > 0 ? square : 0));
    cs_amplification_measure(amplify, h, square, rate, &here, error);
    cs_amplification_measure(amplify, h, square * (1 + step), rate, &along_square, error);
    cs_amplification_measure(amplify, h, square, rate + extra, &along_rate, error);
    normal[0] = (along_square - here) / (h * h * square * step);
    normal[1] = (along_rate - here) / (h * extra);
    return error->status;
}
