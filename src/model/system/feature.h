/* feature.h - the plan of a system: its optional features, and which of them are built, and
 * why. */
#ifndef CS_FEATURE_H
#define CS_FEATURE_H

#include <stdbool.h>
#include <stddef.h>
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
enum { CS_TERMS_MAX = 16 };

/* What a scene and a method need, decided before anything is built. */
struct cs_plan {
    uint32_t n, n_springs, n_bodies;
    uint32_t n_surface_springs,
        n_network_springs; /* springs on the surfaces of meshes, of networks in them */
    size_t state_bytes;    /* arrays that belong to no row: state, masses, pins */
    struct cs_plan_row rows[CS_FEATURES];
    struct cs_plan_row forces[CS_TERMS_MAX]; /* of the list in terms.h; why NULL: not printed */
};

#endif
