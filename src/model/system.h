/* system.h - a scene made into arrays: only what the scene and the method need is there. */
#ifndef CS_SYSTEM_H
#define CS_SYSTEM_H

#include "base/arena.h"
#include "model/plan.h"
#include "model/scene.h"
#include "model/springs.h"

#include <clothsim/integrator.h>

/* The particles of one body: a grid of rows x columns from `first` on. */
struct cs_body_range {
    uint32_t first, count, columns, rows;
};

struct cs_term;

struct cs_system {
    struct cs_view view;          /* what integrators see */
    const struct cs_scene *scene; /* borrowed */
    struct cs_plan plan;          /* what was built, what was left out */
    struct cs_body_range *bodies; /* (scene->bodies.n) */
    struct cs_springs springs;
    double *mass, *inv_mass;    /* (n) */
    double *start;              /* (3,n) places at time 0 */
    double *state;              /* 6n: x (3,n), v (3,n) at time 0 */
    double *area;               /* (n) share of the area in m2; NULL unless a law asks for it */
    double *normals;            /* (3,n) work of the wind; NULL without wind */
    uint32_t *pinned, n_pinned; /* (n_pinned) particles, ascending */
    const struct cs_term *terms[8]; /* the forces that this scene has */
    uint32_t n_terms;
    struct cs_arena arena; /* owns the arrays */
};

/* Builds the system of a checked scene by its plan. On failure CS_ERR_MEMORY and *system is
 * empty. The scene must outlive the system. */
enum cs_status cs_system_build(struct cs_system *system, const struct cs_scene *scene,
                               const struct cs_plan *plan, struct cs_error *error);
void cs_system_finish(struct cs_system *system);

#endif
