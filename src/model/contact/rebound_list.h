/* rebound_list.h - the particles in impact of one step, as the check of steps sees them too;
 * rebound.h finds them. */
#ifndef CS_CONTACT_REBOUND_LIST_H
#define CS_CONTACT_REBOUND_LIST_H

#include <stdbool.h>
#include <stdint.h>

/* Fraction of a particle's energy that a step with impacts may miss at particles that are not
 * in impact: those are loaded by more than their contact, and need no restitution. Beside
 * CS_UNRESOLVED_ENERGY_MAX of methods without impacts. To their energy is added this fraction
 * of psi(D/2), as all of it is to that of pairs (contact_pairs.h): else particles that barely
 * touch, with energies far below what contact holds, would cut steps for all. */
#define CS_UNRESOLVED_BESIDE_REBOUNDS 0.1
#define CS_SPARE_BESIDE_REBOUNDS      0.02

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
    bool any;       /* a particle is in impact */
    bool judged;    /* the last step was finished: the next test of a step is its own */
};

#endif
