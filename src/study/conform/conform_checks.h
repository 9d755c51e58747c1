/* conform_checks.h - lists the checks of a card; each file of checks is a group.
 *
 *   motion    exact motions and conserved momenta               conform_motion.c
 *   order     oscillators, order, tolerance, limit, events      conform_order.c
 *   forces    each force alone, unequal masses, time            conform_forces.c
 *   energy    symmetry in time, bounded energy                  conform_motion.c
 *   contact   incline, rest, bounce, impacts, crossings         conform_contact.c
 *   rules     descriptor, imports, commits, pins, failures      conform_rules.c
 *   fidelity  the limit of a method's iterations                conform_fidelity.c
 *   host      memory, threads, cuts, resume                     conform_host.c
 *
 * An error is measured against a closed form, an invariant or the independent method of
 * conform_checks.h. It is never measured against the same method at a smaller step, because
 * a wrong limit would then pass. */
#ifndef CS_CONFORM_CHECKS_H
#define CS_CONFORM_CHECKS_H

#include "study/conform/conform_card.h"

#include <clothsim/integrator.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
    void cs_check_##function(const struct cs_conform *card, struct cs_conform_row *row);

CS_CONFORM_LIST(X)
#undef X

/* Stores reference states, shared by the cards of several methods.
 *
 * A reference does not depend on the tested method, so one run of each serves all cards that a
 * command makes. */

struct cs_conform_kept;

/* Empty when zeroed. */
struct cs_conform_cache {
    struct cs_conform_kept *first; /* owned */
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
enum { CS_FORCE_FRAMES = 5, CS_FORCE_PARTICLES = 18, CS_FORCE_VALUES = 3 * CS_FORCE_PARTICLES };

#define CS_FORCE_FRAME 0.1 /* s */

/* The table of scenes (cs_n_force_scenes); several scenes can belong to one check. */
extern const struct cs_force_scene cs_force_scenes[];
extern const uint32_t cs_n_force_scenes;

#endif
