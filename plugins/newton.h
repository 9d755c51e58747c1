/* newton.h - the one nonlinear equation of all implicit methods, and its solution.
 *
 * A stage asks for a velocity u, from which position and velocity of the stage follow:
 *   r(u) = M (u - ub) - s f(t, X, V) = 0,   X = xb + gx u,   V = vb + gv u
 * so that a method is a table of coefficients (t, s, gx, gv) and of known vectors. Newton:
 *   A du = -r,   A = M - s gv D - s gx K,   K = df/dx, D = df/dv of CS_PART_LINEARISED
 * with the exact force in r. A is the host's matrix with compressed springs clamped (Teran et
 * al. 2005) while |r| is large: positive definite, so that du goes downhill. Once |r| is below
 * a tenth of the impulse it is the exact one, unless that is indefinite, which gives Newton's
 * convergence back.
 *
 * Start: the method's guess of u, but no further from the free motion X = x0 + c v0, c s after
 * the step's begin, than host->max_step_fraction allows with obstacles where they are at t. The
 * loop over steps has asked about the free motion already (fixed_step.h). Displacements from
 * the step's begin are no measure for this: an obstacle that comes may be beyond x0 at t, and
 * the same obstacle at rest, at which the particles are thrown, is not.
 *
 * Line search: a starts at the fraction of the displacement to X(u + du) that
 * host->max_step_fraction allows, 1 without limits, and is halved until |r| falls at u + a du,
 * or until the incremental potential (Martin et al. 2011; Gast et al. 2015)
 *   P(u) = (u - ub)^T M (u - ub) / 2 + (s/gx) (potential energy)(X) - s w.(u - u0)
 * falls by 1e-4 of what its slope r.du promises. Forces without energy, such as dampers, drag
 * and wind, have no potential: their force w is frozen at the start u0 of the search, where P
 * then has the slope of r.
 *
 * Friction is no such force: its limit mu N follows the positions without delay, and in a fast
 * contact P with frozen friction and |r| disagree. An iteration that accepts either then runs
 * in circles. Where contact has friction and the iteration stalls, it goes on with friction
 * lagged at its last positions (Li et al. 2020, sec. 5). That has a convex potential R of the
 * velocities (host->friction_potential), P(u) = ... + (s/gv) R(V) has the slope of r, and P
 * alone decides the line search. Friction is lagged again at each solution until the residual
 * with true friction is small: equation and order of a method are as before.
 *
 * Norms of r are |r|^2 = sum r_i^2 / m_i. Done: |r| <= rtol |M (u - ub)|, the impulse of the
 * stage, or |r| below what rounding of x and u alone may cause.
 */
#ifndef NEWTON_H
#define NEWTON_H

#include <clothsim/integrator.h>

/* Options that all methods with a Newton iteration have, as fields and as rows. */
#define NEWTON_FIELDS                                                                          \
    double dt, rtol;                                                                           \
    int64_t iterations
#define NEWTON_ROWS(struct_)                                                                   \
    FIXED_STEP_DT_BY_ERROR(struct_),                                                           \
        CS_OPTION(struct_, rtol, "", 1e-6, 1e-14, 0.1,                                         \
                  "residual of Newton's iteration, relative to the impulse of the step"),      \
        CS_OPTION(                                                                             \
            struct_, iterations, "", 30, 1, 1000,                                              \
            "maximum Newton iterations; then friction of contact is lagged, or the step "      \
            "is halved, up to 12 times")

struct newton;
struct newton_stage;

/* Changes newton->f, the force at newton->x. */
typedef void newton_exchange(struct newton *newton, const struct newton_stage *stage);

/* The equation of one stage, in the symbols above; the vectors are borrowed. */
struct newton_stage {
    /* time of the force in s; its factor s in s; dX/du in s; dV/du */
    double t, s, gx, gv;
    const double *xb, *ub; /* (3,n) in m and m/s */
    const double *vb;      /* (3,n) in m/s; NULL: 0 */
    double c;              /* time since the begin of the step in s */
    const double *x0, *v0; /* (3,n) in m and m/s: the state at the begin of the step */
    /* for forces that the step, not the stage, decides; A does not know them. NULL: none */
    newton_exchange *exchange;
};

/* The solver of a method: its settings, scratch, and the result of the last evaluation. */
struct newton {
    const struct cs_host *host;
    double rtol;
    int64_t iterations;
    /* Fraction of newton_rounding_floor that a residual must fall below, 1 after newton_init:
     * smaller for methods of many digits. If rounding ends the iteration before, the floor
     * itself is enough. */
    double residual_floor;
    double
        absolute; /* sqrt(J): added to the residual that is small enough; 0 after newton_init */
    double *x, *v;              /* (3,n): X and V of the last u */
    double *r, *f;              /* (3,n) */
    double *rhs, *du, *u_start; /* (3,n) */
    double *zeros;              /* (3,n): stays 0 */
    double *friction;           /* (3,n): lagged friction; NULL: no contact has friction */
    bool lagged;                /* friction is lagged */
    uint32_t may_fail;          /* CS_SOLVE_MAY_FAIL, or 0 */
    bool linear_failed;         /* a linear solve ended the last solution */
    double norm, impulse;       /* |r| and |M (u - ub)| of the last u, in sqrt(J) */
    double mass;                /* kg, of the free particles */
    bool line_search_blocked;   /* a move of the last solution was cut, for it went through a
                                   surface */
    uint64_t converged;         /* iterations so far */
};

/* Fills *newton and allocates its arrays; [create]. */
enum cs_step newton_init(struct newton *newton, const struct cs_host *host, double rtol,
                         int64_t iterations);

/* Solves a stage from the start u (3,n), in place; newton->x and newton->v then hold X and V
 * of the solution. *converged is false if the iterations or the line search ended before; u
 * is useless then. */
typedef enum cs_step newton_solver(struct newton *newton, const struct newton_stage *stage,
                                   double *u, bool *converged);
newton_solver newton_solve;

/* One Newton step of full length, tested only for finite numbers. newton->rtol is the
 * relative residual of its linear solve. */
newton_solver newton_step;

/* |r| in sqrt(J) that rounding causes, with X and V of the stage that was solved last: 4 eps
 * sqrt(m) (s omega^2 max|X| + (1 + 2 s gv delta) max|u|). The first term is the rounding of x
 * times a stiffness of m omega^2, the second that of u in inertia and dampers. */
double newton_rounding_floor(const struct newton *newton, const struct newton_stage *stage,
                             const double *u);

#endif
