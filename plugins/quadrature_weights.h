/* quadrature_weights.h - quadrature over more nodes than it has conditions. */
#ifndef QUADRATURE_WEIGHTS_H
#define QUADRATURE_WEIGHTS_H

enum { QUADRATURE_NODES = 24, QUADRATURE_CONDITIONS = 8 };

/* A node t in s, of an integrand y whose value there has an error known by its form. */
struct quadrature_node {
    /* t^0, t^1, ...; then the factors of unknown terms of the error */
    double row[QUADRATURE_CONDITIONS];
};

/* Sets the n weights of least norm that integrate polynomials of fewer than `degrees` degrees
 * exactly from 0 to `end`, and cancel the other terms: `conditions` together, n at most. */
void quadrature_weights(int n, const struct quadrature_node *nodes, int degrees, int conditions,
                        double end, double *weights);

#endif
