/* collocation.h - the coefficients of Gauss's methods: with l_j Lagrange's polynomials of the
 * nodes c_i,
 *   a_ij = integral of l_j from 0 to c_i, b_j = integral of l_j from 0 to 1.
 */
#ifndef COLLOCATION_H
#define COLLOCATION_H

#include <stddef.h>

enum { COLLOCATION_STAGES = 4 };

/* The first `stages` rows and columns are used. */
struct collocation {
    size_t stages;
    double node[COLLOCATION_STAGES], weight[COLLOCATION_STAGES]; /* c_i, b_j */
    double a[COLLOCATION_STAGES][COLLOCATION_STAGES];
    double crout_factor[COLLOCATION_STAGES]
                       [COLLOCATION_STAGES]; /* L of A = L U, where u_ii = 1 */
    double extrapolate[COLLOCATION_STAGES]
                      [COLLOCATION_STAGES]; /* l_j(1 + c_i): to the next step */
};

/* stages: 2 to COLLOCATION_STAGES */
void collocation_make(struct collocation *self, size_t stages);

#endif
