/* contact_projection.h - contact by projection: after each step, particles behind the surface
 * of a collider are moved onto it, without adding energy.
 *
 * Order of one commit:
 *
 * 1. particles pinned by static friction return to their positions (static_friction.h);
 * 2. every other free particle is projected against each collider in the scene's order
 *    (project_particle.h), each after the one before;
 * 3. if any was pushed, the energy of the result is limited (projection_energy.h);
 * 4. later in the commit, static friction decides which particles stick in the steps to come.
 */
#ifndef CS_CONTACT_PROJECTION_H
#define CS_CONTACT_PROJECTION_H

#include "base/serialise.h"
#include "model/contact/posed_collider.h"
#include "model/post_step/projection_energy.h"
#include "model/post_step/static_friction.h"

/* Numbers of pairs of a particle and a collider over the whole run: tested, and projected. */
struct cs_projection_counts {
    /* pairs of a particle and a collider */
    uint64_t tests, projected;
};

/* State of contact by projection between commits, and work arrays. */
struct cs_contact_projection {
    const struct cs_system *system; /* borrowed */
    /* (scene->colliders.n) poses at the time of the commit */
    struct cs_posed_collider *colliders;
    struct cs_projection_energy energy_limit;
    struct cs_static_friction static_friction;
    /* (6,n) x and v that the last commit left, in m and m/s */
    double *state_before;
    /* (6,n) x and v that the current commit makes of the step */
    double *state_after;
    /* (n) pushed, or held by static friction, in the current commit */
    bool *is_pushed;
    struct cs_projection_counts counts;
};

/* Prepares contact by projection for a scene with colliders; the arena owns the arrays.
 * CS_ERR_MEMORY. */
enum cs_status cs_contact_projection_init(struct cs_contact_projection *contact,
                                          struct cs_system *system, struct cs_arena *arena,
                                          struct cs_error *error);

/* Stores the state (x, v) that the next step starts from. resolved: it is what
 * cs_contact_projection_resolve left, and its energy is therefore known. */
void cs_contact_projection_store(struct cs_contact_projection *contact, const double *x,
                                 const double *v, bool resolved);

/* Reads or writes all that one commit leaves to the next, for a checkpoint. */
void cs_contact_projection_serialise(struct cs_contact_projection *contact,
                                     struct cs_serialiser *record);

/* Starts a run at (x, v) at t, or restarts it there after an event. */
void cs_contact_start(struct cs_contact_projection *contact, double t, const double *x,
                      const double *v);

/* Decides which particles stick in the following steps (static_friction.h). Returns whether
 * others do than before. */
bool cs_contact_projection_update_sticking(struct cs_contact_projection *contact, double t,
                                           const double *x, const double *v);

/* Corrects the state after a step of dt seconds that ended at t: steps 1 to 3 above. Returns
 * whether the state was changed. */
bool cs_contact_projection_resolve(struct cs_contact_projection *contact, double t, double dt,
                                   double *x, double *v);

#endif
