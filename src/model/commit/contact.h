/* contact.h - projection contact, after each step: what a step has brought behind the surface
 * of an obstacle is put in front of it, and no energy comes of it. */
#ifndef CS_CONTACT_H
#define CS_CONTACT_H

#include "base/record.h"
#include "model/commit/balance.h"
#include "model/commit/stick.h"
#include "model/contact/obstacle.h"

struct cs_contact_counts {
    uint64_t tests, pushed; /* pairs of particle and obstacle */
};

struct cs_contact {
    const struct cs_system *system; /* borrowed */
    struct cs_obstacle *obstacles;  /* (scene->colliders.n) at the time of the commit */
    struct cs_balance balance;
    struct cs_stick stick;
    double *last; /* (6,n) the state that the last commit has left */
    double *to;   /* (6,n) where this one takes it */
    bool *pushed; /* (n) in this commit */
    struct cs_contact_counts counts;
};

/* Takes the arrays from arena, for a scene with colliders. CS_ERR_MEMORY. */
enum cs_status cs_contact_init(struct cs_contact *contact, struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error);

/* The state that the next step starts from. resolved: it is what cs_contact_resolve left. */
void cs_contact_keep(struct cs_contact *contact, const double *x, const double *v,
                     bool resolved);

/* All that one commit leaves to the next, for a checkpoint. */
void cs_contact_record(struct cs_contact *contact, struct cs_record *record);

/* A run starts at (x, v) at t, or starts anew there after an event. */
void cs_contact_start(struct cs_contact *contact, double t, const double *x, const double *v);

/* Decides who is held in the steps that follow (stick.h); true: others than before. */
bool cs_contact_hold(struct cs_contact *contact, double t, const double *x, const double *v);

/* Corrects the state after a step of dt that ended at t: particles that are held go back to
 * where they were (stick.h), each other meets the colliders in the scene's order (touch.h), and
 * no energy comes of it (balance.h). Returns whether the state was changed. */
bool cs_contact_resolve(struct cs_contact *contact, double t, double dt, double *x, double *v);

#endif
