/* plan.h - what a scene and a method ask for: decided once, printed, and built by it. */
#ifndef CS_PLAN_H
#define CS_PLAN_H

#include "base/status.h"
#include "base/text.h"
#include "model/scene.h"

/* X(name, what is printed) in the order of printing; each is a feature that may be absent */
#define CS_FEATURE_LIST(X)                                                                     \
    X(MESHES, "meshes")                                                                        \
    X(SPRINGS, "springs")                                                                      \
    X(DAMPING, "spring damping")                                                               \
    X(GRAVITY, "gravity")                                                                      \
    X(DRAG, "drag")                                                                            \
    X(WIND, "wind")                                                                            \
    X(AREA, "area shares")                                                                     \
    X(VELOCITY_LOSS, "velocity loss")                                                          \
    X(CONTACT, "contact")                                                                      \
    X(STRAIN_LIMIT, "strain limit")                                                            \
    X(EVENTS, "events")                                                                        \
    X(PRODS, "prods")                                                                          \
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
    size_t bytes;    /* of arrays that exist for this feature alone */
    const char *why; /* why it is built, or why it is left out */
};

struct cs_plan {
    uint32_t n, n_springs, n_bodies;
    uint32_t n_surface, n_inner; /* springs on the surfaces of meshes, of networks in them */
    size_t state_bytes;          /* state, masses, start and ranges of bodies */
    struct cs_plan_row rows[CS_FEATURES];
};

/* Decides from a checked scene, the method's needs (enum cs_need) and whether frames are drawn.
 */
void cs_plan_make(struct cs_plan *plan, const struct cs_scene *scene, uint32_t needs,
                  bool render);

/* Whether a method with such needs can follow the scene: shape matching is no force law, and a
 * method that is made for it has nothing to do without. name: of the method, for the message,
 * which starts with the JSON path. CS_ERR_SCENE. */
enum cs_status cs_plan_check(const struct cs_scene *scene, const char *name, uint32_t needs,
                             struct cs_error *error);

/* Prints it as aligned text, one feature a line. */
void cs_plan_print(const struct cs_plan *plan, struct cs_text *out);

#endif
