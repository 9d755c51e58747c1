/* contact_projection.h - contact by projection: after each step, particles behind the surface
 * of a collider are moved onto it, without adding energy.
 *
 * Order of one commit:
 *
 * 1. particles pinned by static friction return to their positions (static_friction.h);
 * 2. every other free particle is projected against each collider in the scene's order
 *    (contact_projection.h), each after the one before;
 * 3. if any was pushed, the energy of the result is limited (projection_energy.h);
 * 4. later in the commit, static friction decides which particles stick in the steps to come.
 */
#ifndef CS_CONTACT_PROJECTION_H
#define CS_CONTACT_PROJECTION_H

#include "base/serialise.h"
#include "model/post_step/projection_energy.h"
#include "model/post_step/static_friction.h"
#include "model/system/particle_system.h"

/* Numbers of pairs of a particle and a collider over the whole run: tested, and projected. */
struct cs_projection_counts {
    /* pairs of a particle and a collider */
    uint64_t tests, projected;
};

/* Steps are cut where projection leaves a particle deeper than this fraction of the scene's
 * size: half of what a run warns of, since later steps may add to it. */
#define CS_PROJECTION_DEPTH 5e-4
/* Parts of a frame down to which steps are cut. */
enum { CS_PROJECTION_PARTS = 64 };

/* How steps are cut; part of a checkpoint. */
struct cs_projection_cut {
    double t;       /* s, where the next step begins */
    double depth;   /* m, largest of a particle in a collider there */
    double longest; /* s, longest step; HUGE_VAL: any */
    double tight;   /* s, the last time that more than little stayed inside, or a refusal */
    double vain;    /* m, depth that shorter steps do not lift; 0: none */
};

/* State of contact by projection between commits, and work arrays. */
struct cs_contact_projection {
    const struct cs_system *system; /* borrowed */
    /* (scene->colliders.n) poses at the time of the commit, and at the start of its step; the
     * same array if no collider moves */
    struct cs_posed_collider *colliders, *colliders_before;
    /* m, the least inner radius of a collider: a shorter way passes none */
    double shortest_tunnel;
    /* steps may be so long that particles pass a collider */
    bool limits_steps;
    struct cs_projection_energy energy_limit;
    struct cs_static_friction static_friction;
    /* (6,n) x and v that the last commit left, in m and m/s */
    double *state_before;
    /* (6,n) x and v that the current commit makes of the step */
    double *state_after;
    /* (n) pushed, or held by static friction, in the current commit */
    bool *is_pushed;
    struct cs_projection_counts counts;
    double depth_max; /* m, of a particle in a collider that no step is cut for; the host's */
    struct cs_projection_cut cut;
    struct cs_projection_memory memory_before; /* of the energy, before the current commit */
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
                                     struct cs_serialiser *serialiser);

/* Starts a run at (x, v) at t, or restarts it there after an event. */
void cs_contact_start(struct cs_contact_projection *contact, double t, const double *x,
                      const double *v);

/* Corrects the state after a step of dt seconds that ended at t: steps 1 to 3 above. Returns
 * whether the state was changed. */
bool cs_contact_projection_resolve(struct cs_contact_projection *contact, double t, double dt,
                                   double *x, double *v);

/* Judges what cs_contact_projection_resolve made of a step of dt seconds that ended at t.
 * Returns true if it leaves a particle too deep that was not so deep before, and is not of the
 * shortest: it must be taken again from contact->state_before, at contact->cut.t, in shorter
 * steps. */
bool cs_contact_projection_refuses(struct cs_contact_projection *contact, double t, double dt,
                                   const double *x);

/* s, the time up to which methods may step from t on, in a stretch of time to `end`; begins: t
 * is its begin. */
double cs_contact_projection_end(struct cs_contact_projection *contact, bool begins, double t,
                                 double end);

/* Admissible fraction of a step from x0 (3,n) at t0 to x1 at t1: 0.5 if a free particle passes
 * a collider, else 1. Poses of the colliders are overwritten. */
double cs_contact_projection_fraction(struct cs_contact_projection *contact, double t0,
                                      const double *x0, double t1, const double *x1);

/* Longest step for which projection stays a small correction. */

/* Admissible depth in m behind a surface after a step: a tenth of the shortest spring. HUGE_VAL
 * without springs, because nothing is deformed by a push then. */
double cs_step_bound_depth(const struct cs_system *system);

/* Longest step in s from (x, v) after which no free particle is deeper than `depth` behind a
 * collider of `colliders` (scene->colliders.n, at the same time), or than it is already plus
 * `depth`. Each particle is taken to fall freely and straight towards the surface. HUGE_VAL if
 * none approaches. */
double cs_step_bound_step(const struct cs_system *system,
                          const struct cs_posed_collider *colliders, double depth,
                          const double *x, const double *v);

/* Limits the strain of stretch springs after a step (Provot 1995). */

/* Length over the limit, less 1, at which a spring is short enough. */
#define CS_STRAIN_LIMIT_TOLERANCE 1e-3

struct cs_strain_limit {
    double *before; /* (6n) scratch, borrowed; NULL: no rounds */
    double missed;  /* largest length over the limit that rounds have left, less 1; 0: none */
};

/* Shortens every stretch spring of a body with a strain limit that is longer than strain_limit
 * times its rest length. Its ends move along it by their inverse masses (Provot 1995; cloth
 * thesis, sec. 5.3):
 *
 *   x_a += w_a (l - s L) / (w_a + w_b) u,   x_b -= w_b (l - s L) / (w_a + w_b) u
 *
 * Velocities change by the displacement over dt, but by no more than stops the lengthening of
 * the spring: they then fit the positions, and what was too long before is no blow. At most
 * strain_limit_sweeps passes, every other one backwards; fewer if a pass finds nothing. Then up
 * to 128 rounds until no spring exceeds the limit by more than CS_STRAIN_LIMIT_TOLERANCE: a
 * pass each, over a grid after passes over far pairs. A pass over a grid has the order of
 * strain_limit.c, over a mesh that of the springs. Returns the number of corrections. x, v
 * (3,n) in m and m/s are changed in place.
 *
 * Only stretch springs are limited: with shear and bend springs too, the passes work against
 * each other and pump energy into a hanging sheet at dt = 1/60 s. */
uint64_t cs_strain_limit_apply(struct cs_strain_limit *limit, const struct cs_system *system,
                               double dt, double *x, double *v);

/* Particles that start inside a collider, and bodies that start crossed, in touch, or within
 * the range of contact. */

/* Particles and bodies that were moved, for the report. */
struct cs_initial_penetration {
    /* number of particles that were moved out */
    uint32_t n;
    /* m, largest distance that one was moved */
    double depth;
    /* moves of whole bodies to balance, by contact by force */
    uint32_t n_moves;
    /* m, the longest of them */
    double shift;
    /* J of contact by force before and after them */
    double energy[2];
    /* s, in which the particles are moved; NAN: at once */
    double seconds;
};

/* Checks the state that a system starts from. Contact would push a particle out of a collider
 * with energy that comes from nothing. By the law `project`, inside means behind the surface
 * offset by the thickness. With contact.start "move-out" a particle is moved out along normals:
 * onto that surface, or by contact by force to the distance at which it carries its own weight.
 * *inside reports it. With contact.untangle they stay, and the run moves them. contact.start
 * "allow" leaves all as it is, but for crossings.
 *
 * CS_ERR_SCENE, with particle, collider and depth, if contact.start refuses; if contact would
 * throw what "allow" leaves faster than sound; if colliders leave
 * no way out; if a contact sample (model/contact/contact_samples.h) is then still inside; if
 * edges of bodies with contact pierce triangles, unless crossings are ignored; or as
 * cs_initial_layer_resolve. The state may then have been changed in part. */
enum cs_status cs_initial_penetration_resolve(struct cs_system *system,
                                              struct cs_initial_penetration *penetration,
                                              struct cs_error *error);

/* Looks for surfaces with contact that touch at the start, so that no side can be told.
 * CS_ERR_SCENE, with both; CS_ERR_MEMORY. */
enum cs_status cs_touching_surfaces_check(struct cs_system *system, struct cs_error *error);

/* The part for contact by force, after which no two surfaces touch, or store more energy than
 * at rest (initial_layer.c). Ranges that nobody set shrink for that;
 * contact.start "move-out" moves bodies to balance instead, and counts them in *inside.
 * CS_ERR_SCENE, with both surfaces, their energy and the move that would do; CS_ERR_MEMORY. */
enum cs_status cs_initial_layer_resolve(struct cs_system *system,
                                        struct cs_initial_penetration *penetration,
                                        struct cs_error *error);

/* Adds what was moved as one line without an end; nothing if nothing was. */
void cs_initial_penetration_print(const struct cs_initial_penetration *penetration,
                                  struct cs_text *out);

#endif
