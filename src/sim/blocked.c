/* Pairs one after the other: it is asked once, where a run ends. */
#include "sim/blocked.h"

#include "model/contact/points.h"
#include "model/cross/gap.h"
#include "model/cross/swath.h"
#include "model/system/surfaces.h"
#include "scene/crossings.h"

#include <string.h>

/* pairs that are looked through in some ten seconds */
#define PAIRS_MOST 1e9

enum cs_status cs_blocked_init(struct cs_blocked *blocked, const struct cs_system *system,
                               struct cs_arena *arena, struct cs_error *error) {
    *blocked = (struct cs_blocked){0};
    if (cs_scene_crossings(system->scene) == CS_CROSSINGS_LIMIT)
        blocked->x = cs_arena_take_n(arena, 6 * (size_t)system->view.n, sizeof(double), error);
    return error->status;
}

void cs_blocked_keep(struct cs_blocked *blocked, const struct cs_system *system,
                     const double t[2], const double *const x[2], double share) {
    const size_t n3 = 3 * (size_t)system->view.n;
    blocked->set = blocked->x && share < 1;
    for (size_t end = 0; end < 2 && blocked->set; end++) {
        blocked->t[end] = t[end];
        memcpy(blocked->x + end * n3, x[end], n3 * sizeof *blocked->x);
    }
}

/* The search for the pair that meets first. */
struct search {
    const struct cs_surfaces *surfaces;
    const double *x[2];
    double share;
    enum cs_gap_kind kind;
    uint32_t at[4]; /* where share is below 1 */
};

static void try_pair(struct search *search, enum cs_gap_kind kind, const uint32_t at[4]) {
    const size_t n = search->surfaces->n_points, side = kind == CS_GAP_POINT ? 1 : 2;
    struct cs_swath swaths[2] = {cs_swath_none(), cs_swath_none()};
    double p[4][3], moves[4][3];
    for (size_t k = 0; k < 4; k++)
        cs_swath_add(swaths + (k >= side), n, at[k], search->x[0], search->x[1]);
    if (!cs_swaths_meet(swaths, swaths + 1, CS_GAP_LEAST))
        return;
    for (size_t k = side; k < 4; k++)
        for (size_t l = 0; l < side; l++)
            if (at[k] == at[l])
                return;
    for (size_t k = 0; k < 4; k++)
        for (size_t c = 0; c < 3; c++) {
            p[k][c] = search->x[0][c * n + at[k]];
            moves[k][c] = search->x[1][c * n + at[k]] - p[k][c];
        }
    const double share =
        cs_gap_share(kind, (const double(*)[3])p, (const double(*)[3])moves, search->share);
    if (!(share < search->share))
        return;
    search->share = share;
    search->kind = kind;
    memcpy(search->at, at, sizeof search->at);
}

static void try_all(struct search *search) {
    const struct cs_surfaces *s = search->surfaces;
    for (uint32_t i = 0; i < s->n_points; i++)
        for (size_t t = 0; t < s->n_triangles; t++) {
            const uint32_t *c = s->triangles + 3 * t;
            try_pair(search, CS_GAP_POINT, (const uint32_t[4]){i, c[0], c[1], c[2]});
        }
    for (size_t e = 0; e < s->n_edges; e++)
        for (size_t f = e + 1; f < s->n_edges; f++) {
            const uint32_t *a = s->edges + 2 * e, *b = s->edges + 2 * f;
            try_pair(search, CS_GAP_EDGES, (const uint32_t[4]){a[0], a[1], b[0], b[1]});
        }
}

void cs_blocked_print(const struct cs_blocked *blocked, const struct cs_system *system,
                      struct cs_text *out) {
    const struct cs_surfaces *s = system->surfaces;
    if (!blocked->set || (double)s->n_points * s->n_triangles > PAIRS_MOST)
        return;
    const size_t n3 = 3 * (size_t)system->view.n;
    struct search search = {.surfaces = s, .share = 1};
    search.x[0] = cs_points_places(system, CS_POINTS_BEGIN, blocked->t[0], blocked->x);
    search.x[1] = cs_points_places(system, CS_POINTS_END, blocked->t[1], blocked->x + n3);
    try_all(&search);
    if (!(search.share < 1))
        return;
    const bool edges = search.kind == CS_GAP_EDGES;
    cs_text_add(out, edges ? "; there the edge at " : "; there ");
    cs_surfaces_print_point(system, search.at[0], out);
    cs_text_add(out, edges ? " would meet the edge at " : " would meet the triangle at ");
    cs_surfaces_print_point(system, search.at[edges ? 2 : 1], out);
}
