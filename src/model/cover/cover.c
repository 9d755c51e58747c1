/* Which edges and triangles need points against which collider, and the points one by one. */
#include "model/cover/cover.h"

#include "mesh/trimesh.h"

#include <math.h>

/* items of a lot */
enum { LOT = 128 };

double cs_cover_spacing(const struct cs_obstacle *obstacle, double range) {
    return cs_shape_needs_points(obstacle->shape)
               ? sqrt(range * (2 * obstacle->radius + 0.75 * range))
               : HUGE_VAL;
}

/* --- lengths --- */

/* m, between two particles where they start */
static double length_of(const struct cs_system *system, uint32_t a, uint32_t b) {
    const double *x = system->start;
    const size_t n = system->view.n;
    double squared = 0;
    for (size_t c = 0; c < 3; c++)
        squared += (x[c * n + b] - x[c * n + a]) * (x[c * n + b] - x[c * n + a]);
    return sqrt(squared);
}

static double longest_of_grid(const struct cs_system *system,
                              const struct cs_body_range *body) {
    const uint32_t columns = body->columns;
    double longest = 0;
    for (uint32_t k = 0; k < body->count; k++) {
        const uint32_t i = body->first + k;
        const bool right = k % columns + 1 < columns, below = k / columns + 1 < body->rows;
        if (right)
            longest = fmax(longest, length_of(system, i, i + 1));
        if (below)
            longest = fmax(longest, length_of(system, i, i + columns));
        // a cell's diagonal as in surfaces.h
        if (right && below)
            longest = fmax(longest, length_of(system, i + 1, i + columns));
    }
    return longest;
}

double cs_cover_longest(const struct cs_system *system) {
    double longest = 0;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        if (!body->mesh)
            longest = fmax(longest, longest_of_grid(system, body));
        for (size_t e = 0; body->mesh && e < body->mesh->n_edges; e++)
            longest = fmax(longest, length_of(system, body->first + body->mesh->edges[2 * e],
                                              body->first + body->mesh->edges[2 * e + 1]));
    }
    return longest;
}

/* --- making --- */

/* parts of an edge or a triangle; 0: it has no points */
static uint8_t parts_of(const struct cs_system *system, const struct cs_cover_lot *lot,
                        uint32_t item, double spacing) {
    const uint32_t *at = lot->corners + (size_t)lot->each * item;
    double longest = 0;
    for (uint32_t k = 0; k < lot->each; k++)
        longest = fmax(longest, length_of(system, at[k], at[(k + 1) % lot->each]));
    const double parts = fmin(ceil(longest / spacing), CS_COVER_PARTS_MOST);
    // two parts of each edge leave no point inside a triangle
    return parts >= lot->each ? (uint8_t)parts : 0;
}

static size_t points_of(uint32_t each, size_t parts) {
    return parts == 0 ? 0 : each == 2 ? parts - 1 : (parts - 1) * (parts - 2) / 2;
}

/* Sets the rest of a lot whose items are there; returns its points. */
static size_t fill_lot(const struct cs_system *system, double spacing,
                       struct cs_cover_lot *lot) {
    size_t points = 0;
    lot->first = UINT32_MAX, lot->last = 0;
    for (uint32_t i = lot->begin; i < lot->end; i++) {
        const uint8_t parts = parts_of(system, lot, i, spacing);
        points += points_of(lot->each, parts);
        if (lot->parts)
            lot->parts[i - lot->begin] = parts;
        for (uint32_t k = 0; k < lot->each; k++) {
            const uint32_t at = lot->corners[(size_t)lot->each * i + k];
            lot->first = at < lot->first ? at : lot->first;
            lot->last = at > lot->last ? at : lot->last;
        }
    }
    return points;
}

/* The lots of one collider that have points: counted, and put where lots are there. */
static void list_lots(struct cs_system *system, struct cs_covers *covers, uint32_t collider,
                      struct cs_error *error) {
    const struct cs_surfaces *surfaces = system->surfaces;
    struct cs_obstacle pose;
    cs_obstacle_at(system, collider, 0, &pose);
    const double spacing = cs_cover_spacing(&pose, system->pairings[collider].range);
    for (uint32_t each = 2; each <= 3; each++) {
        // those of bodies come first
        const uint32_t n = (each == 2 ? surfaces->first_edge
                                      : surfaces->first_triangle)[system->scene->bodies.n];
        for (uint32_t begin = 0; begin < n && !error->status; begin += LOT) {
            struct cs_cover_lot lot = {.corners =
                                           each == 2 ? surfaces->edges : surfaces->triangles,
                                       .each = each,
                                       .begin = begin,
                                       .end = n - begin > LOT ? begin + LOT : n,
                                       .collider = collider};
            const size_t points = fill_lot(system, spacing, &lot);
            if (points && covers->lots) {
                lot.parts = cs_arena_take_n(&system->arena, lot.end - begin, 1, error);
                if (lot.parts)
                    fill_lot(system, spacing, &lot);
                covers->lots[covers->n_lots] = lot;
                covers->n_points += points;
            }
            covers->n_lots += points > 0;
        }
    }
}

static void list_all(struct cs_system *system, struct cs_covers *covers,
                     struct cs_error *error) {
    covers->n_lots = 0;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++)
        list_lots(system, covers, c, error);
}

/* whether an edge is longer than what a collider leaves uncovered */
static bool is_needed(const struct cs_system *system) {
    const double longest = cs_cover_longest(system);
    bool needed = false;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct cs_obstacle pose;
        cs_obstacle_at(system, c, 0, &pose);
        needed = needed || longest > cs_cover_spacing(&pose, system->pairings[c].range);
    }
    return needed;
}

enum cs_status cs_covers_build(struct cs_system *system, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    if (!is_needed(system) || cs_surfaces_build(system, error))
        return error->status;
    struct cs_covers *covers = cs_arena_take(arena, sizeof *covers, error);
    if (!covers)
        return error->status;
    covers->system = system;
    covers->blocks = &covers->now;
    list_all(system, covers, error);
    covers->near =
        cs_arena_take_n(arena, system->scene->colliders.n, sizeof *covers->near, error);
    covers->lots = cs_arena_take_n(arena, covers->n_lots, sizeof *covers->lots, error);
    if (!error->status)
        list_all(system, covers, error);
    cs_pair_set_init(&covers->now, system->view.n, covers->n_lots, arena, error);
    cs_pair_set_init(&covers->matrix, system->view.n, covers->n_lots, arena, error);
    covers->now.points = covers->matrix.points = true;
    if (!error->status)
        system->covers = covers;
    return error->status;
}

/* --- points --- */

void cs_cover_start(const struct cs_cover_lot *lot, uint32_t item,
                    struct cs_cover_point *point) {
    *point = (struct cs_cover_point){
        .n = lot->each, .parts = lot->parts[item - lot->begin], .a = lot->each == 3};
    for (uint32_t k = 0; k < lot->each; k++)
        point->at[k] = lot->corners[(size_t)lot->each * item + k];
}

bool cs_cover_next(struct cs_cover_point *point) {
    if (point->n == 2)
        point->a++;
    else if (point->a + ++point->b >= point->parts)
        point->a++, point->b = 1;
    if (point->a + point->b >= point->parts)
        return false;
    const double part = 1.0 / point->parts;
    point->w[0] = (point->parts - point->a - point->b) * part;
    point->w[1] = point->a * part;
    point->w[2] = point->b * part;
    return true;
}

void cs_cover_mix(const struct cs_cover_point *point, size_t n, const double *x,
                  double out[3]) {
    for (size_t c = 0; c < 3; c++) {
        out[c] = 0;
        for (uint32_t k = 0; x && k < point->n; k++)
            out[c] += point->w[k] * x[c * n + point->at[k]];
    }
}

double cs_cover_mass(const struct cs_system *system, const struct cs_cover_point *point) {
    double inverse = 0;
    for (uint32_t k = 0; k < point->n; k++)
        inverse += point->w[k] * point->w[k] * system->inv_mass[point->at[k]];
    return inverse > 0 ? 1 / inverse : HUGE_VAL;
}
