/* membrane_forces.h - forces of membranes, their derivatives, and products with their matrix.
 */
#ifndef CS_MEMBRANE_FORCES_H
#define CS_MEMBRANE_FORCES_H

#include "model/elastic/membranes.h"
#include "scene/elastic_keys.h"

#include <clothsim/clones.h>

/* Forces of triangles in rows: triangle i has its corners at index i of three rows, whether
 * these lie in a grid or were gathered from a mesh. */

/* Triangles per piece: a row of a buffer on the stack takes 1 KiB. */
enum { MEMBRANE_PIECE = 128 };

/* Kernels: the force, its derivative, and a product with the solver's matrix. */
enum membrane_kernel_kind { MEMBRANE_FORCE, MEMBRANE_JVP, MEMBRANE_PRODUCT };

/* Rows of one vector at the corners: x, y, z of corner k at row[k], + stride, + 2 stride. */
struct membrane_corners {
    const double *row[3];
    size_t stride;
};

/* Input and output of a kernel. */
struct membrane_rows {
    struct membrane_corners x, v, dx, dv;
    const double *rest; /* of the first triangle */
    size_t rest_stride;
    const double *tensions; /* of the matrix: three rows */
    size_t tensions_stride;
    double *out; /* nine rows: forces on corners 0, 1, 2 */
    size_t out_stride, count;
};

/* Constants of a kernel. */
struct membrane_law {
    struct cs_moduli moduli;
    double K[6];             /* P^T C P of a grid */
    double elastic, damping; /* factors of q and of q' in the tension; in a product, of the
                                stiffness along the edges, and 0 */
};

struct membrane_vector {
    double x, y, z;
};

/* Form of a kernel: with damping. */
enum membrane_form { MEMBRANE_DAMPED = 1 };

/* Differences of positions and velocities over the edges of a triangle. */
struct membrane_element {
    struct membrane_vector d[3], w[3];
};

CS_INLINE struct membrane_vector membrane_at(const struct membrane_corners *rows, int corner,
                                             size_t i) {
    const double *row = rows->row[corner] + i;
    return (struct membrane_vector){row[0], row[rows->stride], row[2 * rows->stride]};
}

CS_INLINE double membrane_dot(struct membrane_vector a, struct membrane_vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Differences over the edges of triangle i. */
CS_INLINE void membrane_edges(const struct membrane_corners *rows, size_t i,
                              struct membrane_vector d[3]) {
    const struct membrane_vector a = membrane_at(rows, 0, i), b = membrane_at(rows, 1, i),
                                 c = membrane_at(rows, 2, i);
    d[0] = (struct membrane_vector){b.x - a.x, b.y - a.y, b.z - a.z};
    d[1] = (struct membrane_vector){c.x - b.x, c.y - b.y, c.z - b.z};
    d[2] = (struct membrane_vector){a.x - c.x, a.y - c.y, a.z - c.z};
}

/* t = K q by the stiffness of a grid. */
CS_INLINE void membrane_tension_by_k(const double K[6], const double q[3], double t[3]) {
    t[0] = K[0] * q[0] + K[1] * q[1] + K[2] * q[2];
    t[1] = K[1] * q[0] + K[3] * q[1] + K[4] * q[2];
    t[2] = K[2] * q[0] + K[4] * q[1] + K[5] * q[2];
}

/* s = C P q, the stress times sqrt(2 A). */
CS_INLINE void membrane_stress(const struct cs_moduli *moduli, const double *rest,
                               size_t stride, const double q[3], double s[3]) {
    double z[3];
    for (size_t a = 0; a < 3; a++)
        z[a] = rest[3 * a * stride] * q[0] + rest[(3 * a + 1) * stride] * q[1] +
               rest[(3 * a + 2) * stride] * q[2];
    s[0] = moduli->warp * z[0] + moduli->coupling * z[1];
    s[1] = moduli->coupling * z[0] + moduli->weft * z[1];
    s[2] = moduli->shear * z[2];
}

/* t = P^T s. */
CS_INLINE void membrane_tension_of_stress(const double *rest, size_t stride, const double s[3],
                                          double t[3]) {
    for (size_t i = 0; i < 3; i++)
        t[i] = rest[i * stride] * s[0] + rest[(3 + i) * stride] * s[1] +
               rest[(6 + i) * stride] * s[2];
}

/* t = K q of triangle i. */
CS_INLINE void membrane_tension(const struct membrane_law *law,
                                const struct membrane_rows *rows, size_t i, const double q[3],
                                double t[3]) {
    double s[3];
    membrane_stress(&law->moduli, rows->rest + i, rows->rest_stride, q, s);
    membrane_tension_of_stress(rows->rest + i, rows->rest_stride, s, t);
}

/* Stores the forces on the corners from r_i = t_i d_i of the edges, or their derivatives. */
CS_INLINE void membrane_store(const struct membrane_rows *rows, size_t i,
                              const struct membrane_vector r[3]) {
    for (size_t k = 0; k < 3; k++) {
        const struct membrane_vector out = r[k], in = r[(k + 2) % 3];
        double *to = rows->out + 3 * k * rows->out_stride + i;
        to[0] = out.x - in.x;
        to[rows->out_stride] = out.y - in.y;
        to[2 * rows->out_stride] = out.z - in.z;
    }
}

/* Finds the edges of triangle i, and its tensions t = K (elastic q + damping q'). */
CS_INLINE void membrane_state(const struct membrane_law *law, const struct membrane_rows *rows,
                              size_t i, const unsigned form, struct membrane_element *edges,
                              double t[3]) {
    double q[3];
    membrane_edges(&rows->x, i, edges->d);
    if (form & MEMBRANE_DAMPED)
        membrane_edges(&rows->v, i, edges->w);
    for (size_t k = 0; k < 3; k++) {
        const double rest = rows->rest[(CS_MEMBRANE_P + k) * rows->rest_stride + i];
        q[k] = law->elastic * (membrane_dot(edges->d[k], edges->d[k]) - rest);
        if (form & MEMBRANE_DAMPED)
            q[k] += law->damping * (2 * membrane_dot(edges->d[k], edges->w[k]));
    }
    membrane_tension(law, rows, i, q, t);
}

/* The force of triangle i: r = t d. */
CS_INLINE void membrane_force(const struct membrane_law *law, const struct membrane_rows *rows,
                              size_t i, const unsigned form) {
    struct membrane_element at;
    struct membrane_vector r[3];
    double t[3];
    membrane_state(law, rows, i, form, &at, t);
    for (size_t k = 0; k < 3; k++)
        r[k] = (struct membrane_vector){t[k] * at.d[k].x, t[k] * at.d[k].y, t[k] * at.d[k].z};
    membrane_store(rows, i, r);
}

/* Its derivative: dt = K (2 elastic d.dd + 2 damping (dd.w + d.dw)), dr = dt d + t dd. */
CS_INLINE void membrane_jvp(const struct membrane_law *law, const struct membrane_rows *rows,
                            size_t i, const unsigned form) {
    struct membrane_element at;
    struct membrane_vector dd[3], dw[3], r[3];
    double t[3], q[3], dt[3];
    membrane_state(law, rows, i, form, &at, t);
    membrane_edges(&rows->dx, i, dd);
    if (form & MEMBRANE_DAMPED)
        membrane_edges(&rows->dv, i, dw);
    // the change of q and of q'
    for (size_t k = 0; k < 3; k++) {
        q[k] = law->elastic * (2 * membrane_dot(at.d[k], dd[k]));
        if (form & MEMBRANE_DAMPED)
            q[k] += law->damping *
                    (2 * (membrane_dot(dd[k], at.w[k]) + membrane_dot(at.d[k], dw[k])));
    }
    membrane_tension(law, rows, i, q, dt);
    for (size_t k = 0; k < 3; k++)
        r[k] = (struct membrane_vector){dt[k] * at.d[k].x + t[k] * dd[k].x,
                                        dt[k] * at.d[k].y + t[k] * dd[k].y,
                                        dt[k] * at.d[k].z + t[k] * dd[k].z};
    membrane_store(rows, i, r);
}

/* Its part of A p, for the vector p in dx: r = -(K 2 elastic d.u) d - t u with the stored
 * tensions t. Edges pull as in a force, so the sign is in u. */
CS_INLINE void membrane_product(const struct membrane_law *law,
                                const struct membrane_rows *rows, size_t i) {
    struct membrane_vector d[3], u[3], r[3];
    double q[3], dt[3];
    membrane_edges(&rows->x, i, d);
    membrane_edges(&rows->dx, i, u);
    for (size_t k = 0; k < 3; k++)
        u[k] = (struct membrane_vector){-u[k].x, -u[k].y, -u[k].z};
    for (size_t k = 0; k < 3; k++)
        q[k] = law->elastic * (2 * membrane_dot(d[k], u[k]));
    membrane_tension(law, rows, i, q, dt);
    for (size_t k = 0; k < 3; k++) {
        const double t = rows->tensions[k * rows->tensions_stride + i];
        r[k] =
            (struct membrane_vector){dt[k] * d[k].x + t * u[k].x, dt[k] * d[k].y + t * u[k].y,
                                     dt[k] * d[k].z + t * u[k].z};
    }
    membrane_store(rows, i, r);
}

/* Computes the forces of meshes of the chosen parts, by all threads, before any block; with
 * at->dx or at->dv their derivative. */
void cs_membranes_prepare(const struct cs_system *system, const struct cs_eval *at);
/* f (3,n) += forces of the chosen parts at a block, after prepare; with at->dx or at->dv their
 * exact derivative along it. */
void cs_membranes_add(const struct cs_system *system, const struct cs_eval *at, double *f);

/* One evaluation of all membranes. Arrays are (3,n) and borrowed; NULL: 0. */
struct membrane_job {
    const struct cs_system *system;
    enum membrane_kernel_kind kind;
    const double *x, *v, *dx, *dv;
    const double *tensions; /* of a product: (3, triangles) */
    /* factors of the elastic part, of the damping in s, and of elastic.damping in the elastic
     * part */
    double elastic, damping, per_damping;
    double *to;
};

/* A body's constants with the scene's present numbers. */
struct membrane_law cs_membrane_law_of(const struct membrane_job *job,
                                       const struct cs_membrane *membrane);

/* Computes meshes into their scratch, by all threads; then adds to the particles of a block. */
void cs_membrane_job_prepare(const struct membrane_job *job);
void cs_membrane_job_add(const struct membrane_job *job, const struct cs_block *block);

/* Energies and bounds of membranes, and their part of the solver's matrix.
 */

/* Elastic energy in J; NULL: of all triangles at twice their rest lengths. 0 without any. */
double cs_membranes_energy(const struct cs_system *system, const struct cs_eval *state);

/* Adds a membrane's row sums (struct cs_gershgorin of term.h) to stiffness and damping (n), at
 * the state `at`, or for NULL at rest. Masses are divided among the triangles at a particle.
 * With these, the stiffness of a triangle along its edges has frequencies of at most w; each
 * corner gets w^2 times its mass, and 2 |t| of the edges that end there. */
void cs_membranes_add_bound(const struct cs_system *system, const struct cs_eval *at,
                            double *stiffness, double *damping);

/* --- in the solver's matrix --- */

/* Finds the diagonal blocks at the matrix's state; kept: its products too. All threads. */
void cs_membranes_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                 bool kept);
/* y += the kept matrix times p, without its diagonal blocks. All threads. */
void cs_membranes_add_product(const struct cs_system *system, const double *p, double *y);
/* y += the elastic part of the kept matrix times v. */
void cs_membranes_add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                               double *y);

/* Springs that stand for a membrane in the levels of the solver's
 * preconditioner, which knows springs alone.
 *
 * The matrix of a triangle is sum over i, j of 2 kappa K_ij g_i g_j^T, g_i the gradient of edge
 * i times d_i, and tensions s_i (membrane_matrix.c). With a_i = d_i.u_i and l_i the rest
 * lengths, |2 a_i a_j| <= a_i^2 l_j/l_i + a_j^2 l_i/l_j bounds it from above by springs along
 * the edges:
 *
 *   s = max(s_i, 0),   w = sqrt(2 kappa k_i) d_i,   k_i = sum over j of |K_ij| l_j / l_i
 *
 * summed over the triangles at an edge. Products with the matrix do not use them. */

/* Makes the runs of all membranes. CS_ERR_MEMORY. */
enum cs_status cs_membrane_surrogate_build(struct cs_system *system, struct cs_error *error);

/* Sets the factors of the runs (as cs_springs_factor) for the matrix kept last. All threads. */
void cs_membrane_surrogate_factor(const struct cs_system *system, double *factors);

/* Strains and stresses of membranes. */

/* Largest magnitude of the principal strains of all triangles: with the eigenvalues e of
 * Green's strain, sqrt(1 + 2 e) - 1, the change of length over the length. NaNs are skipped; 0
 * without membranes. extends: of triangles that extend more than they shrink. */
double cs_membranes_largest_strain(const struct cs_system *system, const double *x,
                                   bool extends);

/* out (n): the principal strain of largest magnitude among a particle's triangles, with its
 * sign, where it is larger than what is there. */
void cs_membranes_particle_strain(const struct cs_system *system, const double *x, double *out);
/* out (n): likewise of the elastic stress of St. Venant and Kirchhoff, in N per m of the sheet
 * at rest; 0 outside membranes. */
void cs_membranes_particle_stress(const struct cs_system *system, const double *x, double *out);

#endif
