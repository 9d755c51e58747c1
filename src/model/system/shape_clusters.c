/* Cuts bodies into overlapping clusters for shape matching: recursive bisection across the
 * longest side, and then overlap by boxes. */
#include "model/system/shape_clusters.h"

#include "mesh/trimesh.h"
#include "model/system/particle_system.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"

#include <math.h>
#include <stdlib.h>

/* A particle and its coordinate along the side that is cut. */
struct key {
    double along;
    uint32_t particle;
};

/* Coordinate of a particle in the undeformed body; for a cloth, column or row times the
 * spacing. */
static double position_of(const struct cs_body *body, uint32_t axis, uint32_t particle) {
    if (body->mesh)
        return body->geometry->positions[(size_t)axis * body->geometry->n + particle];
    const uint32_t columns = (uint32_t)body->cloth.grid[0];
    const uint32_t step[2] = {particle % columns, particle / columns};
    return axis > 1 || step[axis] == 0
               ? 0
               : body->cloth.size[axis] / (double)(body->cloth.grid[axis] - 1) * step[axis];
}

/* Axis of the longest side of the box around some particles; the first of equals. */
static uint32_t longest_side(const struct cs_body *body, const struct key *keys,
                             uint32_t count) {
    double side[3];
    for (uint32_t axis = 0; axis < 3; axis++) {
        double low = position_of(body, axis, keys[0].particle), high = low;
        for (uint32_t k = 1; k < count; k++) {
            const double at = position_of(body, axis, keys[k].particle);
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        side[axis] = high - low;
    }
    const uint32_t of_two = side[1] > side[0];
    return side[2] > side[of_two] ? 2 : of_two;
}

/* A total order: particles at one position go by number, so that qsort has one result. */
static int by_place(const void *left, const void *right) {
    const struct key *a = left, *b = right;
    if (a->along != b->along)
        return a->along < b->along ? -1 : 1;
    return a->particle < b->particle ? -1 : a->particle > b->particle;
}

/* Recursive bisection: gives the keys' particles the parts first .. first + parts - 1 in
 * part_of. Particles are divided in proportion to the parts of either half. */
static void cut(const struct cs_body *body, struct key *keys, uint32_t count, uint32_t parts,
                uint32_t first, uint32_t *part_of) {
    if (parts == 1) {
        for (uint32_t k = 0; k < count; k++)
            part_of[keys[k].particle] = first;
        return;
    }
    const uint32_t axis = longest_side(body, keys, count), left = parts / 2;
    const uint32_t middle = (uint32_t)((uint64_t)count * left / parts);
    for (uint32_t k = 0; k < count; k++)
        keys[k].along = position_of(body, axis, keys[k].particle);
    qsort(keys, count, sizeof *keys, by_place);
    cut(body, keys, middle, left, first, part_of);
    cut(body, keys + middle, count - middle, parts - left, first + left, part_of);
}

/* Low and high corner of a part, enlarged on all sides by a fraction of its longest side. */
struct box {
    double low[3], high[3];
};

/* Finds the boxes of all parts, and enlarges them. */
static void find_boxes(const struct cs_body *body, uint32_t count, const uint32_t *part_of,
                       struct box *boxes) {
    const uint32_t parts = (uint32_t)body->shape_matching.clusters;
    for (uint32_t k = 0; k < parts; k++)
        for (int axis = 0; axis < 3; axis++) {
            boxes[k].low[axis] = HUGE_VAL;
            boxes[k].high[axis] = -HUGE_VAL;
        }
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            struct box *box = boxes + part_of[i];
            const double at = position_of(body, axis, i);
            box->low[axis] = fmin(box->low[axis], at);
            box->high[axis] = fmax(box->high[axis], at);
        }
    /* the same margin on all sides, whatever the resolution of the mesh */
    for (uint32_t k = 0; k < parts; k++) {
        double side = 0;
        for (int axis = 0; axis < 3; axis++)
            side = fmax(side, boxes[k].high[axis] - boxes[k].low[axis]);
        for (int axis = 0; axis < 3; axis++) {
            boxes[k].low[axis] -= body->shape_matching.overlap * side;
            boxes[k].high[axis] += body->shape_matching.overlap * side;
        }
    }
}

/* Tells whether a particle is in a box, border included. */
static bool is_inside(const struct cs_body *body, uint32_t particle, const struct box *box) {
    for (uint32_t axis = 0; axis < 3; axis++) {
        const double at = position_of(body, axis, particle);
        if (at < box->low[axis] || at > box->high[axis])
            return false;
    }
    return true;
}

/* Lists the particles of each cluster, ascending; with items NULL only counts them, into begin.
 */
static void fill(const struct cs_body *body, uint32_t count, const struct box *boxes,
                 uint32_t *begin, uint32_t *items) {
    uint32_t n = 0;
    for (int64_t k = 0; k < body->shape_matching.clusters; k++) {
        for (uint32_t i = 0; i < count; i++)
            if (is_inside(body, i, boxes + k)) {
                if (items)
                    items[n] = i;
                n++;
            }
        begin[k + 1] = n;
    }
}

enum cs_status cs_shape_clusters_make(const struct cs_body *body,
                                      struct cs_shape_clusters *clusters,
                                      struct cs_arena *arena, struct cs_error *error) {
    const uint32_t count = (uint32_t)cs_body_count(body);
    const uint32_t parts = (uint32_t)body->shape_matching.clusters;
    struct key *keys = calloc(count, sizeof *keys);
    uint32_t *part_of = calloc(count, sizeof *part_of);
    struct box *boxes = calloc(parts, sizeof *boxes);
    clusters->n = parts;
    CS_ARENA_ARRAY(arena, clusters->begin, (size_t)parts + 1, error);
    if (!keys || !part_of || !boxes)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the clusters of %u particles", count);
    if (!error->status) {
        for (uint32_t i = 0; i < count; i++)
            keys[i].particle = i;
        cut(body, keys, count, parts, 0, part_of);
        find_boxes(body, count, part_of, boxes);
        /* the first pass counts, the second writes */
        fill(body, count, boxes, clusters->begin, NULL);
        CS_ARENA_ARRAY(arena, clusters->items, clusters->begin[parts], error);
    }
    if (!error->status)
        fill(body, count, boxes, clusters->begin, clusters->items);
    free(keys);
    free(part_of);
    free(boxes);
    return error->status;
}

/* Counts clusters and items of all bodies. */
static void count_all(const struct cs_scene *scene, size_t *n_clusters, size_t *n_items) {
    *n_clusters = *n_items = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct cs_shape_clusters *parts = cs_scene_bodies(scene)[b].shape_matching.parts;
        *n_clusters += parts ? parts->n : 0;
        *n_items += parts ? parts->begin[parts->n] : 0;
    }
}

/* Where the next body's clusters are written. */
struct place {
    uint32_t *begin, *items;
    double *alpha, *beta, *step;
    uint32_t n_clusters, n_items;
};

/* Appends the clusters of one body, whose particles start at `first`. */
static void put_clusters(struct place *at, const struct cs_shape_matching *of, uint32_t first) {
    for (uint32_t k = 0; k < of->parts->n; k++) {
        at->alpha[at->n_clusters] = of->alpha;
        at->beta[at->n_clusters] = of->beta;
        at->step[at->n_clusters] = of->alpha_step;
        for (uint32_t i = of->parts->begin[k]; i < of->parts->begin[k + 1]; i++)
            at->items[at->n_items++] = first + of->parts->items[i];
        at->begin[++at->n_clusters] = at->n_items;
    }
}

enum cs_status cs_shape_clusters_build(struct cs_system *system, struct cs_error *error) {
    size_t n, n_items;
    count_all(system->scene, &n, &n_items);
    struct place at = {
        .begin = cs_arena_alloc_array(&system->arena, n + 1, sizeof *at.begin, error),
        .items = cs_arena_alloc_array(&system->arena, n_items, sizeof *at.items, error),
        .alpha = cs_arena_alloc_array(&system->arena, n, sizeof *at.alpha, error),
        .beta = cs_arena_alloc_array(&system->arena, n, sizeof *at.beta, error),
        .step = cs_arena_alloc_array(&system->arena, n, sizeof *at.step, error),
    };
    if (error->status)
        return error->status;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_shape_matching *of = &cs_scene_bodies(system->scene)[b].shape_matching;
        /* items count within a body, the view over all particles */
        if (of->present)
            put_clusters(&at, of, system->bodies[b].first);
    }
    system->view.n_clusters = at.n_clusters;
    system->view.cluster_begin = at.begin;
    system->view.cluster_items = at.items;
    system->view.cluster_alpha = at.alpha;
    system->view.cluster_beta = at.beta;
    system->view.cluster_step = at.step;
    return CS_OK;
}

void cs_shape_clusters_refresh(struct cs_system *system) {
    /* the system owns both arrays; its views of them are read-only */
    double *alpha = (double *)system->view.cluster_alpha;
    double *beta = (double *)system->view.cluster_beta;
    for (uint32_t b = 0, k = 0; b < system->scene->bodies.n && alpha; b++) {
        const struct cs_shape_matching *of = &cs_scene_bodies(system->scene)[b].shape_matching;
        for (uint32_t i = 0; of->present && i < of->parts->n; i++, k++) {
            alpha[k] = of->alpha;
            beta[k] = of->beta;
        }
    }
}

/* Moment of a cluster about its centre of mass at time 0, by axis:
 *
 *   sum m (q - centre)^2 = sum m q^2 - (sum m q)^2 / sum m */
static double inertia_of(const struct cs_view *view, uint32_t cluster) {
    const uint32_t begin = view->cluster_begin[cluster], end = view->cluster_begin[cluster + 1];
    double sum = 0;
    for (size_t c = 0; c < 3; c++) {
        double mass = 0, first = 0, second = 0;
        for (uint32_t k = begin; k < end; k++) {
            const uint32_t i = view->cluster_items[k];
            // relative to one of its particles: far from the origin the difference would cancel
            const double q = view->start[c * view->n + i] -
                             view->start[c * view->n + view->cluster_items[begin]];
            mass += view->mass[i];
            first += view->mass[i] * q;
            second += view->mass[i] * q * q;
        }
        sum += second - first * first / mass;
    }
    return sum;
}

double cs_shape_clusters_energy(const struct cs_system *system) {
    const struct cs_view *view = &system->view;
    double energy = 0;
    for (uint32_t k = 0; k < view->n_clusters; k++) {
        // E = (alpha / step^2) sum m |q|^2 / 2
        const double step =
            view->cluster_step[k] > 0 ? view->cluster_step[k] : 1 / system->scene->time.fps;
        energy += 0.5 * view->cluster_alpha[k] / (step * step) * inertia_of(view, k);
    }
    return energy;
}
