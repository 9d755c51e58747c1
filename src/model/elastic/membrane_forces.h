/* membrane_forces.h - forces of membranes, their derivatives, and products with their matrix.
 */
#ifndef CS_MEMBRANE_FORCES_H
#define CS_MEMBRANE_FORCES_H

#include "model/elastic/membrane_kernel.h"

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

#endif
