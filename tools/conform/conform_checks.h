/* conform_checks.h - shared parts of the checks of a card; each file of checks is a group.
 *
 *   motion    exact motions, oscillators, conserved momenta     conform_motion.c
 *   order     order, tolerance, limit, events                   conform_order.c
 *   forces    each force alone, unequal masses, time            conform_forces.c
 *   exact     polynomials of the time                           conform_exact.c
 *   invariance copies of a body, and the unit of mass          conform_invariance.c
 *   energy    symmetry in time, bounded energy                  conform_motion.c
 *   contact   incline, rest, bounce, impacts, crossings         conform_contact.c
 *   rules     descriptor, imports, commits, pins, failures      conform_rules.c
 *   fidelity  the limit of a method's iterations                conform_order.c
 *   host      memory, threads, cuts, resume                     conform_host.c
 *
 * An error is measured against a closed form, an invariant or the independent method of
 * conform_reference.c. It is never measured against the same method at a smaller step, because
 * a wrong limit would then pass. */
#ifndef CS_CONFORM_CHECKS_H
#define CS_CONFORM_CHECKS_H

#include "base/status.h"
#include "base/text.h"
#include "session/perturb.h"
#include "session/recorded_run.h"
#include "session/session.h"

#include <clothsim/integrator.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A card in the making: the method, its rows, and the statement of a result.
 */

/* X(name, text) of the verdicts on a claim. */
#define CS_VERDICT_LIST(X)                                                                     \
    X(CS_VERDICT_PASS, "pass")                                                                 \
    X(CS_VERDICT_FAIL, "FAIL")                                                                 \
    X(CS_VERDICT_EXPECTED, "expected")                                                         \
    X(CS_VERDICT_STALE, "STALE")                                                               \
    X(CS_VERDICT_NONE, "n/a")
enum cs_verdict {
#define X(name, text) name,
    CS_VERDICT_LIST(X)
#undef X
        CS_VERDICTS
};
/* Text of a verdict in reports. */
const char *cs_verdict_text(enum cs_verdict verdict);

/* Result of one check. */
struct cs_conform_row {
    const char *check; /* its name */
    enum cs_verdict verdict;
    double figure, bound; /* passes where figure <= bound; both NAN: nothing was measured */
    char note[320];       /* what the figure is, or why there is none */
    bool is_guard;        /* of a guard that the method does not claim: may stand in `fails` */
};

struct cs_conform_cache;

/* A card: the tested method, its settings and the counts of verdicts. Pointers are borrowed. */
struct cs_conform {
    const struct cs_integrator *method;
    const void *options; /* filled, before the checks' own; NULL: the defaults */
    /* the method that CS_FIDELITY_IMPLICIT_EULER is compared with; NULL: none */
    const struct cs_integrator *implicit_euler;
    const char *only_checks; /* names with commas between them; NULL: all */
    bool fail_fast;          /* the first failed claim ends the card */
    /* references that earlier cards have run, and where this one's go; NULL: none are kept */
    struct cs_conform_cache *cache;
    /* set where the method refuses a check's scene by CS_SMOOTH_ONLY; set by check */
    bool *refused;
    /* lack of memory, or an interrupt, which is no fault of the method's: it ends the card; set
     * by check */
    struct cs_error *card_error;
    const volatile sig_atomic_t *stop; /* ends the card once it is set; NULL: nothing does */
    /* called before each check; false: the check is left out. May be NULL. */
    bool (*begin)(void *ctx, const char *check);
    /* called after each check */
    void (*report)(void *ctx, const struct cs_conform_row *row);
    void *ctx;
};

/* The order that the method claims with these options. */
static inline uint32_t cs_conform_order(const struct cs_conform *conform, bool damped) {
    return cs_method_order(conform->method, conform->options, damped);
}

/* States a figure that must not exceed its bound; NAN fails. If a check states several, the row
 * keeps the first that fails, else the one that uses most of its bound. */
void cs_row_state(struct cs_conform_row *row, double figure, double bound, const char *format,
                  ...) __attribute__((format(printf, 4, 5)));
/* Marks the check as not applicable, with the reason. */
void cs_row_skip(struct cs_conform_row *row, const char *reason);
/* Marks the check as failed without a figure; an earlier failure stays. */
void cs_row_fail(struct cs_conform_row *row, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Runs a small scene in memory with one method, for one check. */

/* A scene with a method, and how its run ended. Must not move in memory while open. */
struct cs_probe {
    struct cs_session session; /* opened up to the system, the run begun by cs_probe_run */
    size_t n;                  /* particles */
    double *x, *v;             /* (3,n): the state; to be moved before the first frame only */
    double frame;              /* s */
    bool has_ended;            /* blew up or failed: error says how */
    struct cs_error error;
    struct cs_error *card_error; /* of the card */
    char text[4096];             /* the scene */
    bool asks_step_fraction;     /* the method called max_step_fraction */
    struct cs_trace trace;       /* sees that */

    /* called within every commit once it has been done; may be NULL. Moves the state or only
     * looks; returns whether it moved. */
    bool (*on_commit)(struct cs_probe *probe, double t, double dt, double *x, double *v);
    void *on_commit_ctx;
};

/* Reads the scene from printf text and builds it for the given method, of the card or another
 * one. The card's own method gets the card's options. The first body gets shape matching if the
 * method needs clusters. Returns false on failure: the probe has ended and error says why; all
 * further calls then do nothing. cs_probe_close must be called in any case. */
bool cs_probe_open(struct cs_probe *probe, const struct cs_conform *conform,
                   const struct cs_integrator *method, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Closes the session. Lack of memory is passed on to the card, because it is no fault of the
 * method. */
void cs_probe_close(struct cs_probe *probe);

/* True if the method has an option of that name that is a number. */
bool cs_method_has(const struct cs_integrator *method, const char *name);

/* Sets an option to the value, or to the nearest one in its range. Returns false if the method
 * has no such option. */
bool cs_probe_set(struct cs_probe *probe, const char *name, double value);

/* Set the accuracy: `dt` in s, or `rtol` of an adaptive method. Inner tolerances (`rtol` of a
 * fixed step, `linear_rtol`, `newton_rtol`) are set to 1e-12, so the measured error is that of
 * the time integration. `iterations` is set high if the fidelity is CS_FIDELITY_IMPLICIT_EULER.
 * Options that a method lacks are skipped. */
void cs_probe_set_step(struct cs_probe *probe, double dt);
void cs_probe_set_tolerance(struct cs_probe *probe, double rtol);

/* Sets the step as cs_probe_set_step does, or without dt the loosest tolerances, so that a
 * method takes a step a frame: at its claimed order, where that is an option. */
void cs_probe_set_frames(struct cs_probe *probe, double dt);

/* The tolerance at which an adaptive method is compared with the solution. A hundred thousand
 * steps of order 2 are within the bound at a looser tolerance already. */
double cs_probe_tightest_tolerance(const struct cs_conform *conform);

/* True if the accuracy can be set; else the row is skipped. */
bool cs_probe_can_be_set(const struct cs_conform *conform, struct cs_conform_row *row);

/* Sets level 0 or 1 of accuracy: h and h/8, or relative tolerances of 1e-5 and 1e-7. Returns
 * the expected error as a fraction of a motion of rate w (1/s) for a method of that order: (h
 * w)^order, or CS_TOLERANCE_FACTOR times the tolerance. */
double cs_probe_set_level(struct cs_probe *probe, double h, double w, uint32_t order,
                          int level);
/* Allowed ratio of the global error of an adaptive method to its tolerance, which controls the
 * local error of each step only. */
#define CS_TOLERANCE_FACTOR 1000

/* Runs that many frames; begins the run at the first call. Returns false if the run ended
 * early: error says how. */
bool cs_probe_run(struct cs_probe *probe, uint32_t frames);

/* Richardson extrapolation to h = 0. With e(h) = c_p h^p + c_(p+1) h^(p+1) + ..., the
 * combination
 *   S'(h/2) = S(h/2) + (S(h/2) - S(h)) / (2^p - 1)
 * removes the term of h^p; each further column removes the next power. states (levels, stride),
 * of which n values each count, belong to the steps h, h/2, h/4, ... and are overwritten; the
 * last one is the result. */
void cs_extrapolate(double *states, int levels, size_t stride, size_t n, uint32_t order);

/* Returns the kinetic and potential energy in J. */
double cs_probe_energy(const struct cs_probe *probe);

/* The drum: a stretched sheet in a fixed frame, the scene that orders are
 * measured on.
 *
 * A method shows its order only where the force is smooth along the motion: here springs stay
 * stretched by about 5 % and contact, if any, stays in range. */

/* Size of the scene: 7 by 7 particles, with pinned edges. */
enum { CS_DRUM_FRAMES = 3, CS_DRUM_PARTICLES = 49, CS_DRUM_VALUES = 3 * CS_DRUM_PARTICLES };
#define CS_DRUM_FRAME 0.1 /* s */
#define CS_DRUM_OMEGA 70  /* 1/s, near the bound on its frequencies */

/* Variant of the drum. Zeroed: undamped, free, by the method's own choice of steps. */
struct cs_drum {
    double damping;         /* N s/m, axial */
    bool fixed_steps;       /* steps of a given length, also of a method that can choose its
                               own: by dt, or by frames of one step at its loosest tolerance */
    bool has_velocity_jump; /* all velocities are turned and halved at the end of the first
                               frame */
    bool has_contact;       /* a plane behind it is always in range, with friction */
};

/* Returns the longest step in s that orders are measured from: the largest whole part of a
 * frame with h CS_DRUM_OMEGA <= 1/4. */
double cs_drum_step(void);

/* Opens the scene; the accuracy must still be set. Returns false if it cannot be opened:
 * probe->error says why. cs_probe_close must be called in any case. */
bool cs_drum_open(struct cs_probe *probe, const struct cs_conform *conform,
                  const struct cs_integrator *method, const struct cs_drum *drum);

/* Runs the given method, of the card or another one, over CS_DRUM_FRAMES. step_or_rtol: the
 * step in s, a whole part of a frame, or the tolerance of an adaptive method unless
 * drum->fixed_steps. state: (2, CS_DRUM_VALUES), positions then velocities at the end. Returns
 * false if the run ended early, or took more steps than the given length asks for: the row says
 * why. */
bool cs_drum_state(const struct cs_conform *conform, const struct cs_integrator *method,
                   const struct cs_drum *drum, double step_or_rtol, double *state,
                   struct cs_conform_row *row);

/* Reference state at the end, from the cache or by a run. scale: root mean square of its
 * displacement (m) and of its change of velocity (m/s) since the start, which make errors
 * relative. Returns false if there is none: the row says why. */
bool cs_drum_reference(const struct cs_conform *conform, const struct cs_drum *drum,
                       double *state, double scale[2], struct cs_conform_row *row);

/* CS_CONFORM_SPRINGS: the check compares with the motion of springs, which a method of another
 * model (CS_FIDELITY_OTHER) does not follow. It is skipped for such a method. */
enum cs_conform_of { CS_CONFORM_ANY, CS_CONFORM_SPRINGS };

/* X(name, function, of, what it shows), in the order of the card */
#define CS_CONFORM_LIST(X)                                                                     \
    X("abi", abi, ANY, "descriptor within the contract")                                       \
    X("imports", imports, ANY, "no clock, environment, random numbers, files or threads")      \
    X("options", options, ANY, "every option at the ends of its range")                        \
    X("free-fall", free_fall, ANY, "a sheet falls straight, at its method's order")            \
    X("translation", translation, ANY, "a uniform velocity changes nothing else")              \
    X("copies", copies, ANY, "equal sheets of 513 particles move alike")                       \
    X("units", units, ANY, "masses and forces a million times change nothing")                 \
    X("polynomials", polynomials, ANY, "motions that its order makes exact, by gravity")       \
    X("order-conditions", order_conditions, ANY, "and by one particle that pulls the next")    \
    X("rotation", rotation, SPRINGS, "a stretched pair turns on its circle")                   \
    X("commit", commit, ANY, "every step is committed, and they fill the time")                \
    X("momentum", momentum, ANY, "momentum is conserved without external forces")              \
    X("angular-momentum", angular_momentum, ANY, "angular momentum is conserved too")          \
    X("oscillator-axial", oscillator_axial, SPRINGS,                                           \
      "axially damped pair against its closed form")                                           \
    X("oscillator-relative", oscillator_relative, SPRINGS, "the same with relative damping")   \
    X("force-gravity", force_gravity, ANY, "motion under gravity alone")                       \
    X("force-springs", force_springs, SPRINGS, "under stretch, shear and bend springs, each")  \
    X("force-damping", force_damping, SPRINGS, "under axial and relative dampers, each")       \
    X("force-membrane", force_membrane, SPRINGS, "under a membrane, without and with damping") \
    X("force-bending", force_bending, SPRINGS, "under bending")                                \
    X("force-drag", force_drag, ANY, "under drag of each particle, and by area")               \
    X("force-wind", force_wind, ANY, "under wind on each particle, and by area")               \
    X("force-push", force_push, ANY, "under impacts and viewpoint forces")                     \
    X("force-contact", force_contact, ANY, "near a collider, by contact.law force")            \
    X("unequal-masses", unequal_masses, ANY, "under all forces, with unequal masses")          \
    X("mixed-laws", mixed_laws, SPRINGS, "a membrane, springs, a seam, air and contact")       \
    X("time-dependence", time_dependence, ANY, "forces that change with time are followed")    \
    X("stage-times", stage_times, ANY, "at the method's own order")                            \
    X("order", order, SPRINGS, "order on the drum without damping")                            \
    X("order-damped", order_damped, SPRINGS, "order on the damped drum")                       \
    X("solution", solution, SPRINGS, "the limit is the solution of the equation of motion")    \
    X("tolerance", tolerance, SPRINGS, "achieved error against the requested tolerance")       \
    X("event", event, SPRINGS, "order through a change of the state at a known time")          \
    X("reversible", reversible, ANY, "forwards, reversed, and back to the start")              \
    X("energy", energy, SPRINGS, "no energy is gained; bounded where symplectic")              \
    X("contact-order", contact_order, SPRINGS,                                                 \
      "order, or tolerance, in contact with friction")                                         \
    X("contact-incline", contact_incline, ANY,                                                 \
      "a block slides and creeps as the law predicts")                                         \
    X("contact-rest", contact_rest, SPRINGS, "a sheet comes to rest on a floor")               \
    X("contact-energy", contact_energy, SPRINGS, "no energy is gained in a bounce")            \
    X("restitution", restitution, SPRINGS,                                                     \
      "the energy kept by impacts at the method's own step")                                   \
    X("crossing", crossing, SPRINGS, "a step that would pass through a surface is cut")        \
    X("pins", pins, ANY, "pinned particles keep their bits")                                   \
    X("not-finite", not_finite, ANY, "non-finite numbers are reported")                        \
    X("failed-solve", failed_solve, ANY, "a linear solve that fails ends the run")             \
    X("allocation", allocation, ANY, "no memory is allocated in a step")                       \
    X("same-bits", same_bits, ANY, "two runs, one result, also a second later")                \
    X("fidelity", fidelity, ANY, "the limit of the iterations is the stated one")              \
    X("threads", threads, ANY, "the same bits for all thread counts")                          \
    X("cuts", cuts, ANY, "the same bits however parallel_for cuts its items")                  \
    X("resume", resume, ANY, "a resumed run equals the uninterrupted one")
#define X(name, function, of, what)                                                            \
    void cs_check_##function(const struct cs_conform *conform, struct cs_conform_row *row);

CS_CONFORM_LIST(X)
#undef X

/* Stores reference states, shared by the cards of several methods.
 *
 * A reference does not depend on the tested method, so one run of each serves all cards that a
 * command makes. */

struct cs_conform_cached;

/* Empty when zeroed. */
struct cs_conform_cache {
    struct cs_conform_cached *first; /* owned */
};

/* Returns the n values stored under that name, which the cache owns, or NULL if there are none,
 * if their number differs, or without a cache. */
const double *cs_conform_cache_find(const struct cs_conform_cache *cache, const char *name,
                                    size_t n);

/* Stores a copy under that name. Without a cache or out of memory nothing is stored, and the
 * next card runs the reference again: therefore there is no error. */
void cs_conform_cache_store(struct cs_conform_cache *cache, const char *name,
                            const double *values, size_t n);

/* Frees all values; the cache is then empty. */
void cs_conform_cache_finish(struct cs_conform_cache *cache);

/* The method whose solution orders and errors are measured against. */

/* Looks for the first symbol that the module around an address takes from elsewhere and that is
 * in the list (closed by NULL; a name that ends in * is the begin of names). Returns its name,
 * the module's own, in *symbol, or NULL if there is none. Returns false if the address is in no
 * module, but in the program itself. The module's libraries are not looked at. */
bool cs_module_find_import(const void *address, const char *const *names, const char **symbol);

/* The classical Runge-Kutta method of order 4 with option dt, for tiny steps. Independent of
 * the modules, so no module is compared with itself. */
extern const struct cs_integrator cs_conform_reference;

/* Scenes in which one force acts alone, and scenes whose forces change with
 * time. */

/* One scene of a force check. */
struct cs_force_scene {
    const char *check;       /* of the card, that runs it */
    const char *description; /* for the note: the force and how it acts */
    const char *json;
    double rate; /* 1/s, of the fastest change: that of an oscillation or a decay, or the
                    inverse of the time over which a force builds up motion */
    bool depends_on_velocity; /* some force depends on the velocity: the order with damping
                                 holds */
    bool deforms; /* bodies change their shape: no scene for a method of another model */
};

/* Every scene runs CS_FORCE_FRAMES frames of CS_FORCE_FRAME, and has at most
 * CS_FORCE_PARTICLES particles. */
enum { CS_FORCE_FRAMES = 5, CS_FORCE_PARTICLES = 21, CS_FORCE_VALUES = 3 * CS_FORCE_PARTICLES };

#define CS_FORCE_FRAME 0.1 /* s */

/* The table of scenes (cs_n_force_scenes); several scenes can belong to one check. */
extern const struct cs_force_scene cs_force_scenes[];
extern const uint32_t cs_n_force_scenes;

#endif
