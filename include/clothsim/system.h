/* SPDX-License-Identifier: MIT */
/* system.h - the particle system as an integrator sees it: read only, SI units.
 *
 * Arrays of 3-vectors are component-major, of shape (3,n): all x, then all y, then all z.
 * A body's particles are one contiguous range. In a grid, particle (i, j) of a body lies at
 * first + i * width + j.
 */
#ifndef CLOTHSIM_SYSTEM_H
#define CLOTHSIM_SYSTEM_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* True if a table of this contract reaches as far as `field`. Tables grow at their ends, and
 * their `size` says where the one at hand ends: ask before you use a field that came later
 * than the first release. table is a pointer to a struct with the field `size`. */
#define CS_HAS(table, field)                                                                   \
    ((size_t)((const char *)(&(table)->field + 1) - (const char *)(table)) <= (table)->size)

/* Vector kernels. Each adds up in one fixed order, whatever the number of threads, so that the
 * bits of a run are the same everywhere. Arrays have n doubles. */
struct cs_vector_kernels {
    uint32_t size; /* sizeof at the host's build: see CS_HAS */

    /* z = a x + b y. z may be x or y. */
    void (*linear_sum)(size_t n, double a, const double *x, double b, const double *y,
                       double *z);

    /* The sum of x y. */
    double (*dot)(size_t n, const double *x, const double *y);

    /* The sum of (x w)^2. The root of an n-th of it is the weighted RMS norm. */
    double (*weighted_sum_of_squares)(size_t n, const double *x, const double *w);

    /* The largest |x|. */
    double (*max_norm)(size_t n, const double *x);

    /* Runs a loop of your own on the host's threads: calls part(arg, begin, end) for ranges
     * that together are the items 0..n-1, each once, and returns when all are done. Several
     * parts run at the same time. A part may write only what belongs to its items, and must not
     * call the host. Later than the first release: ask CS_HAS(vector, parallel_for). */
    void (*parallel_for)(size_t n, void (*part)(void *arg, size_t begin, size_t end),
                         void *arg);
};

/* A loop over all particles: part(arg, begin, end), as of parallel_for. */
struct cs_loop {
    void (*part)(void *arg, size_t begin, size_t end);
    void *arg;
};

/* Data that stay the same during a run, or change only at a restart. */
struct cs_view {
    /* sizeof at the host's build: see CS_HAS. */
    uint32_t size;
    /* The number of particles. */
    uint32_t n;

    /* (n) in kg, of pinned particles too. */
    const double *mass;
    /* (n) in 1/kg; 0 for a pinned particle. */
    const double *inv_mass;
    /* (3,n) in m: positions at time 0. */
    const double *start;

    /* Bounds for automatic steps, both in 1/s: on the largest angular frequency of the springs
     * near rest, and on half the largest damping rate. They hold for the whole run. */
    double omega;
    double delta;

    /* The springs one by one, in the order in which their forces are summed. Only with
     * CS_NEED_SPRINGS; else n_springs is 0. */
    uint32_t n_springs;
    /* (n_springs, 2) particles a and b. */
    const uint32_t *ends;
    /* (n_springs) rest lengths in m. */
    const double *length;
    /* (n_springs) in N/m. */
    const double *stiffness;
    /* (n_springs) in N s/m, of the damper beside the spring. */
    const double *damping;
    /* (n_springs) CS_PART_STRETCH, CS_PART_SHEAR or CS_PART_BEND. */
    const uint32_t *kind;
    /* (n_springs) 1: the damper acts along the spring only; 0: against every relative
     * velocity of the ends. */
    const uint8_t *axial;

    /* Groups of particles that keep their shape, which is that of `start` (shape matching).
     * A particle may be in several groups of its body. Only with CS_NEED_CLUSTERS. */
    uint32_t n_clusters;
    /* (n_clusters + 1) positions in cluster_items: cluster k has those from the k-th to the
     * next. */
    const uint32_t *cluster_begin;
    /* Particles of each cluster, ascending. */
    const uint32_t *cluster_items;
    /* (n_clusters) 0..1: the fraction of the way to its goal that a particle moves in a step of
     * cluster_step. */
    const double *cluster_alpha;
    /* (n_clusters) 0..1: the fraction of the linear deformation that the shape keeps. */
    const double *cluster_beta;
    /* (n_clusters) s: the step that alpha is meant for; 0: alpha is for any step. */
    const double *cluster_step;

    /* The scene's colliders, where an event or key frames move one; else n_colliders is 0: all
     * stand still. A mesh with key frames deforms besides, about a centre that moves so.
     * The point that each turns about, its centre (of a plane: the point that the scene gives)
     * unless an event names another, is on a straight line between restarts: at time t it is at
     * origin + t velocity, and matter at p moves with velocity + spin x (p - it). Later than
     * the first release: ask CS_HAS(view, collider_spin). */
    uint32_t n_colliders;
    /* (n_colliders, 3) in m, m/s and rad/s. */
    const double *collider_origin, *collider_velocity, *collider_spin;

    /* Colours of particles: no spring joins two of one colour, so that those of one may be
     * moved at the same time. colour_begin (n_colours + 1) are positions in colour_items (n),
     * ascending within a colour; spring_begin (n + 1) those in spring_items (2 n_springs): the
     * springs at each particle, ascending. Only with CS_NEED_COLOURS, else NULL. Later than the
     * first release: ask CS_HAS(view, spring_items). */
    uint32_t n_colours;
    const uint32_t *colour_begin, *colour_items, *spring_begin, *spring_items;
};

#ifdef __cplusplus
}
#endif
#endif
