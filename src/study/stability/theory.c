/* Finds the largest stable step of a method on a system by linear theory. */
#include "study/stability/theory.h"

#include "model/force/spectral_bounds.h"

#include <math.h>

/* Turns of the search direction per start; the search usually ends earlier, at a gain below 0.1
 * %. */
enum { MOST_TURNS = 5 };

enum cs_status cs_theory_init(struct cs_theory *theory, const struct cs_system *system,
                              const struct cs_integrator *integrator, const void *options,
                              double growth, struct cs_error *error) {
    *theory = (struct cs_theory){.amplification = {integrator, options, growth},
                                 .stiffness_damping_direction = {1, 0}};
    return cs_stiffest_modes_init(&theory->modes, system, error);
}

void cs_theory_finish(struct cs_theory *theory) {
    cs_stiffest_modes_finish(&theory->modes);
}

/* The bound view.delta is half of the largest damping rate, hence 2 delta. The undamped limit
 * is taken too, because damping lengthens the limit of some methods and modes need not have all
 * of it. */
enum cs_status cs_theory_gershgorin(struct cs_theory *theory, const double *x, double *dt,
                                    struct cs_error *error) {
    const struct cs_stiffest_modes *modes = &theory->modes;
    const struct cs_eval at = {.t = modes->t, .x = x, .v = modes->zeros, .parts = CS_PART_ALL};
    double omega, delta, free = HUGE_VAL, damped = HUGE_VAL;
    cs_spectral_bounds_rate(modes->system, &at, modes->dx, &omega, &delta);
    if (cs_amplification_limit(&theory->amplification, omega * omega, 0, &free, error) ||
        cs_amplification_limit(&theory->amplification, omega * omega, 2 * delta, &damped,
                               error))
        return error->status;
    *dt = fmin(*dt, fmin(free, damped));
    return CS_OK;
}

/* The limit of one motion replaces a larger one. A motion that pushes itself away is
 * physically unstable: it limits no step, but what its damping does counts. */
static enum cs_status consider(struct cs_theory *theory, const struct cs_mode *mode,
                               struct cs_theory_limit *limit, struct cs_error *error) {
    struct cs_theory_limit found = {HUGE_VAL, *mode};
    const double square = mode->omega_squared > 0 ? mode->omega_squared : 0;
    const double rate = mode->damping_rate > 0 ? mode->damping_rate : 0;
    if (cs_amplification_limit(&theory->amplification, square, rate, &found.dt, error))
        return error->status;
    if (found.dt < limit->dt)
        *limit = found;
    return CS_OK;
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
        cs_amplification_normal(&theory->amplification, 1.002 * h, limit->mode.omega_squared,
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

/* Friction comes and goes with contact, and no turning from a motion that swings leads to one
 * that is only damped: the fastest of those is searched by itself. */
static enum cs_status consider_friction(struct cs_theory *theory, const double *x,
                                        struct cs_theory_limit *limit, struct cs_error *error) {
    if (!cs_spectral_bounds_depend_on_state(theory->modes.system))
        return CS_OK;
    theory->modes.has_start = false;
    const struct cs_mode mode = cs_stiffest_modes_largest(&theory->modes, x, 0, 1);
    theory->modes.has_start = false;
    return consider(theory, &mode, limit, error);
}

enum cs_status cs_theory_tighten(struct cs_theory *theory, const double *x,
                                 struct cs_theory_limit *limit, struct cs_error *error) {
    if (!has_limit(limit))
        return CS_OK;
    const struct cs_mode mode =
        cs_stiffest_modes_largest(&theory->modes, x, theory->stiffness_damping_direction[0],
                                  theory->stiffness_damping_direction[1]);
    const double before = limit->dt;
    if (!consider(theory, &mode, limit, error) && limit->dt < 0.98 * before)
        update_search_direction(theory, limit, error);
    return error->status ? error->status : consider_friction(theory, x, limit, error);
}
