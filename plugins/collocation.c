/* collocation.c - coefficients of Gauss's collocation methods, from the zeros of Legendre's
 * polynomials.
 *
 * Polynomials are arrays of ascending coefficients, and integrals are exact. The tables are
 * computed, not typed: only the nodes are constants. */
#include "collocation.h"

#include <stdbool.h>
#include <string.h>

/* Zeros of Legendre's polynomials of degree 2, 3 and 4, mapped to (0, 1) by (1 + z)/2. */
static const double nodes[][COLLOCATION_STAGES] = {
    {0.2113248654051871177454, 0.7886751345948128822546},
    {0.1127016653792583114821, 0.5, 0.8872983346207416885179},
    {0.06943184420297371238803, 0.3300094782075718675987, 0.6699905217924281324013,
     0.930568155797026287612},
};

/* The coefficients of l_j, the product over m != j of (z - c_m)/(c_j - c_m), ascending. */
static void expand(const struct collocation *self, size_t j, double *coefficients) {
    const double *node = self->node;
    memset(coefficients, 0, COLLOCATION_STAGES * sizeof *coefficients);
    coefficients[0] = 1;
    for (size_t m = 0; m < self->stages; m++) {
        if (m == j)
            continue;
        for (size_t p = COLLOCATION_STAGES - 1; p > 0; p--)
            coefficients[p] =
                (coefficients[p - 1] - node[m] * coefficients[p]) / (node[j] - node[m]);
        coefficients[0] *= -node[m] / (node[j] - node[m]);
    }
}

/* The value of a polynomial at z, or its integral from 0 to z, by Horner's scheme. */
static double evaluate(const double *coefficients, double z, bool integral) {
    double sum = 0;
    for (size_t p = COLLOCATION_STAGES; p-- > 0;)
        sum = sum * z + coefficients[p] / (integral ? (double)p + 1 : 1);
    return integral ? sum * z : sum;
}

/* A = L U by Crout's method; only L is kept. */
static void factor(struct collocation *self) {
    double upper[COLLOCATION_STAGES][COLLOCATION_STAGES] = {{0}};
    for (size_t i = 0; i < self->stages; i++)
        for (size_t j = 0; j < self->stages; j++) {
            double left = self->a[i][j];
            for (size_t k = 0; k < i && k < j; k++)
                left -= self->crout_factor[i][k] * upper[k][j];
            if (j <= i)
                self->crout_factor[i][j] = left;
            else
                upper[i][j] = left / self->crout_factor[i][i];
        }
}

void collocation_make(struct collocation *self, size_t stages) {
    const size_t s = self->stages = stages;
    memcpy(self->node, nodes[s - 2], sizeof self->node);
    for (size_t j = 0; j < s; j++) {
        double coefficients[COLLOCATION_STAGES];
        expand(self, j, coefficients);
        self->weight[j] = evaluate(coefficients, 1, true);
        for (size_t i = 0; i < s; i++) {
            self->a[i][j] = evaluate(coefficients, self->node[i], true);
            self->extrapolate[i][j] = evaluate(coefficients, 1 + self->node[i], false);
        }
    }
    factor(self);
}
