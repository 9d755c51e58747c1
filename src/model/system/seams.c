/* seams.c - makes the stitches of a scene's seams, and breaks them. */
#include "model/system/seams.h"

#include "scene/body_keys.h"
#include "scene/body_particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct cs_seam_points cs_seam_points_of(const struct cs_system *system,
                                        const struct cs_seam_side *side) {
    const struct cs_body_range *range = system->bodies + side->body;
    return (struct cs_seam_points){cs_scene_bodies(system->scene) + side->body, system->start,
                                   system->view.n, range->first, range->count};
}

uint32_t cs_seam_points_list(const struct cs_seam_points *points,
                             const struct cs_list *particles, bool *marks, uint32_t *out) {
    const struct cs_pin *pins = particles->items;
    const uint32_t first = points->first;
    uint32_t n = 0;
    for (uint32_t p = 0; p < particles->n; p++)
        for (uint32_t i = 0; i < points->count; i++) {
            if (marks[first + i] ||
                !cs_body_pin_selects(points->body, pins + p, points->n, first, i, points->x))
                continue;
            // a corner may belong to two entries
            marks[first + i] = true;
            if (out)
                out[n] = first + i;
            n++;
        }
    memset(marks + first, false, points->count * sizeof *marks);
    return n;
}

enum cs_status cs_seam_check_counts(uint32_t number, const struct cs_seam *seam,
                                    const uint32_t n[2], struct cs_error *error) {
    const bool triangle = !isnan(seam->to.weights[0]);
    if (!n[0] || !n[1])
        return cs_fail(error, CS_ERR_SCENE, "seams[%u]%s.particles: found none at the start",
                       number, n[0] ? ".to" : "");
    if (triangle && n[1] != 3)
        return cs_fail(error, CS_ERR_SCENE,
                       "seams[%u].to.particles: found %u, expected 3 corners for the weights",
                       number, n[1]);
    if (!triangle && n[0] != n[1])
        return cs_fail(error, CS_ERR_SCENE,
                       "seams[%u].to.particles: found %u, expected %u as on the other side",
                       number, n[1], n[0]);
    return CS_OK;
}

/* Adds the stitches of one seam; sides hold the particles of both. */
static enum cs_status add_seam(struct cs_seams *seams, uint32_t number,
                               const struct cs_seam *seam, uint32_t *const sides[2], uint32_t n,
                               struct cs_error *error) {
    const bool triangle = !isnan(seam->to.weights[0]);
    for (uint32_t s = 0; s < n; s++) {
        struct cs_stitch *stitch = seams->stitches + seams->n++;
        *stitch = (struct cs_stitch){
            .at = {sides[0][s]},
            .n = triangle ? 4 : 2,
            .weight = {1},
            .stiffness = seam->stiffness,
            .damping = seam->damping,
            .length = seam->length,
            // fmin passes over NAN
            .breaking_length = fmin(seam->breaking_length,
                                    seam->length + seam->breaking_force / seam->stiffness),
            .seam = number};
        seams->breaks |= !isnan(stitch->breaking_length);
        // weights add up to 0, so that a translation stretches nothing
        for (uint32_t k = 1; k < stitch->n; k++) {
            stitch->at[k] = sides[1][triangle ? k - 1 : s];
            stitch->weight[k] = triangle ? -seam->to.weights[k - 1] : -1;
            if (stitch->at[k] == stitch->at[0])
                return cs_fail(
                    error, CS_ERR_SCENE,
                    "seams[%u]: particle %u of all bodies is sewn to itself; expected "
                    "another particle",
                    number, stitch->at[0]);
        }
    }
    return CS_OK;
}

/* Orders ends by particle, then by stitch. */
static int compare(const void *left, const void *right) {
    const struct cs_stitch_end *a = left, *b = right;
    return a->particle != b->particle
               ? (a->particle > b->particle) - (a->particle < b->particle)
               : (a->stitch > b->stitch) - (a->stitch < b->stitch);
}

/* Lists the ends, and merges sewn particles: joined ones have the smallest number. */
static enum cs_status list_ends(struct cs_system *system, struct cs_error *error) {
    struct cs_seams *seams = system->seams;
    for (uint32_t s = 0; s < seams->n; s++)
        seams->n_ends += seams->stitches[s].n;
    CS_ARENA_ARRAY(&system->arena, seams->ends, seams->n_ends, error);
    CS_ARENA_ARRAY(&system->arena, seams->merged, system->view.n, error);
    if (error->status)
        return error->status;
    for (uint32_t i = 0; i < system->view.n; i++)
        seams->merged[i] = i;
    for (uint32_t s = 0, e = 0; s < seams->n; s++) {
        const struct cs_stitch *stitch = seams->stitches + s;
        uint32_t near = 1;
        for (uint32_t k = 0; k < stitch->n; k++) {
            seams->ends[e++] = (struct cs_stitch_end){stitch->at[k], s, stitch->weight[k]};
            near = k && stitch->weight[k] < stitch->weight[near] ? k : near;
        }
        const uint32_t a = seams->merged[stitch->at[0]], b = seams->merged[stitch->at[near]];
        for (uint32_t i = 0; i < system->view.n && a != b; i++)
            if (seams->merged[i] == (a > b ? a : b))
                seams->merged[i] = a < b ? a : b;
    }
    qsort(seams->ends, seams->n_ends, sizeof *seams->ends, compare);
    return CS_OK;
}

/* Lists the particles of a side that is a body. */
static uint32_t list_side(const struct cs_system *system, const struct cs_seam_side *side,
                          bool *marks, uint32_t *out) {
    const struct cs_seam_points points = cs_seam_points_of(system, side);
    return cs_seam_points_list(&points, &side->particles, marks, out);
}

/* Makes the stitches of seams between bodies; work has room for both sides of one. */
static enum cs_status make(struct cs_system *system, bool *marks, uint32_t *work,
                           struct cs_error *error) {
    struct cs_seams *seams = system->seams;
    const struct cs_seam *list = system->scene->seams.items;
    uint32_t *const sides[2] = {work, work + system->view.n};
    size_t total = 0;
    for (uint32_t k = 0; k < system->scene->seams.n; k++) {
        if (list[k].to.collider >= 0)
            continue;
        const uint32_t n[2] = {list_side(system, &list[k].side, marks, NULL),
                               list_side(system, &list[k].to.side, marks, NULL)};
        if (cs_seam_check_counts(k, list + k, n, error))
            return error->status;
        total += n[0];
    }
    struct cs_arena *arena = &system->arena;
    seams->stitches = cs_arena_alloc_array(arena, total, sizeof *seams->stitches, error);
    seams->broken = cs_arena_alloc_array(arena, total, sizeof *seams->broken, error);
    seams->forces = cs_arena_alloc_array(arena, 3 * total, sizeof *seams->forces, error);
    seams->blocks = cs_arena_alloc_array(arena, 12 * total, sizeof *seams->blocks, error);
    for (uint32_t k = 0; k < system->scene->seams.n && !error->status; k++) {
        if (list[k].to.collider >= 0)
            continue;
        const uint32_t n = list_side(system, &list[k].side, marks, sides[0]);
        list_side(system, &list[k].to.side, marks, sides[1]);
        add_seam(seams, k, list + k, sides, n, error);
    }
    return error->status ? error->status : list_ends(system, error);
}

enum cs_status cs_seams_build(struct cs_system *system, struct cs_error *error) {
    const size_t n = system->view.n;
    system->seams = cs_arena_alloc(&system->arena, sizeof *system->seams, error);
    if (!system->seams)
        return error->status;
    bool *marks = calloc(n, sizeof *marks);
    uint32_t *work = calloc(2 * n, sizeof *work);
    if (!marks || !work)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for seams");
    else
        make(system, marks, work, error);
    free(work);
    free(marks);
    return error->status;
}

bool cs_seams_break(const struct cs_system *system, const double *x) {
    struct cs_seams *seams = system->seams;
    bool any = false;
    for (uint32_t s = 0; seams && seams->breaks && s < seams->n; s++) {
        const struct cs_stitch *stitch = seams->stitches + s;
        double d[3];
        cs_stitch_difference(stitch, system->view.n, x, d);
        const double l = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        // false for NAN
        if (seams->broken[s] || !(l > stitch->breaking_length))
            continue;
        seams->broken[s] = any = true;
        seams->n_broken++;
    }
    return any;
}

void cs_seams_open(const struct cs_system *system, uint32_t seam) {
    struct cs_seams *seams = system->seams;
    for (uint32_t s = 0; seams && s < seams->n; s++) {
        if (seams->stitches[s].seam != seam || seams->broken[s])
            continue;
        seams->broken[s] = true;
        seams->n_broken++;
    }
}
