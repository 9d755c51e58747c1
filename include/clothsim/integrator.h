/* SPDX-License-Identifier: MIT */
/* integrator.h - the one contract between clothsim and an integrator module.
 *
 * A module is a shared object that exports ONE symbol, `clothsim_module`. It links against
 * nothing of clothsim: all it may ask for comes through struct cs_host.
 *
 * Units are SI. The state is one array of 6n doubles, component-major: x (3,n), then v (3,n).
 * v == x + 3n always holds, so that a solver may treat x as one vector of 6n numbers.
 *
 * Equation of motion: M dv/dt = f(t,x,v), dx/dt = v.
 *
 * Pinned particles need no special case: their inv_mass is 0, and their rows of f and df are 0
 * too. Their v is 0, or that of the path along which the scene moves them, and constant between
 * restarts: after a step h such a particle is at x + h v. commit places those on a path, and
 * does not set *changed for it; a module that moves one at rest, by a rounding too, ends the
 * run. Where the scene turns particles that it holds, all calls of the host that take t take x
 * and v from their arc at t, and commit sets both. Forces depend on t in this way.
 *
 * The scene's events happen between two calls of advance. There x, v, view->mass,
 * view->inv_mass and the springs' constants may change in place, and then restart is called.
 * view->omega and view->delta hold for the whole run. Within an advance forces may depend on t
 * (ramps are linear in it): pass the time of the stage. The list of springs always shows the
 * constants at the t of the last call. A matrix that a method has stored does not follow.
 *
 * Marks in brackets say during which calls of the module a call of the host is allowed, and in
 * which order the calls of the module come. Not on offer, on purpose: random numbers, a clock,
 * files, and threads of your own. vector->parallel_for lends the host's threads for a loop.
 */
#ifndef CLOTHSIM_INTEGRATOR_H
#define CLOTHSIM_INTEGRATOR_H

#include <clothsim/clones.h>
#include <clothsim/option.h>
#include <clothsim/parts.h>
#include <clothsim/stats.h>
#include <clothsim/system.h>

#ifdef __cplusplus
#define CS_EXPORT extern "C" __attribute__((visibility("default")))
extern "C" {
#else
#define CS_EXPORT __attribute__((visibility("default")))
#endif

/* Raised whenever a struct changes other than by growing at its end. */
#define CS_ABI          1u
#define CS_PRINTF(a, b) __attribute__((format(printf, a, b)))

/* How a call ended. */
enum cs_step {
    CS_STEP_OK,
    /* The run ends with a result: commit said so, return it upwards at once. Or, from advance
     * alone, no step is short enough: host->fail was told, x and v are of the last commit. */
    CS_STEP_HALT,
    /* The reason was given to host->fail. */
    CS_STEP_FAIL,
    /* commit takes the step back: return it upwards at once; restart follows. */
    CS_STEP_BACK
};

/* Services that the host builds for the method. You pay only for those that you ask for. A call
 * whose need was not declared returns CS_STEP_FAIL, or leaves its output untouched. */
enum cs_need {
    CS_NEED_JVP = 1u << 0, /* jvp */
    /* diagonal. */
    CS_NEED_DIAGONAL = 1u << 1,
    /* energy. */
    CS_NEED_ENERGY = 1u << 2,
    /* The list of springs in the view. */
    CS_NEED_SPRINGS = 1u << 3,
    /* solve_setup, solve and matrix_product. */
    CS_NEED_SOLVE = 1u << 4,
    /* Groups that keep their shape, in the view. The host refuses scenes without them. */
    CS_NEED_CLUSTERS = 1u << 5,
    /* euler_finish: euler_setup steps particles in impact with colliders alone. */
    CS_NEED_REBOUNDS = 1u << 6,
    /* lag_friction and friction_potential. */
    CS_NEED_LAGGED_FRICTION = 1u << 7,
    /* With CS_NEED_SPRINGS: colours and the springs at each particle, in the view. */
    CS_NEED_COLOURS = 1u << 8,
    /* bounds_at in every scene. */
    CS_NEED_BOUNDS = 1u << 9
};

/* Properties of the method. The program shows them, and `clothsim conform` tests them. */
enum cs_trait {
    CS_IMPLICIT = 1u << 0,
    CS_ADAPTIVE = 1u << 1,
    CS_MULTISTEP = 1u << 2,
    CS_SYMPLECTIC = 1u << 3,
    /* The bits are the same only with the same build of a foreign library. */
    CS_LIBRARY_BITS = 1u << 4,
    /* A uniform velocity changes the internal forces. */
    CS_NOT_GALILEAN = 1u << 5,
    /* All forces but the springs are evaluated at the begin of a step only, whatever its
     * length: scenes with stiff ones, such as contact by force, are refused. */
    CS_EXPLICIT_OUTER = 1u << 6,
    /* Its steps make energy where they are long against the springs, although it is implicit:
     * its default step holds on soft scenes only. */
    CS_MAKES_ENERGY = 1u << 7,
    /* It needs smooth forces and equal steps: scenes with contact, events or corrections after
     * a step are refused. */
    CS_SMOOTH_ONLY = 1u << 8
};

/* The limit of the method's result, however small its own tolerances are. */
enum cs_fidelity {
    /* Converges to the equation of motion at the method's order. */
    CS_FIDELITY_ODE,
    /* Becomes one step of implicit Euler as the iterations grow. */
    CS_FIDELITY_IMPLICIT_EULER,
    /* Meets the equation of motion only as the step goes to 0. */
    CS_FIDELITY_CONSISTENT,
    /* Is another model: no error against the equation of motion is measured. */
    CS_FIDELITY_OTHER
};

enum cs_solve_flag {
    /* Make A positive definite for any state: drop the transverse part of compressed springs
     * (Teran et al. 2005). */
    CS_SOLVE_PSD = 1u << 0,
    /* Take friction by an upper bound: at the slope that its force has now, instead of the
     * smaller one that it grows by. Newton's iteration far from a solution needs it, or it
     * overshoots; a linearised method must not have it, whose forces at rest would be wrong. */
    CS_SOLVE_BOUND = 1u << 1,
    /* Of euler_setup: take friction by its derivative, as solve_setup does. For methods that
     * need more of A than one step of implicit Euler. */
    CS_SOLVE_TANGENT = 1u << 2,
    /* A solve that fails is no failure of the run: it returns CS_STEP_FAIL and says nothing,
     * and the method goes another way. Not in hosts without lag_friction. */
    CS_SOLVE_MAY_FAIL = 1u << 3
};

/* The calls of the host. Pass ctx as the first argument of every call. */
struct cs_host {
    /* sizeof at the host's build: see CS_HAS. */
    uint32_t size;
    void *ctx;
    /* Both are valid until destroy returns. */
    const struct cs_view *view;
    const struct cs_vector_kernels *vector;

    /* [create] Memory for the whole run: zeroed, 64-byte aligned, freed by the host after
     * destroy. NULL: out of memory, which the host has reported already. */
    void *(*alloc)(void *ctx, size_t bytes);

    /* [create, restart, advance] Says why the method cannot go on; the first message counts.
     * Returns CS_STEP_FAIL, so that `return host->fail(...)` is all you need. */
    enum cs_step (*fail)(void *ctx, const char *format, ...) CS_PRINTF(2, 3);

    /* [create, restart, advance] A remark for the report; a repeated one is stored once. */
    void (*note)(void *ctx, const char *format, ...) CS_PRINTF(2, 3);

    /* [restart, advance] f (3,n) in N = the sum of the chosen parts. Overwrites f. */
    void (*force)(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                  double *f);

    /* [restart, advance] Kinetic and potential energy in J, of CS_PART_WITH_ENERGY. Needs
     * CS_NEED_ENERGY. */
    double (*energy)(void *ctx, double t, const double *x, const double *v);

    /* [restart, advance] df (3,n) = (df/dx) dx + (df/dv) dv of the chosen parts, exact.
     * Overwrites df. dx or dv may be NULL, which means 0. Held particles count: with their v in
     * dx it has what their motion adds. Where they turn, force has them on their arcs at t, so
     * that a difference of force over t holds that too: take one of both. Needs CS_NEED_JVP. */
    void (*jvp)(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                const double *dx, const double *dv, double *df);

    /* [restart, advance] The 3x3 diagonal blocks of the derivatives of CS_PART_LINEARISED:
     * kxx = df_i/dx_i and dvv = df_i/dv_i of each particle i. Both are (6,n),
     * component-major: xx, xy, xz, yy, yz, zz. Needs CS_NEED_DIAGONAL. */
    void (*diagonal)(void *ctx, double t, const double *x, const double *v, double *kxx,
                     double *dvv);

    /* [advance] The host's own linear solver, so that methods are compared and not solvers.
     * Prepares A = cm M + cd df/dv + ck df/dx of CS_PART_LINEARISED at (t, x, v), with
     * cm > 0, cd <= 0 and ck <= 0: backward Euler has 1, -h, -h h. flags: enum cs_solve_flag.
     * A is symmetric: the derivative of dampers by places is left out. Without CS_SOLVE_PSD an
     * A that turns out indefinite is made definite after all, and that is counted. Needs
     * CS_NEED_SOLVE. */
    enum cs_step (*solve_setup)(void *ctx, double t, const double *x, const double *v,
                                double cm, double cd, double ck, uint32_t flags);

    /* [advance] Solves A u = b with the A of the last solve_setup, to |b - A u| <= rtol |b|, as
     * often as you like. u (3,n) holds the start of the iteration, and then the result. Rows of
     * pinned particles become 0. */
    enum cs_step (*solve)(void *ctx, const double *b, double rtol, double *u);

    /* [advance] y (3,n) = A p with the A of the last solve_setup. Rows of pinned particles
     * become 0. Counted as a Jacobian product. */
    void (*matrix_product)(void *ctx, const double *p, double *y);

    /* [advance] You MUST call it after every accepted internal step, of length dt, that ended
     * at time t. It limits strains, resolves contact, takes the velocity loss, looks for a
     * blow-up, and counts. It may move x and v, and, with contact by projection, pin
     * particles that rest on an obstacle or let them go (view->inv_mass); then *changed is
     * true, and a method that keeps history restarts. Return anything but CS_STEP_OK upwards
     * at once. */
    enum cs_step (*commit)(void *ctx, double t, double dt, double *x, double *v, bool *changed);

    /* Below: only where the scene has forces whose stiffness depends on the state (contact), or
     * steps must not carry surfaces through each other, else NULL; and not in hosts whose size
     * ends before it: ask CS_HAS(host, bounds_at) first. */

    /* [restart, advance] With CS_NEED_BOUNDS in every scene. Bounds at a state, for automatic
     * steps: omega in 1/s on the angular frequency, delta in 1/s on half the damping rate.
     * Those of the view hold for the springs alone. */
    void (*bounds_at)(void *ctx, double t, const double *x, const double *v, double *omega,
                      double *delta);
    /* [advance] The admissible fraction, 0..1, of the displacement from x0 (3,n) at t0 to x1 at
     * t1. Below 1 the displacement passes over contact that a step cannot see from its start,
     * or carries surfaces through each other: take a shorter step. 0: no fraction is. Within an
     * iteration t1 is t0: then only crossings of surfaces count. With stages or an iteration,
     * ask about x0 + h v0 too: a step that enters contact and leaves it again ends outside. */
    double (*max_step_fraction)(void *ctx, double t0, const double *x0, double t1,
                                const double *x1);

    /* [advance] Only where contact follows each step in commit (contact by projection), else
     * NULL; and not in hosts whose size ends before it. For methods that choose their step: the
     * longest in s from (x, v) at t that leaves contact little to undo. HUGE_VAL: any does. */
    double (*longest_step)(void *ctx, double t, const double *x, const double *v);

    /* [advance] Only where contact is a force or bodies are sewn, else NULL; and not in hosts
     * whose size ends before it. What both add to the mass of each particle in an implicit
     * Euler step of length h: contact_blocks (6,n) in kg = -h df/dv - h h df/dx of
     * CS_PART_POTENTIAL and CS_PART_DISSIPATIVE at (t, x, v), each as CS_SOLVE_PSD and
     * CS_SOLVE_BOUND have it: xx, xy, xz, yy, yz, zz. For methods that move particles one after
     * the other: with h h f they make a step towards balance with the rest. */
    void (*contact_blocks)(void *ctx, double t, const double *x, const double *v, double h,
                           double *contact_blocks);

    /* [restart, advance] force with CS_PART_ALL and diagonal in one call, to the same bits and
     * in less time, which counts as one of each; ask CS_HAS(host, force_diagonal) first. blocks
     * (12,n) is kxx, then dvv. Needs CS_NEED_DIAGONAL. */
    void (*force_diagonal)(void *ctx, double t, const double *x, const double *v, double *f,
                           double *blocks);

    /* For the whole run: nothing acts between steps, and no event comes (no contact, strain
     * limit, velocity loss or crossings). Then a step may end after t1: the method gives the
     * state at t1 by interpolation, commits it as if the step had ended there, and commits the
     * rest of the step in the next advance. commit leaves its own state alone, unless it sets
     * *changed. Not in older hosts: ask CS_HAS(host, may_overstep) first. */
    bool may_overstep;

    /* [advance] The linear system of a linearised step of implicit Euler, A dv = b with
     * A = M - h D - h^2 K as solve_setup(1, -h, -h h) makes it and
     * b (3,n) = h f + h^2 K (v - w) in N s, at (t, x, v), but for friction of contact, whose D
     * is the chord to where it will be at the end of the step. K is that of A; w is the
     * velocity of the surface that a force comes from, of obstacles that move, and 0 else. With
     * solve(b) and v += dv, x += h v the step is done. x, v and b must stay until that solve:
     * where it has to clamp A, it writes the b of the clamped A too. f is computed on the
     * way, which counts as a force and two Jacobian products. Needs CS_NEED_SOLVE. Not in hosts
     * whose size ends before it: ask CS_HAS(host, euler_setup) first. */
    enum cs_step (*euler_setup)(void *ctx, double t, double h, const double *x, const double *v,
                                uint32_t flags, double *b);
    /* [advance] With CS_NEED_REBOUNDS, and only where a particle can be in impact with a
     * collider, else NULL. Call it after v += dv, x += h v: adds to x and v (3,n) what impacts
     * do, which b leaves out. Ask max_step_fraction next, which judges particles in impact by
     * a rule of their own. */
    void (*euler_finish)(void *ctx, double *x, double *v);

    /* Only where contact by force has friction, else NULL; and not in hosts whose size ends
     * before it: ask CS_HAS(host, lag_friction) first. Both need CS_NEED_LAGGED_FRICTION. For
     * methods that minimise: with its normal forces N and directions n at fixed positions,
     * friction has a potential in the velocities (Li et al. 2020),
     *   R(v) = sum mu N (sqrt(T.T + ev^2) - ev),  T the sliding velocity of each contact. */

    /* [advance] From now on force, jvp, diagonal, solve_setup and bounds_at have -dR/dv of the
     * contacts at (t, x) in place of friction. x NULL: friction again. End it before commit. */
    void (*lag_friction)(void *ctx, double t, const double *x);
    /* [advance] R in W at v, and f (3,n) = -dR/dv in N: the lagged friction alone. */
    double (*friction_potential)(void *ctx, const double *v, double *f);

    /* [advance] z (3,n) = B^-1 r with the preconditioner of the last solve_setup or
     * euler_setup: symmetric, positive definite, and near A^-1. For methods with an iteration
     * of their own. r (3,n) must be 0 on pinned particles; z then is. Needs CS_NEED_SOLVE. Not
     * in hosts whose size ends before it: ask CS_HAS(host, precondition) first. */
    void (*precondition)(void *ctx, const double *r, double *z);
    /* For the whole run: at equal x and v forces may differ with t, by ramps, paths or key
     * frames. False: the time that you pass has no effect, and df/dt is 0. Not in older hosts:
     * ask CS_HAS(host, forces_depend_on_time) first. */
    bool forces_depend_on_time;
    /* For the whole run, both above 0: the longest side l in m of the box of all particles at
     * time 0, and in m/s sqrt(g l)/pi: l over half a swing of a pendulum of that length, 1 m/s
     * at 1 m; without gravity the largest speed at time 0, else l per second, or per 1000 s if
     * nothing moves the scene. An absolute tolerance that nobody set is a relative one times
     * these. Not in older hosts: ask CS_HAS(host, speed_scale) first. */
    double length_scale, speed_scale;
    /* [create, advance] s. Above 0: a step may pass t1 as with may_overstep, up to this time of
     * the next event (HUGE_VAL: there is none), and contact by force may act: ask
     * max_step_fraction about the whole step. 0 for the whole run: steps end at t1. Not in
     * older hosts: ask CS_HAS(host, overstep_until) first. */
    double overstep_until;
    /* [restart, advance] force with CS_PART_ALL, then a loop over all particles: the same bits.
     * A range of the loop comes, on any thread, when f is complete there and no force reads x
     * and v there again: it may move them. NULL in traced runs; see CS_HAS(host, force_then) */
    void (*force_then)(void *ctx, double t, const double *x, const double *v, double *f,
                       const struct cs_loop *loop);
};

/* A method: what it claims, and its calls. The host calls them in the order
 *   create, then for each stretch of time restart and any number of advance, then destroy.
 * Marks in brackets say when a call comes, and after which others. */
struct cs_integrator {
    /* sizeof(struct cs_integrator) at the module's build. */
    uint32_t size;
    /* [a-z0-9-]+, e.g. "implicit-block". */
    const char *name;
    /* One line for `clothsim integrators`, and where the method was published. */
    const char *summary;
    const char *source;

    /* Order of the error on smooth scenes, without damping and with forces that depend on the
     * velocity. */
    uint32_t order;
    uint32_t order_damped;
    /* Sets of enum cs_need and enum cs_trait. */
    uint32_t needs, traits;
    /* enum cs_fidelity. */
    uint32_t fidelity;
    /* Checks of `clothsim conform` that the method is known to fail, closed by NULL; or NULL.
     */
    const char *const *fails;

    /* The options: rows over a plain struct, and the size of that struct. */
    const struct cs_option *options;
    uint32_t n_options;
    uint32_t options_size;

    /* [once, first] Takes all memory, and sets *self. options is the filled and range-checked
     * struct, valid only during the call: copy what you need. After a failure destroy is called
     * if *self was set. */
    enum cs_step (*create)(const struct cs_host *host, const void *options, void **self);

    /* [after create; then between two calls of advance] The state, the pins or the forces were
     * changed from outside: at the start, or by an event. Forget all history, and everything
     * that was derived from the view. */
    enum cs_step (*restart)(void *self, double t, const double *x, const double *v);

    /* [after restart, any number of times; t0 is the t1 of the call before] Takes x and v, in
     * place, from t0 to exactly t1, in as many internal steps as the method likes, each of them
     * followed by host->commit. After CS_STEP_BACK restart follows; after anything else but
     * CS_STEP_OK only stats and destroy. */
    enum cs_step (*advance)(void *self, double t0, double t1, double *x, double *v);

    /* [any time after create, between calls and in host->commit] May be NULL. Sets the counts;
     * the fields are 0 before, and out->size is the host's. */
    void (*stats)(const void *self, struct cs_stats *out);

    /* [once, last] Gives back what is not from host->alloc: handles of foreign libraries. May
     * be NULL. self may be half made. */
    void (*destroy)(void *self);

    /* [after restart, between two calls of advance] Where shape matching draws particles that
     * are at x (3,n): g (3,n) in m, with x itself for particles that it leaves alone. It must
     * not change what the method remembers. May be NULL. Later than the first release: the host
     * asks CS_HAS(integrator, goals). */
    void (*goals)(const void *self, const double *x, double *g);

    /* Options that depend on others, and how many; or NULL and 0. Later than the first release:
     * the host asks CS_HAS(integrator, n_uses). */
    const struct cs_option_use *uses;
    uint32_t n_uses;

    /* [after restart, between two calls of advance] What the method remembers from one advance
     * to the next, so that a new object goes on to the same bits: history, next step, counts.
     * save must not change it. load follows a restart at the same time, state and forces, with
     * the same options. Both or neither; without them the method is restarted at each
     * checkpoint, in the unbroken run too. Later than the first release: the host asks
     * CS_HAS(integrator, load). */
    enum cs_step (*save)(void *self, const struct cs_archive *archive);
    enum cs_step (*load)(void *self, const struct cs_archive *archive);

    /* With CS_LIBRARY_BITS: the library and its version, "SUNDIALS 6.4.1", which golden states
     * are kept for; else NULL. Later than the first release: the host asks
     * CS_HAS(integrator, library). */
    const char *library;

    /* Options that were renamed, and how many; or NULL and 0. Options of further series for a
     * comparison of all methods, such as "order=8", closed by NULL; or NULL. The order with
     * these options; NULL: an option "order", or the orders above. The host asks CS_HAS. */
    const struct cs_option_rename *renames;
    uint32_t n_renames;
    const char *const *variants;
    uint32_t (*order_of)(const void *options, bool damped);
};

/* The symbol that a module exports: CS_EXPORT const struct cs_module clothsim_module. */
struct cs_module {
    /* CS_ABI, and sizeof(struct cs_integrator) at the module's build. */
    uint32_t abi, size;
    /* The methods. */
    uint32_t n;
    const struct cs_integrator *const *integrators;
};

#ifdef __cplusplus
}
#endif
#endif
