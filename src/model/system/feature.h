/* feature.h - what a system may have or leave out, and what was decided for one. */
#ifndef CS_FEATURE_H
#define CS_FEATURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* X(name, what is printed) in the order of printing; each is a feature that may be absent. The
 * forces of terms.h have rows of their own, printed before AREA. */
#define CS_FEATURE_LIST(X)                                                                     \
    X(MESHES, "meshes")                                                                        \
    X(SPRINGS, "springs")                                                                      \
    X(DAMPING, "spring damping")                                                               \
    X(AREA, "area shares")                                                                     \
    X(VELOCITY_LOSS, "velocity loss")                                                          \
    X(CONTACT, "contact projection")                                                           \
    X(CROSSINGS, "crossings")                                                                  \
    X(STRAIN_LIMIT, "strain limit")                                                            \
    X(EVENTS, "events")                                                                        \
    X(VIEWPOINT_FORCES, "viewpoints")                                                          \
    X(SPRING_LIST, "spring list")                                                              \
    X(CLUSTERS, "clusters")                                                                    \
    X(SOLVER, "linear solver")                                                                 \
    X(RENDER, "renderer")                                                                      \
    X(THREADS, "threads")

enum cs_feature {
#define X(name, text) CS_FEATURE_##name,
    CS_FEATURE_LIST(X)
#undef X
        CS_FEATURES
};

struct cs_plan_row {
    bool built;
    size_t bytes;       /* taken when it was built; 0 before */
    const char *reason; /* why it is built, or why not */
};

enum { CS_TERMS_MAX = 16 };

struct cs_plan {
    uint32_t n, n_springs, n_bodies;
    uint32_t n_surface_springs,
        n_network_springs; /* springs on the surfaces of meshes, of networks in them */
    size_t state_bytes;    /* of all arrays that no row has: state, masses, pins */
    struct cs_plan_row rows[CS_FEATURES];
    struct cs_plan_row forces[CS_TERMS_MAX]; /* of the list in terms.h; why NULL: not printed */
};

#endif
