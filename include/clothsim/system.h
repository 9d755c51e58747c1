/* system.h - the particle system as an integrator sees it: read only, SI units.
 *
 * Arrays of 3-vectors are component-major, shape (3,n): all x, then all y, then all z.
 * A body's particles are one contiguous range; grid particle (i, j) of a body lies at
 * first + i * width + j.
 */
#ifndef CLOTHSIM_SYSTEM_H
#define CLOTHSIM_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Vector kernels in one fixed order of sums, whatever the thread count. Arrays of n doubles. */
struct cs_vector_kernels {
    uint32_t size;
    /* z = a x + b y; z may be x or y */
    void (*linear_sum)(size_t n, double a, const double *x, double b, const double *y,
                       double *z);
    double (*dot)(size_t n, const double *x, const double *y);
    /* sum of (x w)^2: sqrt of its n-th part is the weighted RMS norm */
    double (*weighted_square)(size_t n, const double *x, const double *w);
    double (*max_norm)(size_t n, const double *x);
    /* Calls part(arg, begin, end) for ranges that together are the items 0..n-1, each once,
     * several at the same time on threads of the host's; returns when all are done. A part may
     * write only what belongs to its items, and calls nothing of the host. Not in hosts whose
     * size ends before it. */
    void (*share)(size_t n, void (*part)(void *arg, size_t begin, size_t end), void *arg);
};

struct cs_view {
    uint32_t size;          /* sizeof at the host's build */
    uint32_t n;             /* particles */
    const double *mass;     /* (n) in kg, pinned particles too */
    const double *inv_mass; /* (n) in 1/kg; 0 for a pinned particle */
    const double *start;    /* (3,n) in m, positions at time 0 */
    double omega; /* bound on the largest angular frequency at rest [1/s], see numerics */
    double delta; /* bound on half the largest damping rate [1/s] */

    /* spring list, only with CS_NEED_SPRINGS: in the order in which forces are summed */
    uint32_t n_springs;
    const uint32_t *ends;    /* (n_springs, 2) */
    const double *length;    /* (n_springs) rest lengths in m */
    const double *stiffness; /* (n_springs) in N/m */
    const double *damping;   /* (n_springs) in N s/m, of the damper beside the spring */
    const uint32_t *kind;    /* (n_springs) CS_PART_STRETCH, CS_PART_SHEAR or CS_PART_BEND */
    const uint8_t *axial;    /* (n_springs) 1: damped along the spring only; 0: in every way */

    /* groups of particles that keep their shape (shape matching), only with CS_NEED_CLUSTERS;
     * their shape is that of `start`. A particle may be in several groups of its body. */
    uint32_t n_clusters;
    const uint32_t *cluster_begin; /* (n_clusters + 1) places in cluster_items */
    const uint32_t *cluster_items; /* particles of each cluster, ascending */
    const double *cluster_alpha;   /* (n_clusters) 0..1, share of the way to its shape */
    const double *cluster_beta;    /* (n_clusters) 0..1, share of the linear deformation kept */
    const double *cluster_step;    /* (n_clusters) s, step that alpha is for; 0: for any */
};

#ifdef __cplusplus
}
#endif
#endif
