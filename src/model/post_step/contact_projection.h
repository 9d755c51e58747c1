/* contact_projection.h - projection contact, after each step: what a step has brought behind
 * the surface of an obstacle is put in front of it, and no energy comes of it. */
#ifndef CS_CONTACT_PROJECTION_H
#define CS_CONTACT_PROJECTION_H

#include "base/serialise.h"
#include "model/contact/posed_collider.h"
#include "model/post_step/projection_energy.h"
#include "model/post_step/static_friction.h"

struct cs_projection_counts {
    uint64_t tests, projected; /* pairs of particle and obstacle */
};

struct cs_contact_projection {
    const struct cs_system *system;      /* borrowed */
    struct cs_posed_collider *colliders; /* (scene->colliders.n) at the time of the commit */
    struct cs_projection_energy energy_limit;
    struct cs_static_friction static_friction;
    double *state_before; /* (6,n) the state that the last commit has left */
    double *state_after;  /* (6,n) where this one takes it */
    bool *is_pushed;      /* (n) in this commit */
    struct cs_projection_counts counts;
};

/* Takes the arrays from arena, for a scene with colliders. CS_ERR_MEMORY. */
enum cs_status cs_contact_projection_init(struct cs_contact_projection *contact,
                                          struct cs_system *system, struct cs_arena *arena,
                                          struct cs_error *error);

/* The state that the next step starts from. resolved: it is what cs_contact_projection_resolve
 * left. */
void cs_contact_projection_store(struct cs_contact_projection *contact, const double *x,
                                 const double *v, bool resolved);

/* All that one commit leaves to the next, for a checkpoint. */
void cs_contact_projection_serialise(struct cs_contact_projection *contact,
                                     struct cs_serialiser *record);

/* A run starts at (x, v) at t, or starts anew there after an event. */
void cs_contact_start(struct cs_contact_projection *contact, double t, const double *x,
                      const double *v);

/* Decides who is held in the steps that follow (static_friction.h); true: others than before.
 */
bool cs_contact_projection_update_sticking(struct cs_contact_projection *contact, double t,
                                           const double *x, const double *v);

/* Corrects the state after a step of dt that ended at t: particles that are held go back to
 * where they were (static_friction.h), each other meets the colliders in the scene's order
 * (touch.h), and no energy comes of it (projection_energy.h). Returns whether the state was
 * changed. */
bool cs_contact_projection_resolve(struct cs_contact_projection *contact, double t, double dt,
                                   double *x, double *v);

#endif
