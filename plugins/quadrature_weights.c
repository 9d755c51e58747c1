/* quadrature_weights.c - w_i = sum_r l_r b_ir, the weights of least norm for the rows b_i of
 * the nodes; the l solve the normal equations. */
#include "quadrature_weights.h"

void quadrature_weights(int n, const struct quadrature_node *nodes, int degrees, int conditions,
                        double end, double *weights) {
    double a[QUADRATURE_CONDITIONS][QUADRATURE_CONDITIONS + 1];
    double power = end;
    for (int r = 0; r < conditions; r++, power *= end) {
        for (int j = 0; j < conditions; j++) {
            a[r][j] = 0;
            for (int i = 0; i < n; i++)
                a[r][j] += nodes[i].row[r] * nodes[i].row[j];
        }
        a[r][conditions] = r < degrees ? power / (r + 1) : 0;
    }
    // symmetric and positive definite: no pivots
    for (int p = 0; p < conditions; p++)
        for (int r = 0; r < conditions; r++) {
            const double factor = r == p ? 0 : a[r][p] / a[p][p];
            for (int j = p; j <= conditions; j++)
                a[r][j] -= factor * a[p][j];
        }
    for (int i = 0; i < n; i++) {
        weights[i] = 0;
        for (int r = 0; r < conditions; r++)
            weights[i] += nodes[i].row[r] * a[r][conditions] / a[r][r];
    }
}
