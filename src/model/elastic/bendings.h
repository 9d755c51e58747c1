/* bendings.h - bending of sheets: curvature as sums of positions with constant weights. Those
 * of a mesh that is curved at rest are of the triangles beyond the edges unfolded into the
 * plane of the triangle; its energy, and damping, are in normal_stencil.h.
 *
 * A stencil has weights b_aj of its particles j for each curvature a of XX, YY, 2 XY in the
 * cloth's axes, and an area A. With the moduli D (scene/elastic_keys.h):
 *
 *   k_a = sum over j of b_aj x_j    vectors    W = A/2 sum over a, b of D_ab k_a.k_b
 *
 * Weights of a stencil sum to 0, so W depends on differences alone and is objective: k turns
 * with the sheet. It is the bending energy of a plate for isometric deformation (Bergou et al.
 * 2006 for the idea, not the weights), and quadratic: its matrix is constant.
 *
 *   grid   at each particle second differences along its row and column, 2 x_XY in each cell.
 *          On a rim the moment across it is 0.
 *   mesh   for each triangle the curvatures of the quadratic through its corners and the three
 *          points beyond its edges. On a rim, and where the six points lie on a conic, the sum
 *          of its hinges, each with the curvature -(slope jump)/(2 A) l n n^T of an edge of
 *          length l and normal n (Onate, Flores 2005).
 */
#ifndef CS_BENDINGS_H
#define CS_BENDINGS_H

#include "model/system/particle_system.h"
#include "scene/elastic_keys.h"

/* Points of a stencil, and of all its weights. */
enum { CS_BENDING_POINTS = 6, CS_BENDING_WEIGHTS = 18 };

/* The stencils of one body. */
struct cs_bending {
    uint32_t body, first, count; /* of particles */
    uint32_t columns, rows;      /* of a grid; 0: a mesh */
    uint32_t n;                  /* stencils: of a grid, one a particle and one a cell */
    bool damped;                 /* by its damping, or by a ramp of it */
    double spacing[2];           /* m, of a grid */
    /* of a mesh */
    double *moments;         /* (9, n): A D k in N m2 */
    uint32_t *points;        /* (n, 6) particles within the body; unused: the first again */
    double *weights, *areas; /* (n, 3, 6) in 1/m2, (n) in m2 */
    double *rest;            /* (n, 3) in 1/m, where it is curved at rest; NULL: flat */
    double *forces;          /* (n, 6, 3) N, on the points along normals; NULL: none act */
    /* of a mesh, and with forces of a grid */
    uint32_t *incident_begin; /* (count + 1) */
    uint32_t *incident;       /* stencils at a particle, ascending: 8 t + its place */
};

/* The part of the matrix along normals; arrays are NULL where no forces act along them. */
struct cs_normal_matrix {
    double *blocks;   /* (6, particles) diagonal blocks of the matrix prepared last */
    double *x, *kept; /* of the one kept last: (3, particles) m, and its diagonal blocks */
    double ck, cd;
    bool psd;
};

/* All bendings of a system, whose arena owns the arrays. */
struct cs_bendings {
    struct cs_bending *bodies; /* (n) ascending */
    uint32_t n;
    double *diagonal;         /* (particles) of K in N/m, for the moduli below */
    double *row_sums;         /* (particles) of |K| in N/m, likewise */
    double *blocks;           /* (particles) the diagonal in the matrix prepared last */
    struct cs_moduli *moduli; /* (n) of the two above */
    double kept;              /* -ck of the matrix kept last */
    struct cs_normal_matrix normal;
};

/* A stencil with its weights; D_ab times the area: 11, 22, 12, 33. */
struct cs_bending_stencil {
    uint32_t n, at[CS_BENDING_POINTS]; /* particles of the system */
    uint32_t ends[4];                  /* points of two differences across it: from, to */
    double product;                    /* m2: length of their cross product at rest */
    bool is_curved;                    /* the body is not flat at rest */
    double weights[3][CS_BENDING_POINTS], rest[3];
    struct cs_moduli moduli;
};

/* Builds system->bendings. CS_ERR_MEMORY. */
enum cs_status cs_bendings_build(struct cs_system *system, struct cs_error *error);

/* Stencil s of a body. */
void cs_bending_stencil_at(const struct cs_bending *bending, const struct cs_moduli *moduli,
                           uint32_t s, struct cs_bending_stencil *stencil);

#endif
