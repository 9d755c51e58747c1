/* Principal strains and stresses of membranes. */
#include "model/elastic/membrane_forces.h"

#include <math.h>
#include <string.h>

/* Area at rest in m2 from the squares of the edges' lengths (Heron). */
static double area_of(const double *squared, size_t stride) {
    const double a = squared[0], b = squared[stride], c = squared[2 * stride];
    return sqrt(fmax(4 * a * b - (a + b - c) * (a + b - c), 0)) / 4;
}

/* Green's strain XX, YY, 2 XY of triangle t: P q over sqrt(2 A). */
static void find_strain(const struct cs_membrane *membrane, uint32_t t, size_t n,
                        const double *x, double E[3]) {
    const size_t stride = membrane->columns ? 1 : membrane->n;
    const double *P = membrane->rest + (membrane->columns ? 0 : t);
    const double *squared = P + CS_MEMBRANE_P * stride;
    const double scale = 1 / sqrt(2 * area_of(squared, stride));
    uint32_t corners[3];
    double q[3];
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
}

/* Eigenvalues of the matrix XX, YY, XY. */
static void find_principal(double xx, double yy, double xy, double *low, double *high) {
    const double mid = (xx + yy) / 2, half = (xx - yy) / 2, r = sqrt(half * half + xy * xy);
    *low = mid - r;
    *high = mid + r;
}

/* The principal strain of largest magnitude of triangle t, with its sign. */
static double strain_of(const struct cs_system *system, const struct cs_membrane *membrane,
                        uint32_t t, const double *x) {
    double E[3], low, high;
    find_strain(membrane, t, system->view.n, x, E);
    find_principal(E[0], E[1], E[2] / 2, &low, &high);
    high = sqrt(1 + 2 * high) - 1;
    low = sqrt(fmax(1 + 2 * low, 0)) - 1;
    return fabs(low) > fabs(high) ? low : high;
}

/* Likewise the principal stress S = C E in N/m. */
static double stress_of(const struct cs_system *system, const struct cs_membrane *membrane,
                        uint32_t t, const double *x) {
    const struct cs_moduli C =
        cs_membrane_moduli(cs_scene_elastic(system->scene, membrane->body));
    double E[3], low, high;
    find_strain(membrane, t, system->view.n, x, E);
    find_principal(C.warp * E[0] + C.coupling * E[1], C.coupling * E[0] + C.weft * E[1],
                   C.shear * E[2], &low, &high);
    return fabs(low) > fabs(high) ? low : high;
}

double cs_membranes_largest_strain(const struct cs_system *system, const double *x,
                                   bool extends) {
    const struct cs_membranes *membranes = system->membranes;
    double largest = 0;
    for (uint32_t b = 0; membranes && b < membranes->n; b++)
        for (uint32_t t = 0; t < membranes->bodies[b].n; t++) {
            const double strain = strain_of(system, membranes->bodies + b, t, x);
            largest = fmax(largest, extends ? strain : fabs(strain));
        }
    return largest;
}

/* A value of a triangle. */
typedef double value_of(const struct cs_system *system, const struct cs_membrane *membrane,
                        uint32_t t, const double *x);

/* out (n): the value of largest magnitude among a particle's triangles, where it is larger. */
static void find_largest(const struct cs_system *system, value_of *find, const double *x,
                         double *out) {
    const struct cs_membranes *membranes = system->membranes;
    for (uint32_t b = 0; membranes && b < membranes->n; b++)
        for (uint32_t t = 0; t < membranes->bodies[b].n; t++) {
            const double value = find(system, membranes->bodies + b, t, x);
            uint32_t corners[3];
            cs_membrane_corners(membranes->bodies + b, t, corners);
            for (int k = 0; k < 3; k++)
                if (fabs(value) > fabs(out[corners[k]]))
                    out[corners[k]] = value;
        }
}

void cs_membranes_particle_strain(const struct cs_system *system, const double *x,
                                  double *out) {
    find_largest(system, strain_of, x, out);
}

void cs_membranes_particle_stress(const struct cs_system *system, const double *x,
                                  double *out) {
    memset(out, 0, system->view.n * sizeof *out);
    find_largest(system, stress_of, x, out);
}
