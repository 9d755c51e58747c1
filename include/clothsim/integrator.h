/* integrator.h - the one contract between clothsim and an integrator module.
 *
 * A module is a shared object that exports ONE symbol, `clothsim_module`. It links against
 * nothing of clothsim: all it may ask for comes through struct cs_host.
 *
 * Units are SI. State is one array of 6n doubles, component-major: x (3,n), then v (3,n), so
 * that v == x + 3n always holds and a solver may wrap x as a single vector of 6n.
 * Equation of motion: M dv/dt = f(t,x,v), dx/dt = v. Pinned particles have inv_mass = 0 and
 * zero rows in f and df, so that no method needs a special case. Their v is 0, or that of the
 * path along which the scene moves them. It is constant from one restart to the next, and they
 * are at x + h v after a step h: commit puts them there to the last bit, which is no change to
 * speak of.
 *
 * A scene's events lie between two calls of advance. There x, v, view->mass, view->inv_mass
 * and the springs' constants may change, in place; restart follows. view->omega and view->delta
 * hold for all of the run. Within an advance forces may depend on t (ramps are linear in it),
 * and the list of springs is that of the t which the last call named; a matrix that a method
 * keeps is not.
 *
 * Marks in brackets say when a call is allowed. Not on offer, on purpose: random numbers,
 * clock, files, threads of one's own: vector->share lends the host's for a loop.
 */
#ifndef CLOTHSIM_INTEGRATOR_H
#define CLOTHSIM_INTEGRATOR_H

#include <clothsim/option.h>
#include <clothsim/system.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CS_ABI          1u /* raised whenever a struct changes other than by growing at its end */
#define CS_EXPORT       __attribute__((visibility("default")))
#define CS_PRINTF(a, b) __attribute__((format(printf, a, b)))

enum cs_step {
    CS_STEP_OK,
    CS_STEP_HALT, /* commit said stop (blow-up, interrupt, budget): return it upwards at once */
    CS_STEP_FAIL  /* the reason was given to host->fail */
};

/* What the host must build; what no one asks for costs nothing. A call without its need
 * is refused with CS_STEP_FAIL or leaves its output untouched. */
enum cs_need {
    CS_NEED_JVP = 1u << 0,
    CS_NEED_DIAGONAL = 1u << 1,
    CS_NEED_ENERGY = 1u << 2,
    CS_NEED_SPRINGS = 1u << 3,
    CS_NEED_SOLVE = 1u << 4,
    CS_NEED_CLUSTERS = 1u << 5 /* and without groups that keep their shape there is no run */
};

/* Parts of the force, so that a method can split it.
 *
 * `parts` of force and jvp is a set of these bits, and the sum is that of the forces in the
 * set. Some forces have a bit of their own. All others share three bits, by what they are, so
 * that a force which is new to the program is right in every method, also in a module that was
 * built before. A method should therefore name forces by the masks below, and take `all except`
 * as CS_PART_ALL & ~mask: a list of bits of its own would leave out what it does not know. */
enum cs_part {
    /* Forces with a bit of their own. */
    CS_PART_STRETCH = 1u << 0, /* springs along the threads; edges of a mesh */
    CS_PART_SHEAR = 1u << 1,   /* springs across the cells; inside a mesh */
    CS_PART_BEND = 1u << 2,    /* springs over two cells; across the edges of a mesh */
    CS_PART_DAMPING = 1u << 3, /* the dampers beside the springs */
    CS_PART_GRAVITY = 1u << 4, /* m g: has an energy, and no derivative */
    CS_PART_DRAG = 1u << 5,    /* -c v of still air */
    CS_PART_WIND = 1u << 6,    /* pressure on the cloth; has a jvp, is not in the matrix */

    /* All others, by what they are. */
    CS_PART_POTENTIAL = 1u << 7,   /* minus the slope of an energy; in the matrix */
    CS_PART_DISSIPATIVE = 1u << 8, /* against a velocity; no energy, in the matrix */
    CS_PART_EXTERNAL = 1u << 9, /* neither energy nor in the matrix: impacts, viewpoint forces */

    /* The elastic springs, and those with their dampers. */
    CS_PART_SPRINGS = CS_PART_STRETCH | CS_PART_SHEAR | CS_PART_BEND,
    CS_PART_DAMPED_SPRINGS = CS_PART_SPRINGS | CS_PART_DAMPING,

    /* What host->energy holds beside the kinetic energy. The rest does work that no energy
     * knows of: a line search on the energy takes it as constant. */
    CS_PART_WITH_ENERGY = CS_PART_SPRINGS | CS_PART_GRAVITY | CS_PART_POTENTIAL,

    /* What can limit the step of an explicit method. */
    CS_PART_STIFF = CS_PART_DAMPED_SPRINGS | CS_PART_POTENTIAL | CS_PART_DISSIPATIVE,

    /* What host->solve and host->diagonal hold: what can be stiff, and drag. */
    CS_PART_LINEARISED = CS_PART_STIFF | CS_PART_DRAG,

    /* What moves a free body as a whole, neither stiffness nor damping: m g, and impacts. */
    CS_PART_FREE_FALL = CS_PART_GRAVITY | CS_PART_EXTERNAL,

    /* Every force, also those of later hosts. */
    CS_PART_ALL = 0x7fffffff,

    /* All but springs and dampers: for methods with a spring model of their own. */
    CS_PART_OUTER = CS_PART_ALL & ~CS_PART_DAMPED_SPRINGS,
    CS_PART_WITHOUT_ENERGY = CS_PART_ALL & ~CS_PART_WITH_ENERGY
};

/* What is true of the method: shown and tested, never guessed. */
enum cs_trait {
    CS_IMPLICIT = 1u << 0,
    CS_ADAPTIVE = 1u << 1,
    CS_MULTISTEP = 1u << 2,
    CS_SYMPLECTIC = 1u << 3,
    CS_LIBRARY_BITS = 1u << 4, /* same bits only with the same build of a foreign library */
    CS_NOT_GALILEAN = 1u << 5  /* a uniform velocity changes the internal forces */
};

/* What the method's result is, however small its own tolerances are. */
enum cs_fidelity {
    CS_FIDELITY_ODE,            /* converges to the equation of motion at its order */
    CS_FIDELITY_IMPLICIT_EULER, /* one implicit Euler step as its iterations grow */
    CS_FIDELITY_CONSISTENT,     /* meets the equation of motion only as the step goes to 0 */
    CS_FIDELITY_OTHER           /* another model: no error against the equation of motion */
};

enum cs_solve_flag {
    CS_SOLVE_PSD =
        1u << 0 /* drop the transverse part of compressed springs (Teran et al. 2005) */
};

struct cs_host {
    uint32_t size;              /* sizeof at the host's build; test before a late field */
    void *ctx;                  /* first argument of every call below */
    const struct cs_view *view; /* valid until destroy returns */
    const struct cs_vector_kernels *vector;

    /* [create] Zeroed, 64-byte aligned, freed by the host after destroy. NULL: already
     * reported. */
    void *(*alloc)(void *ctx, size_t bytes);
    /* [create, restart, advance] Keeps the first message; returns CS_STEP_FAIL. */
    enum cs_step (*fail)(void *ctx, const char *format, ...) CS_PRINTF(2, 3);
    /* [create, restart, advance] A remark for the report; a repeated one is kept once. */
    void (*note)(void *ctx, const char *format, ...) CS_PRINTF(2, 3);

    /* [restart, advance] f (3,n) in N, the sum of the chosen parts: overwritten. */
    void (*force)(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                  double *f);
    /* [restart, advance] Kinetic + potential energy in J. Needs CS_NEED_ENERGY. */
    double (*energy)(void *ctx, double t, const double *x, const double *v);
    /* [restart, advance] df (3,n) = (df/dx) dx + (df/dv) dv of the chosen parts, exact. Either
     * direction may be NULL. Needs CS_NEED_JVP. */
    void (*jvp)(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                const double *dx, const double *dv, double *df);
    /* [restart, advance] The own 3x3 blocks of the particles, kxx = df_i/dx_i and dvv =
     * df_i/dv_i of CS_PART_LINEARISED, each (6,n) component-major: xx, xy, xz, yy, yz, zz.
     * Needs CS_NEED_DIAGONAL. */
    void (*diagonal)(void *ctx, double t, const double *x, const double *v, double *kxx,
                     double *dvv);
    /* [advance] The host's own linear solver, so that methods are compared and not solvers:
     * prepare A = cm M + cd df/dv + ck df/dx of CS_PART_LINEARISED at (t, x, v) (backward Euler
     * is 1, -h, -h h), then solve A u = b for as many b as wanted to relative residual rtol.
     * u (3,n) is the start of the iteration and its result; rows of pinned particles become 0.
     * The position derivative of axial damping is left out of A (it is not symmetric).
     * Needs CS_NEED_SOLVE. Without CS_SOLVE_PSD an indefinite A falls back to it, counted. */
    enum cs_step (*solve_setup)(void *ctx, double t, const double *x, const double *v,
                                double cm, double cd, double ck, uint32_t flags);
    enum cs_step (*solve)(void *ctx, const double *b, double rtol, double *u);
    /* [advance] y (3,n) = A p with the A of the last solve_setup; rows of pinned particles
     * become 0. Counted as a Jacobian product. */
    void (*apply)(void *ctx, const double *p, double *y);

    /* [advance] MUST follow every accepted internal step of length dt that ended at time t:
     * strain limit, contact, velocity loss, blow-up test, counting. May move x and v; then
     * *changed is true and a method that keeps history starts anew. */
    enum cs_step (*commit)(void *ctx, double t, double dt, double *x, double *v, bool *changed);
};

/* What the host cannot count itself. */
struct cs_stats {
    uint32_t size;
    uint64_t rejected; /* steps thrown away */
    uint64_t newton;   /* nonlinear iterations */
    uint64_t setups;   /* linear solver set-ups asked for by a library */
};

struct cs_integrator {
    uint32_t size;
    const char *name;      /* [a-z0-9-]+, e.g. "implicit-block" */
    const char *summary;   /* one line for `clothsim integrators` */
    const char *source;    /* where the method was published */
    uint32_t order;        /* on smooth scenes without damping; measured by the tests */
    uint32_t order_damped; /* on smooth scenes with velocity-dependent forces */
    uint32_t needs, traits;
    uint32_t fidelity; /* enum cs_fidelity */
    /* checks of `clothsim conform` that the method is known to fail, closed by NULL; or NULL */
    const char *const *fails;
    const struct cs_option *options;
    uint32_t n_options;
    uint32_t options_size; /* sizeof the struct that the table describes */

    /* options: the filled, range-checked struct, valid only during the call: copy what you
     * need. All memory is taken here. On failure *self may be set, and destroy is called with
     * it. */
    enum cs_step (*create)(const struct cs_host *host, const void *options, void **self);
    /* The state, the pins or the forces were changed from outside (first frame, event): forget
     * all history, and what was derived from the view. */
    enum cs_step (*restart)(void *self, double t, const double *x, const double *v);
    /* From t0 to exactly t1 in as many internal steps as the method likes. In place. */
    enum cs_step (*advance)(void *self, double t0, double t1, double *x, double *v);
    void (*stats)(const void *self, struct cs_stats *out); /* may be NULL */
    void (*destroy)(void *self); /* only foreign handles; may be NULL; self may be half made */

    /* Later than ABI 1's first release: read only where `size` reaches behind it. May be NULL.
     * Between two calls of advance: g (3,n) in m, the places that the method draws particles
     * to when they are at x (3,n); x itself for those that it leaves alone. */
    void (*goals)(const void *self, const double *x, double *g);
};

struct cs_module {
    uint32_t abi;  /* CS_ABI */
    uint32_t size; /* sizeof(struct cs_integrator) at the module's build */
    uint32_t n;
    const struct cs_integrator *const *integrators; /* (n) */
};

#ifdef __cplusplus
}
#endif
#endif
