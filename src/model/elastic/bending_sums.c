/* Sums over the stencils of bending: their energy, and the rows of their matrix. */
#include "model/elastic/bending_sums.h"

#include "model/elastic/normal_curvature.h"
#include "scene/elastic_keys.h"

#include <math.h>
#include <string.h>

/* D k of a stencil for a weight each, or a component of k. */
static void multiply(const struct cs_moduli *moduli, const double k[3], double out[3]) {
    out[0] = moduli->warp * k[0] + moduli->coupling * k[1];
    out[1] = moduli->coupling * k[0] + moduli->weft * k[1];
    out[2] = moduli->shear * k[2];
}

static double stencil_energy(const struct cs_bending_stencil *stencil, size_t n,
                             const double *x) {
    double energy = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *p = x + c * n;
        double k[3] = {0, 0, 0}, M[3];
        for (uint32_t j = 1; j < stencil->n; j++)
            for (int a = 0; a < 3; a++)
                k[a] += stencil->weights[a][j] * (p[stencil->at[j]] - p[stencil->at[0]]);
        multiply(&stencil->moduli, k, M);
        energy += 0.5 * (k[0] * M[0] + k[1] * M[1] + k[2] * M[2]);
    }
    return energy;
}

double cs_bendings_energy(const struct cs_system *system, const double *x) {
    double sum = 0;
    for (uint32_t b = 0; b < system->bendings->n; b++) {
        const struct cs_bending *bending = system->bendings->bodies + b;
        const struct cs_moduli moduli =
            cs_bending_moduli(cs_scene_elastic(system->scene, bending->body));
        for (uint32_t s = 0; !bending->rest && s < bending->n; s++) {
            struct cs_bending_stencil stencil;
            cs_bending_stencil_at(bending, &moduli, s, &stencil);
            sum += stencil_energy(&stencil, system->view.n, x);
        }
    }
    return sum + cs_normal_curvature_energy(system, x);
}

/* Adds rows of a stencil's matrix: its diagonal, or the sum of magnitudes. */
static void add_rows(const struct cs_bending_stencil *stencil, bool diagonal, double *sums) {
    for (uint32_t i = 0; i < stencil->n; i++)
        for (uint32_t j = diagonal ? i : 0; j < (diagonal ? i + 1 : stencil->n); j++) {
            const double(*b)[CS_BENDING_POINTS] = stencil->weights;
            double M[3];
            multiply(&stencil->moduli, (const double[3]){b[0][j], b[1][j], b[2][j]}, M);
            sums[stencil->at[i]] += fabs(b[0][i] * M[0] + b[1][i] * M[1] + b[2][i] * M[2]);
        }
}

static void add_body_rows(const struct cs_bending *bending, const struct cs_moduli *moduli,
                          bool diagonal, double *sums) {
    for (uint32_t s = 0; s < bending->n; s++) {
        struct cs_bending_stencil stencil;
        cs_bending_stencil_at(bending, moduli, s, &stencil);
        add_rows(&stencil, diagonal, sums);
    }
}

void cs_bendings_update_rows(const struct cs_system *system) {
    struct cs_bendings *bendings = system->bendings;
    for (uint32_t b = 0; b < bendings->n; b++) {
        const struct cs_bending *bending = bendings->bodies + b;
        const struct cs_moduli moduli =
            cs_bending_moduli(cs_scene_elastic(system->scene, bending->body));
        const struct cs_moduli *of = bendings->moduli + b;
        if (bending->rest)
            continue;
        if (of->warp == moduli.warp && of->weft == moduli.weft &&
            of->coupling == moduli.coupling && of->shear == moduli.shear)
            continue;
        memset(bendings->diagonal + bending->first, 0,
               bending->count * sizeof *bendings->diagonal);
        memset(bendings->row_sums + bending->first, 0,
               bending->count * sizeof *bendings->row_sums);
        add_body_rows(bending, &moduli, true, bendings->diagonal);
        add_body_rows(bending, &moduli, false, bendings->row_sums);
        bendings->moduli[b] = moduli;
    }
}

void cs_bendings_add_bound(const struct cs_system *system, const double *x, double *stiffness,
                           double *damping) {
    cs_bendings_update_rows(system);
    for (uint32_t i = 0; i < system->view.n; i++)
        stiffness[i] += system->bendings->row_sums[i];
    if (system->bendings->normal.x)
        cs_normal_curvature_add_bound(system, x, stiffness, damping);
}
