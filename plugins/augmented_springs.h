/* augmented_springs.h - springs by an augmented Lagrangian whose stiffness grows (Giles, Diaz,
 * Yuksel 2025), for passes of vertex block descent.
 *
 * The paper has a hard constraint C = 0 pull by lambda + k C, sets lambda to that after each
 * pass, adds beta |C| to k, and starts the next step from lambda and gamma k. A spring of
 * stiffness K and rest length L is such a constraint with a slack: C = r - L - s, and K s^2/2
 * as energy. The least over s of K s^2/2 + lambda C + k C^2/2 is at K s = lambda + k C, so that
 * the spring pulls by
 *
 *     K (lambda + k (r - L)) / (K + k) = k' (r - L'),  k' = K k / (K + k),  L' = L - lambda / k
 *
 * which is a spring that is no stiffer than k. After a pass lambda becomes this pull, and the
 * constraint is off by e = r - L - lambda / K. At e = 0 it pulls by K (r - L): where the passes
 * converge it is to implicit Euler, whatever k is. K without a bound gives the constraint back.
 *
 * k is p times m / h^2, m the reduced mass of the two particles, and p grows by
 * beta |e| / (L + r): numbers that mean the same in each unit and for each step h. A soft
 * spring, K << k, has k' = K and L' = L nearly: plain vertex block descent. */
#ifndef AUGMENTED_SPRINGS_H
#define AUGMENTED_SPRINGS_H

#include <clothsim/integrator.h>

struct augmented_springs {
    double beta, gamma, start, most; /* growth and decay of p, its least and its greatest */
    double *multiplier;              /* (n_springs) lambda in N, of the last pass */
    double *penalty;                 /* (n_springs) p */
    double *stiffness, *length;      /* (n_springs) k' in N/m, L' in m */
};

/* Allocates the arrays; [create]. CS_STEP_FAIL if out of memory. */
enum cs_step augmented_springs_init(struct augmented_springs *self, const struct cs_host *host);

/* Forgets multipliers and penalties: the state or the springs were changed from outside. */
void augmented_springs_restart(struct augmented_springs *self, const struct cs_view *view);

/* Lets p decay, and sets k' and L' for the first pass of a step of h in s. */
void augmented_springs_begin(struct augmented_springs *self, const struct cs_view *view,
                             double h);

/* Sets lambda, p, k' and L' after a pass of a step of h in s that led to x (3,n). */
void augmented_springs_update(struct augmented_springs *self, const struct cs_view *view,
                              double h, const double *x);

/* save and load. */
void augmented_springs_archive(struct augmented_springs *self, const struct cs_view *view,
                               const struct cs_archive *archive);

#endif
