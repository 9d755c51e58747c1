/* Refuses surfaces in contact that touch at the start. */
#include "base/text.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/post_step/contact_projection.h"
#include "scene/scene.h"

/* m: surfaces this close touch. No side of the other one can be told from rounding then, so
 * the force has no direction, and continuous collision detection admits no motion. */
#define TOUCHING 1e-9

/* Refuses a candidate if it touches, unless all its points are held. x (3,n_points) in m. */
static void check_candidate(const struct cs_system *system, const double *x,
                            enum cs_pair_kind kind, const uint32_t at[4],
                            struct cs_error *error) {
    const bool edges = kind == CS_PAIR_EDGE_EDGE;
    const size_t n = system->surfaces->n_points;
    struct cs_text first = {0}, second = {0};
    double p[4][3], inverse_mass = 0;
    for (size_t k = 0; k < 4; k++) {
        inverse_mass += cs_surface_points_inverse_mass(system, at[k]);
        cs_point_read(x, n, at[k], p[k]);
    }
    if (cs_exact_distance_squared(kind, (const double(*)[3])p) > TOUCHING * TOUCHING ||
        inverse_mass == 0)
        return;
    cs_surfaces_print_point(system, at[0], &first);
    cs_surfaces_print_point(system, at[edges ? 2 : 1], &second);
    cs_fail(error, CS_ERR_SCENE,
            "%s: two surfaces touch at the start, so contact cannot tell their sides: %s%s and "
            "the %s at %s; move them apart",
            system->scene->path, edges ? "the edge at " : "", cs_text_get(&first),
            edges ? "edge" : "triangle", cs_text_get(&second));
    cs_text_finish(&first);
    cs_text_finish(&second);
}

enum cs_status cs_touching_surfaces_check(struct cs_system *system, struct cs_error *error) {
    const double *x = cs_surface_points_positions(system, CS_POINTS_BEGIN, 0, system->state);
    const struct cs_candidates *candidates = &system->pairs->candidates;
    if (!cs_candidates_update(&system->pairs->candidates, x))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the contact pairs");
    for (uint32_t l = 0; l < candidates->n_chunks; l++)
        for (size_t p = 0; p < candidates->chunks[l].n && !error->status; p++) {
            const enum cs_pair_kind kind = candidates->chunks[l].kind;
            uint32_t at[4];
            cs_candidate_vertices(system->surfaces, kind, candidates->chunks[l].pairs + 2 * p,
                                  at);
            check_candidate(system, x, kind, at, error);
        }
    return error->status;
}
