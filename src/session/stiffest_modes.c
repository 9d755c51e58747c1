/* Finds the largest eigenvalue of M^-1/2 (a K + b C) M^-1/2 by a restarted Lanczos process.
 *
 * One restart, from the unit vector q_0:
 *   1. Krylov basis: w = A q_k, orthogonalised against q_0..q_k; q_(k+1) = w / |w|.
 *   2. Projection H = Q^T A Q, (count,count) and symmetric.
 *   3. Eigenvectors of H by Jacobi rotations; y belongs to the largest eigenvalue.
 *   4. The Ritz vector Q y starts the next restart; its Ritz value is the eigenvalue of H.
 * New vectors are orthogonalised against the whole basis, not only the last two as in the
 * three-term recurrence of Lanczos. Rounding otherwise destroys the orthogonality once a Ritz
 * value has converged (Golub and Van Loan 2013, sec. 10.3). */
#include "session/stiffest_modes.h"

#include "base/vector.h"
#include "model/force/terms.h"
#include "scene/contact_keys.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* Bounds of the two loops; both normally end by their tolerances. */
enum { MOST_RESTARTS = 12, MOST_SWEEPS = 40 };
/* Relative change of the Ritz value between restarts that ends the search. The step limit goes
 * as value^(-1/2) without damping, hence half of this error. */
#define TOLERANCE 1e-4
/* m/s, at which smooth friction has no slope that counts; its fourth power is finite. */
#define NO_FRICTION_SPEED 1e12

enum cs_status cs_stiffest_modes_init(struct cs_stiffest_modes *modes, struct cs_system *system,
                                      struct cs_error *error) {
    const size_t n = system->view.n;
    *modes = (struct cs_stiffest_modes){.system = system};
    double **arrays[] = {&modes->dx, &modes->dv, &modes->zeros, &modes->last_vector};
    CS_ARENA_ARRAY(&modes->arena, modes->basis, (CS_STIFFEST_MODES_BASIS + 1) * 3 * n, error);
    modes->root = cs_arena_alloc_array(&modes->arena, n, sizeof(double), error);
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        *arrays[k] = cs_arena_alloc_array(&modes->arena, 3 * n, sizeof(double), error);
    if (error->status) {
        cs_stiffest_modes_finish(modes);
        return error->status;
    }
    for (size_t i = 0; i < n; i++)
        modes->root[i] = sqrt(system->inv_mass[i]);
    return CS_OK;
}

void cs_stiffest_modes_finish(struct cs_stiffest_modes *modes) {
    cs_arena_finish(&modes->arena);
    *modes = (struct cs_stiffest_modes){0};
}

/* Scales p to unit length. Returns false, with p unchanged, if p is 0 or not finite. */
static bool normalise(size_t n, double *p) {
    const double length = sqrt(cs_vector_dot_in_order(n, p, p));
    if (!(length > 0 && length < HUGE_VAL))
        return false;
    for (size_t i = 0; i < n; i++)
        p[i] /= length;
    return true;
}

/* y = M^-1/2 (a K + b C) M^-1/2 p at zero velocity, all (3,n).
 *
 * One Jacobian-vector product gives both terms: df = -K dx - C dv with dx = -a M^-1/2 p and dv
 * = -b M^-1/2 p. A term with factor 0 is not evaluated. */
static void apply(struct cs_stiffest_modes *modes, const double *x, double a, double b,
                  const double *p, double *y) {
    struct cs_system *system = modes->system;
    const struct cs_scene *given = system->scene;
    struct cs_scene frictionless = *given;
    struct cs_contact_keys contact = *given->contact;
    const size_t n = system->view.n;
    double *dx = modes->dx, *dv = modes->dv;
    /* the slope of friction goes as 1/friction_speed */
    contact.friction_speed = NO_FRICTION_SPEED;
    frictionless.contact = &contact;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            /* negative, because the product of the Jacobian is -K dx - C dv */
            dx[c * n + i] = -modes->root[i] * p[c * n + i];
    for (size_t i = 0; i < 3 * n; i++) {
        dv[i] = b * dx[i];
        dx[i] *= a;
    }
    const struct cs_eval at = {.t = modes->t,
                               .x = x,
                               .v = modes->zeros,
                               .parts = CS_PART_LINEARISED,
                               .dx = a != 0 ? dx : NULL,
                               .dv = b != 0 ? dv : NULL};
    if (cs_terms_need_normals(system, at.parts))
        cs_normals_update(system, x);
    system->scene = &frictionless;
    cs_terms_jvp(system, &at, y);
    system->scene = given;
    if (modes->pot)
        *modes->pot -= modes->pass_seconds;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            y[c * n + i] *= modes->root[i];
}

/* Start vector: the last result with 2 % of noise, or noise alone.
 *
 * Noise has a component along every mode. A regular start can be orthogonal to the wanted mode
 * of a symmetric scene, which would then never appear in the Krylov space. The noise is a
 * linear congruential sequence modulo 2^64, its top 53 bits mapped to -1..1. Pinned particles
 * stay 0. */
static void start(struct cs_stiffest_modes *modes, double *p) {
    const size_t length = 3 * (size_t)modes->system->view.n;
    uint64_t bits = 1;
    for (size_t i = 0; i < length; i++) {
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        const double noise = (double)(bits >> 11) * 0x1p-52 - 1;
        p[i] = modes->has_start ? modes->last_vector[i] + 0.02 * noise / sqrt((double)length)
                                : noise;
    }
    for (uint32_t k = 0; k < modes->system->n_pinned; k++)
        for (size_t c = 0; c < 3; c++)
            p[c * modes->system->view.n + modes->system->pinned[k]] = 0;
}

/* Removes from p its components along the first `count` basis vectors (modified Gram-Schmidt).
 * The second pass restores orthogonality to rounding where the first one cancelled most of p.
 * parts (count) receives the sum of both passes: the column of Q^T A Q. */
static void orthogonalise(const struct cs_stiffest_modes *modes, uint32_t count, size_t length,
                          double *p, double *parts) {
    memset(parts, 0, sizeof *parts * count);
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t k = 0; k < count; k++) {
            const double *q = modes->basis + k * length;
            const double part = cs_vector_dot_in_order(length, p, q);
            parts[k] += part;
            for (size_t i = 0; i < length; i++)
                p[i] -= part * q[i];
        }
}

/* Extends the basis from its first vector and projects: h (count,count) = Q^T A Q. Returns
 * count.
 *
 * Ends early if a remainder is below 1e-12 of the first Rayleigh quotient: the basis then spans
 * an invariant subspace, and its Ritz values are eigenvalues. */
static uint32_t build_basis(struct cs_stiffest_modes *modes, const double *x, double a,
                            double b,
                            double h[CS_STIFFEST_MODES_BASIS * CS_STIFFEST_MODES_BASIS]) {
    const size_t length = 3 * (size_t)modes->system->view.n;
    const uint32_t most =
        length < CS_STIFFEST_MODES_BASIS ? (uint32_t)length : CS_STIFFEST_MODES_BASIS;
    double parts[CS_STIFFEST_MODES_BASIS][CS_STIFFEST_MODES_BASIS];
    uint32_t count = 0;
    bool goes_on = true;
    while (goes_on && count < most) {
        double *next = modes->basis + (count + 1) * length;
        apply(modes, x, a, b, modes->basis + count * length, next);
        count++;
        orthogonalise(modes, count, length, next, parts[count - 1]);
        goes_on =
            cs_vector_dot_in_order(length, next, next) > 1e-24 * parts[0][0] * parts[0][0] &&
            normalise(length, next);
    }
    /* below its diagonal the projection is the image's length, by symmetry what stands above */
    memset(h, 0, sizeof(double) * CS_STIFFEST_MODES_BASIS * CS_STIFFEST_MODES_BASIS);
    for (uint32_t j = 0; j < count; j++)
        for (uint32_t i = 0; i <= j; i++)
            h[i * count + j] = h[j * count + i] = parts[j][i];
    return count;
}

/* Sum of squares below the diagonal: what the rotations still have to remove. */
static double off_diagonal(uint32_t n, const double *a) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++)
            sum += a[i * n + j] * a[i * n + j];
    return sum;
}

/* Sum of squares on the diagonal, the scale of the stopping test: 1e-28 of squares is a
 * relative 1e-14 of the entries. */
static double diagonal(uint32_t n, const double *a) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += a[i * n + i] * a[i * n + i];
    return sum;
}

/* turns entries k and l of a pair of lines by the rotation (c, s) */
static void givens_rotate(double *k, double *l, double c, double s) {
    const double old = *k;
    *k = c * old - s * *l;
    *l = s * old + c * *l;
}

/* Rotation in the plane (p, q) that makes a[p][q] zero, applied from both sides and to the
 * vectors.
 *
 * With theta = (a_qq - a_pp) / (2 a_pq), tan t is the smaller root of t^2 + 2 theta t - 1 = 0.
 * This root keeps the angle below 45 degrees, and its form here has no cancellation (Golub and
 * Van Loan 2013, sec. 8.5). */
static void rotate(uint32_t n, double *a, double *vectors, uint32_t p, uint32_t q) {
    const double apq = a[p * n + q];
    if (apq == 0)
        return;
    const double theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
    const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (uint32_t i = 0; i < n; i++)
        givens_rotate(a + i * n + p, a + i * n + q, c, s);
    for (uint32_t i = 0; i < n; i++)
        givens_rotate(a + p * n + i, a + q * n + i, c, s);
    for (uint32_t i = 0; i < n; i++)
        givens_rotate(vectors + i * n + p, vectors + i * n + q, c, s);
}

/* Diagonalises a (n,n), which is overwritten, by cyclic Jacobi rotations (Golub and Van Loan
 * 2013, sec. 8.5): the eigenvalues stand on its diagonal, the eigenvectors in the columns of
 * vectors (n,n). Row-major. */
static void diagonalise(uint32_t n, double *a, double *vectors) {
    memset(vectors, 0, sizeof *vectors * n * n);
    for (uint32_t i = 0; i < n; i++)
        vectors[i * n + i] = 1;
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        if (!(off_diagonal(n, a) > 1e-28 * diagonal(n, a)))
            return;
        for (uint32_t p = 0; p + 1 < n; p++)
            for (uint32_t q = p + 1; q < n; q++)
                rotate(n, a, vectors, p, q);
    }
}

/* Makes modes->last_vector the Ritz vector of the largest Ritz value, which is returned. h
 * (count,count) is overwritten. */
static double take_largest(struct cs_stiffest_modes *modes, uint32_t count, double *h) {
    const size_t length = 3 * (size_t)modes->system->view.n;
    double vectors[CS_STIFFEST_MODES_BASIS * CS_STIFFEST_MODES_BASIS];
    diagonalise(count, h, vectors);
    uint32_t best = 0;
    for (uint32_t k = 1; k < count; k++)
        if (h[k * count + k] > h[best * count + best])
            best = k;
    memset(modes->last_vector, 0, sizeof *modes->last_vector * length);
    for (uint32_t k = 0; k < count; k++)
        for (size_t i = 0; i < length; i++)
            modes->last_vector[i] += vectors[k * count + best] * modes->basis[k * length + i];
    return h[best * count + best];
}

/* Rayleigh quotients of the last vector, one product each, and the particle that moves most.
 * basis is used as scratch: the next search begins it again. participation: with |q| = 1, the
 * squares of a particle's components are its fraction of the kinetic energy. */
static struct cs_mode describe(struct cs_stiffest_modes *modes, const double *x) {
    const size_t n = modes->system->view.n;
    const double *p = modes->last_vector;
    double *image = modes->basis;
    struct cs_mode mode = {0};
    apply(modes, x, 1, 0, p, image);
    mode.omega_squared = cs_vector_dot_in_order(3 * n, p, image);
    apply(modes, x, 0, 1, p, image);
    mode.damping_rate = cs_vector_dot_in_order(3 * n, p, image);
    for (size_t i = 0; i < n; i++) {
        const double share = p[i] * p[i] + p[n + i] * p[n + i] + p[2 * n + i] * p[2 * n + i];
        if (share > mode.participation) {
            mode.participation = share;
            mode.particle = (uint32_t)i;
        }
    }
    return mode;
}

struct cs_mode cs_stiffest_modes_largest(struct cs_stiffest_modes *modes, const double *x,
                                         double a, double b) {
    const size_t length = 3 * (size_t)modes->system->view.n;
    double h[CS_STIFFEST_MODES_BASIS * CS_STIFFEST_MODES_BASIS], before = 0;
    start(modes, modes->basis);
    for (int round = 0; round < MOST_RESTARTS && normalise(length, modes->basis); round++) {
        const uint32_t count = build_basis(modes, x, a, b, h);
        const double value = take_largest(modes, count, h);
        modes->has_start = true;
        if (round && fabs(value - before) <= TOLERANCE * fabs(value))
            break;
        before = value;
        memcpy(modes->basis, modes->last_vector, sizeof *modes->last_vector * length);
    }
    return describe(modes, x);
}
