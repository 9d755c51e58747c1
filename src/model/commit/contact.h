/* contact.h - projection contact, after each step: what a step has brought behind the surface
 * of an obstacle is put in front of it, and no energy comes of it. */
#ifndef CS_CONTACT_H
#define CS_CONTACT_H

#include "base/record.h"
#include "model/commit/response.h"
#include "model/contact/obstacle.h"

struct cs_contact_counts {
    uint64_t tests, pushed; /* pairs of particle and obstacle */
    uint64_t shortened;     /* commits in which pushes were cut to the energy that was there */
};

/* J: of all kinds, and the sum of their sizes, by which rounding is judged. */
struct cs_contact_energy {
    double whole, size;
};

struct cs_contact {
    const struct cs_system *system; /* borrowed */
    struct cs_obstacle *obstacles;  /* (scene->colliders.n) at the time of the commit */
    struct cs_response response;
    double *last;                    /* (6,n) the state that the last commit has left */
    double *to;                      /* (6,n) where this one takes it */
    double *move;                    /* (3,n) work */
    bool *pushed;                    /* (n) in this commit */
    double depth, fresh;             /* m, sums over the particles pushed in this commit */
    double weight;                   /* J */
    double rate;                     /* 1/s, velocity that a response gives for its way */
    struct cs_contact_energy energy; /* of `last` */
    double most;          /* J: what there was before anything touched, or was added since */
    bool known, touching; /* energy is that of `last`; the last commit has pushed */
    struct cs_contact_counts counts;
};

/* Takes the arrays from arena, for a scene with colliders. CS_ERR_MEMORY. */
enum cs_status cs_contact_init(struct cs_contact *contact, const struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error);

/* Bytes that init takes, of a scene with n particles; forced: forces have blocks of their own
 * in the solver's matrix. */
size_t cs_contact_bytes(const struct cs_scene *scene, size_t n, size_t n_springs, bool forced);

/* The state that the next step starts from. resolved: it is what cs_contact_resolve left. */
void cs_contact_keep(struct cs_contact *contact, const double *x, const double *v,
                     bool resolved);

/* All that one commit leaves to the next, for a checkpoint. */
void cs_contact_record(struct cs_contact *contact, struct cs_record *record);

/* Corrects the state after a step of dt that ended at t: each particle meets the colliders in
 * the scene's order (touch.h). Returns whether any was pushed.
 *
 * A push of depth d on a particle of stiffness K adds K d^2 / 2 to the springs, while the
 * velocity that it takes away held m (d / dt)^2 / 2: dt^2 K / m times less. So the energy after
 * a commit is held at or below the larger of what there was before the push, and of what the
 * commit before has left with a hundredth of what was lost since the first touch:
 *   1. the pushes alone, where they keep to it;
 *   2. else the body gives way to them as in an implicit step (response.h), and takes over the
 *      velocity of the part that the last step has added;
 *   3. else a share of it, by bisection; the rest is pushed in later commits. Velocities never
 *      point inwards.
 * Obstacles that move do work beside that. */
bool cs_contact_resolve(struct cs_contact *contact, double t, double dt, double *x, double *v);

#endif
