/* planted_terms.h - forces that only tests have, one of each kind that a new force can be.
 *
 * A test that is built with planted_terms.c and with terms.c under CS_TERM_LIST_MORE has them
 * at the end of the list of forces. They act where their number is not 0. */
#ifndef PLANTED_TERMS_H
#define PLANTED_TERMS_H

struct planted {
    double resist; /* 1/s: f = -resist m v; dissipative, a number a particle */
    double trap;   /* N/m3: f = -trap q^3 n with q = n.(x - start); has an energy, blocks */
    double trap_damping; /* N s/m3: f = -trap_damping q^2 (v - n (n.v)); dissipative, blocks */
    double attract;      /* m3/s2: f = -attract m s/|s|^3 n, s = distance + q; has an energy */
    double distance;     /* m */
    double swing;        /* m/s2: f = m swing cos(3 t) along x; external */
    long calls;          /* of the swing, counted: evaluations of the forces */
};
extern struct planted planted;

/* the direction n of the trap */
extern const double planted_direction[3];

#endif
