/* Measures the amplification matrix of a method's step on a damped oscillator, and finds the
 * largest stable step of a method on a system by linear theory. */
#include "borders/theory.h"

#include "session/energy_monitor.h"
#include "session/session.h"

#include <math.h>
#include <string.h>

/* Scene of one spring. The pinned particle is at x = -1, the free one of mass 1 at 0, so its x
 * is the elongation without rounding. Rest length 1; stiffness and damping are set by
 * set_spring; a frame is one step. */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"place\": {\"translate\": [-0.5, 0, 0]}},"  \
    " \"mass\": {\"particle\": 1}, \"springs\": {\"stretch\": 1, \"damping\": 0}, "            \
    "\"pins\": [0]}], \"forces\": {\"gravity\": [0, 0, 0]}, \"time\": {\"fps\": 64}}"
#define FRAME 0x1p-6

/* Amplitude of the motion, small against the rest length of 1: a matrix whose terms are clamped
 * by strain is then the exact one. */
#define SMALL 0x1p-20

/* A method that remembers more than (s, w) is measured between two later steps, when its start
 * is forgotten. The number of steps in between is a power of 2, for roots by sqrt. */
enum { STEPS_BEFORE = 8, STEPS_BETWEEN = 16 };

/* Nominal s of a measurement: nearly all of it is to open the scene. */
#define MEASURE_SECONDS 1e-4

/* Tolerance of the test that two steps are the square of one, relative to the effect of a
 * step. */
#define SAME 1e-6

/* Runs from (s, h w) = start; looks[k] = (s, h w) after steps[k] steps. Returns false if the
 * method blew up or refused. Only lack of memory and a changed process are passed on in *error:
 * a refusal is a result here. */
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
    if (session->run.is_process_changed)
        *error = refused;
    return !refused.status && session->run.outcome == CS_RUNNING;
}

/* Solves m E = L for the matrix m between two looks with the columns E (earlier) and L (later),
 * by Cramer's rule. Returns false if E is singular, as after complete decay. All matrices are
 * stored by columns. */
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

/* Spectral radius of a 2x2 matrix from its trace t and determinant d. The eigenvalues solve l^2
 * - t l + d = 0. A complex pair has |l|^2 = d; real ones have |l| = |t|/2 + sqrt(t^2/4 - d). */
static double radius_of_matrix(double m[2][2]) {
    const double trace = m[0][0] + m[1][1], det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    const double root = trace * trace / 4 - det;
    return root < 0 ? sqrt(det) : fabs(trace) / 2 + sqrt(root);
}

/* True if the second look is the square of the first matrix, to `same` of its squared size. */
static bool is_square(double one[2][2], double two[2][2], double same) {
    double off = 0, size = 0;
    for (int c = 0; c < 2; c++)
        for (int r = 0; r < 2; r++) {
            off = fmax(off, fabs(one[0][r] * one[c][0] + one[1][r] * one[c][1] - two[c][r]));
            size = fmax(size, fabs(one[c][r]));
        }
    return off <= same * size * size;
}

/* Runs from both unit vectors; looks[k] has their images as columns. Returns false if a run
 * blew up. */
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

/* Spectral radius per step; HUGE_VAL after a blow-up. First tries one step as the whole matrix;
 * a method with memory is measured between later steps. Four square roots take the 16th root.
 */
static void measure_radius(struct cs_session *session, double same, double *radius,
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

/* Edits the checked scene: with mass 1 the stiffness is the square, the damping the rate. */
static void set_spring(struct cs_scene *scene, void *ctx) {
    const struct oscillator *oscillator = ctx;
    struct cs_spring_law *law = &cs_scene_bodies(scene)->springs;
    law->stretch = oscillator->square;
    law->damping = oscillator->rate;
    law->shear = law->bend = 0;
}

/* The frame keeps its length because only h^2 square and h rate matter: both are scaled
 * instead. The tolerance of the squaring test shrinks with the step, because a short step does
 * little: a fixed one would take any method for one without memory. */
enum cs_status cs_amplification_measure(const struct cs_amplification *amplification, double h,
                                        double square, double rate, double *radius,
                                        struct cs_error *error) {
    /* only h^2 square and h rate decide: the frame keeps its length */
    struct oscillator oscillator = {square * (h / FRAME) * (h / FRAME), rate * (h / FRAME)};
    struct cs_session session;
    const struct cs_session_settings settings = {.scene = "one-spring",
                                                 .text = SCENE,
                                                 .edit_scene = set_spring,
                                                 .ctx = &oscillator,
                                                 .method = amplification->integrator,
                                                 .options = amplification->options,
                                                 .dt = FRAME};
    if (amplification->pot)
        *amplification->pot -= MEASURE_SECONDS;
    if (cs_session_open_system(&session, &settings, error))
        return error->status;
    measure_radius(&session, SAME * fmin(1, h * h * square + h * rate), radius, error);
    cs_session_close(&session);
    return error->status;
}

/* *out: the radius exceeds 1 by more than rounding and the allowed growth per step, growth h.
 * The allowance for rounding was chosen by trial. It is larger for multistep methods, whose
 * matrix is a quotient of later states. */
static enum cs_status is_growing(const struct cs_amplification *amplification, double h,
                                 double square, double rate, bool *out,
                                 struct cs_error *error) {
    const bool remembers = amplification->integrator->traits & CS_MULTISTEP;
    double radius = 0;
    cs_amplification_measure(amplification, h, square, rate, &radius, error);
    const double rounding =
        (remembers ? 1e-9 : 1e-13) + (remembers ? 1e-6 : 1e-8) * h * h * square;
    *out = !(radius <= 1 + rounding + amplification->growth * h);
    return error->status;
}

enum cs_status cs_amplification_limit(const struct cs_amplification *amplification,
                                      double square, double rate, double *limit,
                                      struct cs_error *error) {
    const double fast = fmax(sqrt(square > 0 ? square : 0), rate);
    double below = 0, above = 1e-4 / fast;
    bool unstable = false;
    *limit = HUGE_VAL;
    if (!(fast > 0 && fast < HUGE_VAL))
        return CS_OK;
    while (above * fast < 1e4 && !unstable) {
        if (is_growing(amplification, above, square, rate, &unstable, error))
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
        if (is_growing(amplification, middle, square, rate, &unstable, error))
            return error->status;
        *(unstable ? &above : &below) = middle;
    }
    *limit = below > 0 ? (below + above) / 2 : 0;
    return CS_OK;
}

/* Outward normal of the stable set in the plane (h^2 square, h rate) near its border: the
 * gradient of the spectral radius by forward differences of 1 %. Not scaled; infinite or NAN
 * where the method blows up. square > 0. */
static enum cs_status normal_amplification(const struct cs_amplification *amplification,
                                           double h, double square, double rate,
                                           double normal[2], struct cs_error *error) {
    const double step = 0.01;
    double here = 0, along_square = 0, along_rate = 0;
    const double extra = step * fmax(rate, sqrt(square > 0 ? square : 0));
    cs_amplification_measure(amplification, h, square, rate, &here, error);
    cs_amplification_measure(amplification, h, square * (1 + step), rate, &along_square, error);
    cs_amplification_measure(amplification, h, square, rate + extra, &along_rate, error);
    normal[0] = (along_square - here) / (h * h * square * step);
    normal[1] = (along_rate - here) / (h * extra);
    return error->status;
}

/* Turns of the search direction per start; the search usually ends earlier, at a gain below 0.1
 * %. */
enum { MOST_TURNS = 5 };

enum cs_status cs_theory_init(struct cs_theory *theory, struct cs_system *system,
                              const struct cs_integrator *integrator, const void *options,
                              double growth, struct cs_error *error) {
    *theory = (struct cs_theory){.amplification = {integrator, options, growth, NULL},
                                 .stiffness_damping_direction = {1, 0}};
    return cs_stiffest_modes_init(&theory->modes, system, error);
}

void cs_theory_finish(struct cs_theory *theory) {
    cs_stiffest_modes_finish(&theory->modes);
}

/* The limit of one motion replaces a larger one, and is searched only if the motion grows at
 * the limit there is. A motion that pushes itself away is physically unstable: it limits no
 * step, but what its damping does counts. */
static enum cs_status consider(struct cs_theory *theory, const struct cs_mode *mode,
                               struct cs_theory_limit *limit, struct cs_error *error) {
    struct cs_theory_limit found = {HUGE_VAL, *mode};
    const double square = mode->omega_squared > 0 ? mode->omega_squared : 0;
    const double rate = mode->damping_rate > 0 ? mode->damping_rate : 0;
    bool grows = true;
    if (limit->dt > 0 && limit->dt < HUGE_VAL &&
        (is_growing(&theory->amplification, limit->dt, square, rate, &grows, error) || !grows))
        return error->status;
    if (cs_amplification_limit(&theory->amplification, square, rate, &found.dt, error))
        return error->status;
    if (found.dt < limit->dt)
        *limit = found;
    return CS_OK;
}

/* The bound view.delta is half of the largest damping rate, hence 2 delta. The undamped limit
 * is taken too, because damping lengthens the limit of some methods and modes need not have all
 * of it. */
enum cs_status cs_theory_gershgorin(struct cs_theory *theory, const double *x, double *dt,
                                    struct cs_error *error) {
    const struct cs_stiffest_modes *modes = &theory->modes;
    const struct cs_eval at = {.t = modes->t, .x = x, .v = modes->zeros, .parts = CS_PART_ALL};
    struct cs_theory_limit limit = {.dt = *dt};
    double omega, delta;
    cs_spectral_bounds_rate(modes->system, &at, false, modes->dx, &omega, &delta);
    struct cs_mode mode = {.omega_squared = omega * omega};
    if (consider(theory, &mode, &limit, error))
        return error->status;
    mode.damping_rate = 2 * delta;
    if (!consider(theory, &mode, &limit, error))
        *dt = limit.dt;
    return error->status;
}

/* Turns the search direction to the outward normal of the stable set at the limit.
 *
 * The normal is the gradient of the spectral radius. It is taken at 1.002 h, just outside the
 * border: inside, the radius of a symplectic method is 1 everywhere and its gradient vanishes.
 * With (n1, n2) in the plane (h^2 square, h rate) the functional on (square, rate) is a = h^2
 * n1, b = h n2. Only the ratio a : b matters for the eigenvector; the division removes the
 * scale. */
static enum cs_status update_search_direction(struct cs_theory *theory,
                                              const struct cs_theory_limit *limit,
                                              struct cs_error *error) {
    const double h = limit->dt;
    double normal[2];
    if (!(limit->mode.omega_squared > 0) ||
        normal_amplification(&theory->amplification, 1.002 * h, limit->mode.omega_squared,
                             fmax(limit->mode.damping_rate, 0), normal, error))
        return error->status;
    const double a = h * h * normal[0], b = h * normal[1];
    const double scale = fabs(a) + fabs(b) / h;
    if (isfinite(scale) && scale > 0) {
        theory->stiffness_damping_direction[0] = a / scale;
        theory->stiffness_damping_direction[1] = b / scale;
    }
    return CS_OK;
}

/* True for a limit that is neither "no stable step" (0) nor "no limit" (HUGE_VAL). */
static bool has_limit(const struct cs_theory_limit *limit) {
    return limit->dt > 0 && limit->dt < HUGE_VAL;
}

/* Alternates from the direction (a, b) between the largest eigenvalue and the normal at the
 * limit of its mode. Ends when a turn gains less than 0.1 %. */
static enum cs_status descend(struct cs_theory *theory, const double *x, double a, double b,
                              struct cs_theory_limit *limit, struct cs_error *error) {
    theory->stiffness_damping_direction[0] = a;
    theory->stiffness_damping_direction[1] = b;
    theory->modes.has_start = false;
    for (int k = 0; k < MOST_TURNS; k++) {
        const double before = limit->dt;
        const struct cs_mode mode =
            cs_stiffest_modes_largest(&theory->modes, x, theory->stiffness_damping_direction[0],
                                      theory->stiffness_damping_direction[1]);
        if (consider(theory, &mode, limit, error))
            return error->status;
        if (!has_limit(limit) || !(limit->dt < 0.999 * before) ||
            update_search_direction(theory, limit, error))
            break;
    }
    return error->status;
}

/* The damped start comes first. Its limit is kept unless the elastic start finds a smaller one;
 * the direction left behind belongs to the smaller of the two. */
enum cs_status cs_theory_at(struct cs_theory *theory, const double *x,
                            struct cs_theory_limit *limit, struct cs_error *error) {
    *limit = (struct cs_theory_limit){.dt = HUGE_VAL};
    if (theory->modes.system->view.delta > 0 && descend(theory, x, 0, 1, limit, error))
        return error->status;
    struct cs_theory_limit swing = {.dt = HUGE_VAL};
    if (descend(theory, x, 1, 0, &swing, error))
        return error->status;
    if (swing.dt < limit->dt)
        *limit = swing;
    if (has_limit(limit))
        update_search_direction(theory, limit, error);
    return error->status;
}

/* Dampers of contact come and go with it, and no turning from a motion that swings leads to one
 * that is only damped: the fastest of those is searched by itself. */
static enum cs_status consider_dampers(struct cs_theory *theory, const double *x,
                                       struct cs_theory_limit *limit, struct cs_error *error) {
    if (!cs_system_damps_contact(theory->modes.system) ||
        !cs_spectral_bounds_depend_on_state(theory->modes.system))
        return CS_OK;
    theory->modes.has_start = false;
    const struct cs_mode mode = cs_stiffest_modes_largest(&theory->modes, x, 0, 1);
    theory->modes.has_start = false;
    return consider(theory, &mode, limit, error);
}

enum cs_status cs_theory_tighten(struct cs_theory *theory, const double *x, bool with_dampers,
                                 struct cs_theory_limit *limit, struct cs_error *error) {
    if (!has_limit(limit))
        return CS_OK;
    const struct cs_mode mode =
        cs_stiffest_modes_largest(&theory->modes, x, theory->stiffness_damping_direction[0],
                                  theory->stiffness_damping_direction[1]);
    const double before = limit->dt;
    if (!consider(theory, &mode, limit, error) && limit->dt < 0.98 * before)
        update_search_direction(theory, limit, error);
    return error->status || !with_dampers ? error->status
                                          : consider_dampers(theory, x, limit, error);
}
