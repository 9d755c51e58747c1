/* membranes.h - orthotropic St. Venant-Kirchhoff membranes of linear triangles, written in the
 * squared lengths of their edges.
 *
 * A triangle has the edge vectors d_i, corner i to corner i + 1, the rest lengths L_i and the
 * rest area A; its rest edges in the cloth's axes are (X_i, Y_i). With C the moduli
 * (scene/elastic_keys.h), E = (E_XX, E_YY, 2 E_XY) Green's strain and S = C E the stress:
 *
 *   q_i = |d_i|^2 - L_i^2 = 2 (R E)_i     rows of R: (X_i^2, Y_i^2, X_i Y_i)
 *   W   = A/2 E.C E = 1/4 z.C z           z = P q,  P = sqrt(A/2) R^-1
 *   t   = P^T C P (q + tau q')            q'_i = 2 d_i.w_i, w the differences of velocities
 *
 * Each edge pulls its ends together with the force t_i d_i. W is a polynomial of degree 4 in
 * the positions: no root, no division, and no state without a force. Strain is constant in a
 * triangle, and objective. Its rate, which is damped, is too (tau is elastic.damping).
 * (Bonet, Wood 2008, sections 4.5, 6.4; squared lengths: Delingette 2008.)
 *
 * A cell of a grid is two triangles, cut from top right to bottom left as in surfaces.h. Both
 * have the same squares of rest edges: a grid has one P and L. */
#ifndef CS_MEMBRANES_H
#define CS_MEMBRANES_H

#include "model/system/particle_system.h"

struct cs_moduli;

/* Numbers of a triangle at rest: P row by row, then the squares of L in m2. */
enum { CS_MEMBRANE_P = 9, CS_MEMBRANE_REST = 12 };

/* No triangle at the other side of an edge. */
#define CS_NO_SIDE UINT32_MAX

/* The triangles of one body. */
struct cs_membrane {
    uint32_t body, first, count; /* of particles */
    uint32_t columns, rows;      /* of a grid; 0: a mesh */
    uint32_t n, begin;           /* triangles; the first's number among those of all bodies */
    double shortest;             /* m, edge at rest */
    double *rest;                /* (12, n) of a mesh, (12) of a grid: P, squares of L */
    /* of a mesh */
    const uint32_t *triangles; /* (n, 3) particles within the body; borrowed */
    uint32_t *incident_begin;  /* (count + 1) */
    uint32_t *incident;        /* (3 n) triangles at a particle, ascending: 4 t + its corner */
    double *forces;            /* (9, n) N, on the corners: scratch of prepare */
};

/* All membranes of a system, whose arena owns the arrays. */
struct cs_membranes {
    struct cs_membrane *bodies; /* (n) ascending */
    uint32_t n, n_triangles;
    double shortest;    /* m, of all */
    uint32_t *n_around; /* (particles) triangles at each */

    double *blocks; /* (6, particles) diagonal blocks of the matrix prepared last */
    /* of the matrix kept last; NULL without a solver */
    double *x;        /* (3, particles) m, its positions */
    double *tensions; /* (3, n_triangles) -ck t, clamped with psd */
    double *kept;     /* (6, particles) diagonal blocks */
    double ck, cd;    /* its coefficients */
    /* edges as springs for its preconditioner (membrane_forces.h); likewise */
    struct cs_spring_run *runs; /* (n_runs) body by body */
    uint32_t n_runs, n_edges;
    uint32_t *sides; /* (n_edges, 2) 4 t + edge of the triangles at an edge; CS_NO_SIDE */
};

/* Builds system->membranes from the elastic bodies of the scene. CS_ERR_MEMORY. */
enum cs_status cs_membranes_build(struct cs_system *system, struct cs_error *error);

/* Particles of corners of triangle t of a membrane, in the system. */
void cs_membrane_corners(const struct cs_membrane *membrane, uint32_t t, uint32_t corners[3]);

/* Triangles at particle i of a membrane's body: writes 4 t + corner, ascending by t, and
 * returns their number. `around` is valid until the next call; grid has room for 6. */
uint32_t cs_membrane_incident(const struct cs_membrane *membrane, uint32_t i, uint32_t grid[6],
                              const uint32_t **around);

/* A symmetric 3x3 matrix K = P^T C P: 00, 01, 02, 11, 12, 22. rest: of triangle t. */
void cs_membrane_stiffness(const struct cs_membrane *membrane, uint32_t t,
                           const struct cs_moduli *moduli, double K[6]);

#endif
