/* Principal strains of membranes. */
#include "model/elastic/membrane_strain.h"

#include <math.h>

/* Area at rest in m2 from the squares of the edges' lengths (Heron). */
static double area_of(const double *squared, size_t stride) {
    const double a = squared[0], b = squared[stride], c = squared[2 * stride];
    return sqrt(fmax(4 * a * b - (a + b - c) * (a + b - c), 0)) / 4;
}

/* The principal strain of largest magnitude of triangle t, with its sign. P q is Green's strain
 * times sqrt(2 A). */
static double strain_of(const struct cs_membrane *membrane, uint32_t t, size_t n,
                        const double *x) {
    const size_t stride = membrane->columns ? 1 : membrane->n;
    const double *P = membrane->rest + (membrane->columns ? 0 : t);
    const double *squared = P + CS_MEMBRANE_P * stride;
    const double scale = 1 / sqrt(2 * area_of(squared, stride));
    uint32_t corners[3];
    double q[3], E[3];
    cs_membrane_corners(membrane, t, corners);
    for (size_t k = 0; k < 3; k++) {
        q[k] = -squared[k * stride];
        for (size_t c = 0; c < 3; c++) {
            const double d = x[c * n + corners[(k + 1) % 3]] - x[c * n + corners[k]];
            q[k] += d * d;
        }
    }
    for (size_t a = 0; a < 3; a++)
        E[a] = scale * (P[3 * a * stride] * q[0] + P[(3 * a + 1) * stride] * q[1] +
                        P[(3 * a + 2) * stride] * q[2]);
    // E[2] is twice the entry XY
    const double mid = (E[0] + E[1]) / 2, half = (E[0] - E[1]) / 2;
    const double r = sqrt(half * half + E[2] * E[2] / 4);
    const double high = sqrt(1 + 2 * (mid + r)) - 1, low = sqrt(fmax(1 + 2 * (mid - r), 0)) - 1;
    return fabs(low) > fabs(high) ? low : high;
}

double cs_membranes_largest_strain(const struct cs_system *system, const double *x) {
    const struct cs_membranes *all = system->membranes;
    double largest = 0;
    for (uint32_t b = 0; all && b < all->n; b++)
        for (uint32_t t = 0; t < all->bodies[b].n; t++)
            largest = fmax(largest, fabs(strain_of(all->bodies + b, t, system->view.n, x)));
    return largest;
}

void cs_membranes_particle_strain(const struct cs_system *system, const double *x,
                                  double *out) {
    const struct cs_membranes *all = system->membranes;
    for (uint32_t b = 0; all && b < all->n; b++)
        for (uint32_t t = 0; t < all->bodies[b].n; t++) {
            const double strain = strain_of(all->bodies + b, t, system->view.n, x);
            uint32_t corners[3];
            cs_membrane_corners(all->bodies + b, t, corners);
            for (int k = 0; k < 3; k++)
                if (fabs(strain) > fabs(out[corners[k]]))
                    out[corners[k]] = strain;
        }
}
