/* particle_system.h - a scene as arrays: only what the scene and the method need is allocated;
 * the plan says which features are built, and why. */
#ifndef CS_PARTICLE_SYSTEM_H
#define CS_PARTICLE_SYSTEM_H

#include "base/arena.h"
#include "base/text.h"
#include "model/spring/springs.h"

#include <clothsim/integrator.h>
#include <stdint.h>

/* X(name, printed text) in the order of printing. Each feature may be absent. Forces (terms.h)
 * have rows of their own, which are printed before AREA. */
#define CS_FEATURE_LIST(X)                                                                     \
    X(MESHES, "meshes")                                                                        \
    X(KEY_FRAMES, "key frames")                                                                \
    X(SPRINGS, "springs")                                                                      \
    X(DAMPING, "spring damping")                                                               \
    X(AREA, "area shares")                                                                     \
    X(VELOCITY_LOSS, "velocity loss")                                                          \
    X(CONTACT, "contact projection")                                                           \
    X(FRICTION_ANCHORS, "friction anchors")                                                    \
    X(CROSSINGS, "crossings")                                                                  \
    X(STRAIN_LIMIT, "strain limit")                                                            \
    X(EVENTS, "events")                                                                        \
    X(VIEWPOINT_FORCES, "viewpoints")                                                          \
    X(SPRING_LIST, "spring list")                                                              \
    X(CLUSTERS, "clusters")                                                                    \
    X(LAGGED_FRICTION, "lagged friction")                                                      \
    X(SOLVER, "linear solver")                                                                 \
    X(REBOUNDS, "rebounds")                                                                    \
    X(RENDER, "renderer")                                                                      \
    X(THREADS, "threads")

enum cs_feature {
#define X(name, text) CS_FEATURE_##name,
    CS_FEATURE_LIST(X)
#undef X
        CS_FEATURES
};

/* Decision about one feature or force. */
struct cs_plan_row {
    bool built;
    size_t bytes;       /* memory taken when it was built; 0 before */
    const char *reason; /* why it is built or not built; a constant text */
};

/* Most forces that a plan has rows for. */
enum { CS_TERMS_MAX = 20 };

/* The features of a scene with a method, decided before anything is built. */
struct cs_plan {
    uint32_t n, n_springs, n_bodies;
    bool colours; /* CS_NEED_COLOURS, in the row of the list of springs */
    uint32_t n_surface_springs,
        n_network_springs; /* springs on the surfaces of meshes, of networks in them */
    size_t state_bytes;    /* arrays that belong to no row: state, masses, pins */
    struct cs_plan_row rows[CS_FEATURES];
    struct cs_plan_row forces[CS_TERMS_MAX]; /* of the list in terms.h; why NULL: not printed */
};

struct cs_scene;
struct cs_term;
struct cs_trimesh;

/* Particles of one body, from `first` on: a grid of rows x columns, or a mesh (columns and rows
 * are 0). */
struct cs_body_range {
    uint32_t first, count, columns, rows;
    const struct cs_trimesh *mesh; /* borrowed from the scene; NULL: a grid */
};

struct cs_approach;
struct cs_events;
struct cs_collider_params;
struct cs_pairs;
struct cs_contact_samples;
struct cs_friction_anchors;
struct cs_lagged_friction;
struct cs_collider_motion;
struct cs_surfaces;
struct cs_seams;
struct cs_gas;
struct cs_membranes;
struct cs_bendings;
struct cs_points;
struct cs_crossings;

/* A built system. Its arena owns all arrays; the scene is borrowed. */
struct cs_system {
    struct cs_view view;          /* the part that integrators see */
    const struct cs_scene *scene; /* borrowed; with events, their changed copy */
    struct cs_plan plan;          /* features built and left out, with reasons and bytes */
    struct cs_body_range *bodies; /* (scene->bodies.n) */
    struct cs_springs springs;
    double *mass, *inv_mass; /* (n) */
    double *start;           /* (3,n) positions at time 0 */
    double *state;           /* 6n: x (3,n), v (3,n) at time 0 */
    double *area;            /* (n) each particle's part of the surface in m2; NULL: not used */
    double *normals; /* (3,n) at the positions of the last update; NULL: no force uses them */
    double *event_force; /* (3,n) m/s2, of events over an interval; NULL: no such event */
    uint32_t *pinned, n_pinned;                    /* (n_pinned) particles, ascending */
    const struct cs_term *terms[CS_TERMS_MAX + 1]; /* the forces that this scene has, and
                                                      lagged friction */
    uint32_t n_terms;
    struct cs_collider_motion
        *motions;            /* (scene->colliders.n); NULL: no event moves a collider */
    double *collider_motion; /* (3, colliders, 3) the view's copy of motions; NULL likewise */
    const struct cs_collider_params
        *collider_params;   /* (scene->colliders.n); NULL without contact by force */
    double default_damping; /* s, of contact by force where the scene gives none; else 0 */
    const struct cs_approach *approach; /* NULL without contact that needs it (approach.h) */
    struct cs_pairs *pairs; /* contact between bodies, and with mesh colliders; NULL: none */
    struct cs_contact_samples
        *contact_samples; /* contact points between particles, for colliders; NULL: none */
    struct cs_friction_anchors
        *friction_anchors; /* anchors of friction that sticks; NULL: it is smooth */
    struct cs_rebounds
        *rebounds; /* particles that are stepped alone; NULL: none are (rebound.h) */
    struct cs_lagged_friction
        *lagged_friction; /* NULL unless the method asks for it (lagged_friction.h) */
    const struct cs_surfaces *surfaces; /* of all bodies; NULL unless asked for (surfaces.h) */
    struct cs_points *points;       /* NULL unless colliders are meshes (contact_samples.h) */
    struct cs_crossings *crossings; /* NULL unless asked for (body_pairs.h) */
    struct cs_seams *seams;         /* stitches between particles; NULL: none (seams.h) */
    struct cs_gas *gas;             /* shut in; NULL: none is (force/term_pressure.c) */
    struct cs_membranes *membranes; /* of elastic bodies; NULL: none (elastic/membranes.h) */
    struct cs_bendings *bendings;   /* likewise (elastic/bendings.h) */
    struct cs_events *events;       /* NULL without events; it owns the scene's changed copy */
    const uint8_t *tangled; /* (n) enum cs_tangled, with no contact with colliders; NULL: none
                             */
    struct cs_arena arena;  /* owns the arrays */
};

/* Particles without contact with colliders: on their way out of one (cs_event_lead_out), or
 * sewn to one (cs_event_attach_seams). */
enum cs_tangled { CS_TANGLED_NOT, CS_TANGLED_LED_OUT, CS_TANGLED_SEWN };

/* True if a particle is one of them; of surface points beyond them false. */
static inline bool cs_system_is_tangled(const struct cs_system *system, uint32_t particle) {
    return system->tangled && particle < system->view.n && system->tangled[particle];
}

/* True if a particle is on its way out of a collider. */
static inline bool cs_system_is_led_out(const struct cs_system *system, uint32_t particle) {
    return system->tangled && system->tangled[particle] == CS_TANGLED_LED_OUT;
}

/* Frees the arena; *system is empty afterwards. Safe on an empty one. */
void cs_system_finish(struct cs_system *system);

/* Sets mass (n) in kg of all particles from the scene's values, and inv_mass (n) of those that
 * are not pinned. Pinned particles keep the inverse mass 0. */
void cs_system_set_masses(struct cs_system *system);

/* Appends "particle 312 (body 0, column 24, row 4)", or "(body 0, vertex 312)" for a mesh. */
void cs_system_print_particle(const struct cs_system *system, uint32_t particle,
                              struct cs_text *out);

#endif
