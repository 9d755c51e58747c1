/* static_friction.h - static friction: particles on a collider at rest are pinned until their
 * load leaves the friction cone.
 *
 * Projection after a step cannot hold a particle by itself. Within the step it would fall, its
 * springs would follow, and whatever a method remembers of the fall would return in later
 * steps. So a particle that a commit has stopped completely takes no part in the next
 * steps (cf. the constraints of Baraff, Witkin 1998, sec. 5), as long as
 *
 *   N > 0 and |T| <= mu N
 *
 * with N and T the load along the inward normal and across it. The load is the force at the end
 * of the step, plus, for a pinned particle, m dx/dt^2 from the displacement dx that
 * cs_static_friction_restore took back.
 *
 * States of a particle and their transitions, once per commit:
 *
 *   free     -> resting    projection stops it (CS_PROJECT_STUCK)
 *   resting  -> sticking   its load is inside the cone
 *   resting  -> free       its load is outside, or the push was cut short
 *   sticking -> sticking   its load is inside the cone
 *   sticking -> free       its load is outside
 *
 * Resting lasts within a commit only; sticking is the state between commits. */
#ifndef CS_STATIC_FRICTION_H
#define CS_STATIC_FRICTION_H

#include "base/arena.h"
#include "base/serialise.h"
#include "model/system/particle_system.h"

struct cs_posed_collider;

/* Temporary pins, in addition to those of the scene and its events.
 *
 * While they are set, pinned particles have inverse mass 0 and are in the system's list of
 * pins, so that forces, solvers and preconditioners treat them like permanent ones. */

/* A replacement of the system's list of pins. */
struct cs_temporary_pins {
    struct cs_system *system; /* borrowed: inv_mass and the list of pins are changed */
    /* (n) pins of the system and temporary ones */
    uint32_t *list;
    uint32_t *scene_list,
        n_scene_list; /* the system's list, kept; NULL while it has that one */
};

/* Allocates the list in the arena. CS_ERR_MEMORY. */
enum cs_status cs_temporary_pins_init(struct cs_temporary_pins *pins, struct cs_system *system,
                                      struct cs_arena *arena, struct cs_error *error);

/* Pins the particles marked in marks (n); none of them may be pinned already. */
void cs_temporary_pins_set(struct cs_temporary_pins *pins, const bool *marks);

/* Restores masses and list for the same marks; does nothing if no pins are set. */
void cs_temporary_pins_clear(struct cs_temporary_pins *pins, const bool *marks);

/* State of static friction; borrowed or owned by the arena. */
struct cs_static_friction {
    struct cs_system *system; /* borrowed */
    struct cs_temporary_pins pins;
    /* (n) number of the collider that it rests on, plus 1; 0: none */
    uint32_t *resting_on;
    /* (n) pinned by static friction */
    bool *is_sticking;
    /* (3,n) N, m dx/dt^2 of sticking particles in the last step */
    double *load;
    /* number of sticking particles */
    uint32_t n_sticking;
    /* the method has other forces than the system, so that loads are unknown */
    bool disabled;
};

/* Prepares the arrays, which the arena owns; nobody sticks. CS_ERR_MEMORY. */
enum cs_status cs_static_friction_init(struct cs_static_friction *friction,
                                       struct cs_system *system, struct cs_arena *arena,
                                       struct cs_error *error);

/* Pins the sticking particles before a step, if held, and unpins them after it: they are free
 * for the rest of the commit and for all that reads the state. */
void cs_static_friction_pin(struct cs_static_friction *friction, bool held);

/* Moves the sticking particles back to their positions in `last` (3,n), at rest, and records
 * the load of the step of dt seconds. Returns whether one had moved. */
bool cs_static_friction_restore(struct cs_static_friction *friction, double dt,
                                const double *last, double *x, double *v);

/* Clears resting_on of all particles that do not stick: the push of this commit was cut short.
 */
void cs_static_friction_reject(struct cs_static_friction *friction);

/* Decides at (x, v) at t which particles stick from now on, among those that stick or rest. f
 * (3,n) is work. Returns whether others do than before. */
bool cs_static_friction_update(struct cs_static_friction *friction,
                               const struct cs_posed_collider *colliders, double t,
                               const double *x, const double *v, double *f);

/* The same at the start of a run or after an event, for particles at rest on a surface. */
void cs_static_friction_start(struct cs_static_friction *friction,
                              const struct cs_posed_collider *colliders, double t,
                              const double *x, const double *v, double *f);

/* Releases all particles: the state or the system was changed from outside. */
void cs_static_friction_clear(struct cs_static_friction *friction);

/* Reads or writes what it leaves to the next commit, for a checkpoint. */
void cs_static_friction_serialise(struct cs_static_friction *friction,
                                  struct cs_serialiser *serialiser);

#endif
