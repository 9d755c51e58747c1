/* system.h - a scene made into arrays: only what the scene and the method need is there. */
#ifndef CS_SYSTEM_H
#define CS_SYSTEM_H

#include "base/arena.h"
#include "base/text.h"
#include "model/spring/springs.h"
#include "model/system/feature.h"
#include "scene/scene.h"

#include <clothsim/integrator.h>

struct cs_term;
struct cs_trimesh;

/* The particles of one body, from `first` on: a grid of rows x columns, or a mesh (columns and
 * rows 0). */
struct cs_body_range {
    uint32_t first, count, columns, rows;
    const struct cs_trimesh *mesh; /* borrowed from the scene; NULL: a grid */
};

struct cs_events;
struct cs_collider_params;
struct cs_pairs;
struct cs_contact_samples;
struct cs_collider_motion;
struct cs_surfaces;
struct cs_points;
struct cs_crossings;

struct cs_system {
    struct cs_view view;          /* what integrators see */
    const struct cs_scene *scene; /* borrowed, or as the events have changed it */
    struct cs_plan plan;          /* what was built, what was left out */
    struct cs_body_range *bodies; /* (scene->bodies.n) */
    struct cs_springs springs;
    double *mass, *inv_mass; /* (n) */
    double *start;           /* (3,n) positions at time 0 */
    double *state;           /* 6n: x (3,n), v (3,n) at time 0 */
    double *area;            /* (n) share of the area in m2; NULL unless a law asks for it */
    double *normals;     /* (3,n) of the last positions asked for; NULL: no force uses them */
    double *event_force; /* (3,n) m/s2, of events over an interval; NULL where none can push */
    uint32_t *pinned, n_pinned;                /* (n_pinned) particles, ascending */
    const struct cs_term *terms[CS_TERMS_MAX]; /* the forces that this scene has */
    uint32_t n_terms;
    struct cs_collider_motion
        *motions;            /* (scene->colliders.n); NULL where no event moves one */
    double *collider_motion; /* (3, colliders, 3) what the view shows of them; NULL likewise */
    const struct cs_collider_params
        *collider_params;   /* (scene->colliders.n); NULL without contact by force */
    struct cs_pairs *pairs; /* bodies that keep off each other; NULL: none do */
    struct cs_contact_samples
        *contact_samples; /* points between particles that colliders touch; NULL: none */
    const struct cs_surfaces *surfaces; /* of all bodies; NULL unless asked for (surfaces.h) */
    struct cs_points *points;       /* NULL unless colliders are meshes (surface_points.h) */
    struct cs_crossings *crossings; /* NULL unless asked for (crossing_policy.h) */
    struct cs_events *events;       /* NULL without; it then holds the scene that `scene` is */
    struct cs_arena arena;          /* owns the arrays */
};

/* Gives the memory back; *system is empty then. */
void cs_system_finish(struct cs_system *system);

/* Sets mass (n) of all particles by the scene's values, and inv_mass (n) of those that are not
 * held. */
void cs_system_set_masses(struct cs_system *system);

/* Adds "particle 312 (body 0, column 24, row 4)", or "(body 0, vertex 312)" of a mesh. */
void cs_system_print_particle(const struct cs_system *system, uint32_t particle,
                              struct cs_text *out);

#endif
