/* step_check.h - tests whether a step resolves the contact of particles with colliders that it
 * passes through. A step is rejected if force and stiffness at its start predict the contact
 * energy along the way too badly. */
#ifndef CS_CONTACT_STEP_CHECK_H
#define CS_CONTACT_STEP_CHECK_H

#include "model/contact/collider_params.h"
#include "model/contact/posed_collider.h"

/* Fraction of a particle's energy that a step with impacts may miss. Particles that are not in
 * impact are loaded by more than their contact, and need no restitution. Beside
 * CS_UNRESOLVED_ENERGY_MAX of methods without impacts. To their energy is added
 * CS_SPARE_BESIDE_REBOUNDS of psi(D/2), as all of it is to that of pairs (contact_pairs.h):
 * else particles that barely touch, with energies far below what contact holds, would cut steps
 * for all. Or of the most that any particle brings, if that is less: a contact may hold 1e6
 * times that.
 *
 * The fraction holds for the sum over all points near a collider, so that a few of a thousand
 * do not cut the step of all. One point may miss CS_UNRESOLVED_ALONE of its own energy,
 * for the most part what its neighbours give it. Chosen by trial: with 1.0 and a spare of 0.02
 * sphere_fall at 24 x 24 takes 1.4 times the steps, at the same distance from dopri5. */
#define CS_UNRESOLVED_BESIDE_REBOUNDS 0.1
#define CS_SPARE_BESIDE_REBOUNDS      0.1
#define CS_UNRESOLVED_ALONE           3.0

/* One particle in impact. */
struct cs_rebound {
    uint32_t collider;   /* its number + 1; 0: the particle is not in impact */
    double g[3];         /* gradient of the distance */
    double stiffness;    /* N/m, K1 */
    double drag;         /* N s/m, r */
    double impulse[3];   /* N s, b beyond that of all other forces */
    double displacement; /* m along g, beyond h v' */
    double distance;     /* m, d1 */
    double energy;       /* J, E */
};

/* The particles in impact of one step. */
struct cs_rebounds {
    struct cs_rebound *list; /* (n) by particle */
    double *change; /* (3,n) m/s, of the velocity in the flight; 0 where there is none */
    uint8_t *rows;  /* of CS_COLLIDER_ROW particles each: 1 if one is in impact */
    bool any;       /* a particle is in impact */
    bool judged;    /* the last step was finished: the next test of a step is its own */
};

/* A method knows at most force and stiffness of contact at the start of a step. For a particle
 * that moves straight from x0 at t0 to x1 at t1, with the decrease s of its distance d,
 *
 *   e = |psi(d - s) - psi(d) - F s - K s^2/2|
 *
 * is the energy that this second-order model misses, at the worst of samples at most half a
 * range apart, so that nothing is passed over. Returns true if e is at most
 * CS_UNRESOLVED_ENERGY_MAX of the energy of every particle: the kinetic energy of its motion
 * relative to the collider plus psi(d). x0, x1 (3,n) in m. Particles that are not finite are
 * left to the blow-up check. In a scene with impacts the sum over the particles is judged
 * (cs_collider_step_set_beside_rebounds); those in impact in the step that was finished last
 * miss what their end departs from the flight. */
#define CS_UNRESOLVED_ENERGY_MAX 0.02

/* Where the scene gives contact.restitution, psi may change by this fraction of the energy in a
 * step, instead of e: methods of order 1 then lose a tenth of the energy of an impact, and not
 * most of it. A step at rest changes nothing, whatever its length. */
#define CS_IMPACT_CHANGE_MAX 0.03

/* Returns whether the scene gives contact.restitution. */
bool cs_impacts_are_resolved(const struct cs_system *system);

/* Fraction of the energy of a point or a pair that a step may miss: one of the two above. */
double cs_step_missed_max(const struct cs_system *system);

/* Number of equal parts of a move in m, at whose ends it is sampled: at most half a range long,
 * so that no contact is passed over, but no more than 64. */
CS_INLINE int cs_step_parts(double move, double range) {
    const double along = move / (0.5 * range);
    return 1 + (int)(along < 63 ? along : 63);
}

bool cs_collider_contact_resolves_step(const struct cs_system *system, double t0,
                                       const double *x0, double t1, const double *x1);

/* One collider during a step of h seconds, also for points that are no particles. */
struct cs_collider_step {
    const struct cs_system *system;
    const double *x0, *x1; /* (3,n) m */
    uint32_t collider;
    double h;
    struct cs_posed_collider at_t0, at_t1;
    struct cs_collider_params params;
    bool impacts;          /* e is the change of psi: cs_impacts_are_resolved */
    double unresolved_max; /* of a particle's energy */
    double alone;          /* the same of one point, whatever the others miss */
    double spare_energy;   /* J, added to a particle's energy */
};
/* Sets all members but x0 and x1: unresolved_max to CS_UNRESOLVED_ENERGY_MAX, spare_energy to
 * 0; alone to CS_UNRESOLVED_ALONE in scenes with impacts, else to unresolved_max. */
void cs_collider_step_set(struct cs_collider_step *step, const struct cs_system *system,
                          uint32_t collider, double t0, double t1);
/* Sets unresolved_max and spare_energy for the particles of a step with impacts that are not in
 * impact (struct cs_rebounds). Does nothing in scenes without impacts. */
void cs_collider_step_set_beside_rebounds(struct cs_collider_step *step);

/* J, by how much a point of `mass` kg that moves from `from` to `to` in m exceeds the limit of
 * e: negative below it; HUGE_VAL beyond what one point may miss. A step misses contact if the
 * sum over its points is positive. */
double cs_collider_step_excess(const struct cs_collider_step *step, double mass,
                               const double from[3], const double to[3]);

#endif
