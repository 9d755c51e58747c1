/* hermite.h - the state between two ends of steps, without an evaluation.
 *
 * Since x'' = F, the end of a step knows x, v and a of its time. The polynomial that has them
 * at n ends is of degree 3n - 1 and errs by x^(3n) / (3n)! times prod_j (t - t_j)^3: as h^(3n)
 * in positions, and its derivative as h^(3n-1) in velocities (Hairer, Norsett, Wanner 1993,
 * sec. II.6). Two ends suit methods up to order 5, three those of order 8. */
#ifndef HERMITE_H
#define HERMITE_H

#include <clothsim/integrator.h>

enum { HERMITE_ENDS = 3 };

/* s, the longest step past frames if no option says: an estimate cannot see what lies between
 * the stages of a step that is far too long. */
#define LONGEST_PAST_FRAMES 0.1

/* The number of ends for a method of that order. */
static inline int hermite_ends_for(int64_t order) {
    return order > 5 ? HERMITE_ENDS : 2;
}

/* An end of a step. */
struct hermite_end {
    double t;        /* s; no two are equal */
    const double *y; /* (6n) */
    const double *a; /* (3n) in m/s2 */
};

/* z (6n) = the state at t by n_ends ends. Pinned particles are where the first one's velocity
 * takes them from there. z may be none of the arrays. Cannot fail. */
void hermite_state(const struct cs_host *host, int n_ends, const struct hermite_end *ends,
                   double t, double *z);

#endif
