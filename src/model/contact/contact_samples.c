/* Selects the edges and triangles that need samples against each collider, and iterates over
 * samples. */
#include "model/contact/contact_samples.h"

#include "base/vec3.h"
#include "base/vector.h"
#include "mesh/trimesh.h"
#include "scene/contact_keys.h"
#include "scene/scene.h"

#include <clothsim/clones.h>
#include <math.h>

double cs_contact_samples_motion(size_t n, const double c0[3], const double *x0,
                                 const double c1[3], const double *x1) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double shift = c1[c] - c0[c];
        double low, high;
        cs_vector_span(n, x1 + c * n, x0 + c * n, &low, &high);
        const double back = shift - low, on = high - shift;
        squared += back > on ? back * back : on * on;
    }
    return sqrt(squared);
}

/* Middle of the box of some particles; returns half its diagonal in m. No sample of these
 * vertices is further from the middle. */
CS_INLINE double box_of(const double *x, size_t n, const uint32_t *listed, uint32_t count,
                        double middle[3]) {
    double squared = 0;
    for (size_t c = 0; c < 3; c++) {
        double low = x[c * n + listed[0]], high = low;
        for (uint32_t k = 1; k < count; k++) {
            const double p = x[c * n + listed[k]];
            low = p < low ? p : low;
            high = p > high ? p : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    return sqrt(squared);
}

bool cs_contact_sample_item_is_near(const struct cs_contact_sample_chunk *chunk, uint32_t item,
                                    const struct cs_posed_collider *collider, double reach,
                                    size_t n, const double *x) {
    const uint32_t *vertices = chunk->vertices + (size_t)chunk->vertices_per_item * item;
    double middle[3];
    // constant numbers, so that there are no loops
    const double half = chunk->vertices_per_item == 2 ? box_of(x, n, vertices, 2, middle)
                                                      : box_of(x, n, vertices, 3, middle);
    return cs_posed_collider_is_near(collider, reach + half, middle);
}

/* items per chunk */
enum { LOT = 128 };

double cs_contact_sample_spacing(const struct cs_posed_collider *collider, double range) {
    return cs_shape_needs_points(collider->shape)
               ? sqrt(range * (2 * collider->radius + 0.75 * range))
               : HUGE_VAL;
}

/* --- lengths --- */

/* m, up to which samples cover an edge: its length at the start, times contact.sample_stretch
 */
static double length_of(const struct cs_system *system, uint32_t a, uint32_t b) {
    return system->scene->contact->sample_stretch *
           cs_vec3_distance_at(system->start, system->view.n, a, b);
}

/* m, longest edge or cell diagonal of a grid at the start */
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

double cs_contact_sample_longest(const struct cs_system *system) {
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

/* Number m of parts per edge of an item; 0 if it has no samples. A triangle has inner points
 * from m = 3 on, an edge from m = 2 on. */
static uint8_t parts_of(const struct cs_system *system,
                        const struct cs_contact_sample_chunk *chunk, uint32_t item,
                        double spacing) {
    const uint32_t *at = chunk->vertices + (size_t)chunk->vertices_per_item * item;
    double longest = 0;
    for (uint32_t k = 0; k < chunk->vertices_per_item; k++)
        longest =
            fmax(longest, length_of(system, at[k], at[(k + 1) % chunk->vertices_per_item]));
    const double parts = fmin(ceil(longest / spacing), CS_CONTACT_SAMPLE_PARTS_MAX);
    // two parts of each edge leave no point inside a triangle
    return parts >= chunk->vertices_per_item ? (uint8_t)parts : 0;
}

/* samples of an item: m - 1 in an edge, (m - 1)(m - 2)/2 inside a triangle */
static size_t points_of(uint32_t each, size_t parts) {
    return parts == 0 ? 0 : each == 2 ? parts - 1 : (parts - 1) * (parts - 2) / 2;
}

/* Sets the other members of a chunk whose items are set; returns the number of its samples,
 * before which there are `before` in other chunks. */
static size_t fill_chunk(const struct cs_system *system, double spacing, size_t before,
                         struct cs_contact_sample_chunk *chunk) {
    size_t points = 0;
    chunk->first = UINT32_MAX, chunk->last = 0;
    for (uint32_t i = chunk->begin; i < chunk->end; i++) {
        const uint8_t parts = parts_of(system, chunk, i, spacing);
        if (chunk->subdivisions) {
            chunk->subdivisions[i - chunk->begin] = parts;
            chunk->first_numbers[i - chunk->begin] = (uint32_t)(before + points);
        }
        points += points_of(chunk->vertices_per_item, parts);
        for (uint32_t k = 0; k < chunk->vertices_per_item; k++) {
            const uint32_t at = chunk->vertices[(size_t)chunk->vertices_per_item * i + k];
            chunk->first = at < chunk->first ? at : chunk->first;
            chunk->last = at > chunk->last ? at : chunk->last;
        }
    }
    return points;
}

/* Chunks of one collider with samples: counted, and stored if samples->chunks exists. */
static void list_chunks(struct cs_system *system, struct cs_contact_samples *samples,
                        uint32_t collider, struct cs_error *error) {
    const struct cs_surfaces *surfaces = system->surfaces;
    struct cs_posed_collider pose;
    cs_posed_collider_at(system, collider, 0, &pose);
    const double spacing =
        cs_contact_sample_spacing(&pose, system->collider_params[collider].range);
    for (uint32_t each = 2; each <= 3; each++) {
        // items of bodies come before those of mesh colliders
        const uint32_t n = (each == 2 ? surfaces->first_edge
                                      : surfaces->first_triangle)[system->scene->bodies.n];
        for (uint32_t begin = 0; begin < n && !error->status; begin += LOT) {
            struct cs_contact_sample_chunk chunk = {.vertices = each == 2 ? surfaces->edges
                                                                          : surfaces->triangles,
                                                    .vertices_per_item = each,
                                                    .begin = begin,
                                                    .end = n - begin > LOT ? begin + LOT : n,
                                                    .collider = collider};
            const size_t points = fill_chunk(system, spacing, 0, &chunk);
            if (points && samples->chunks) {
                CS_ARENA_ARRAY(&system->arena, chunk.subdivisions, chunk.end - begin, error);
                CS_ARENA_ARRAY(&system->arena, chunk.near, chunk.end - begin, error);
                CS_ARENA_ARRAY(&system->arena, chunk.first_numbers, chunk.end - begin, error);
                if (!error->status)
                    fill_chunk(system, spacing, samples->n_points, &chunk);
                samples->chunks[samples->n_chunks] = chunk;
                samples->n_points += points;
            }
            samples->n_chunks += points > 0;
        }
    }
}

/* Chunks of all colliders, in their order. */
static void list_all(struct cs_system *system, struct cs_contact_samples *samples,
                     struct cs_error *error) {
    samples->n_chunks = 0;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++)
        list_chunks(system, samples, c, error);
}

/* Returns whether some edge is longer than the spacing of some collider. */
static bool is_needed(const struct cs_system *system) {
    const double longest = cs_contact_sample_longest(system);
    bool needed = false;
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, c, 0, &collider);
        needed = needed || longest > cs_contact_sample_spacing(
                                         &collider, system->collider_params[c].range);
    }
    return needed;
}

enum cs_status cs_contact_samples_build(struct cs_system *system, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    if (!is_needed(system) || cs_surfaces_build(system, error))
        return error->status;
    struct cs_contact_samples *samples = cs_arena_alloc(arena, sizeof *samples, error);
    if (!samples)
        return error->status;
    samples->system = system;
    samples->blocks = &samples->current_set;
    list_all(system, samples, error);
    CS_ARENA_ARRAY(arena, samples->colliders, system->scene->colliders.n, error);
    CS_ARENA_ARRAY(arena, samples->listed, system->scene->colliders.n, error);
    CS_ARENA_ARRAY(arena, samples->x_listed, 3 * (size_t)system->view.n, error);
    CS_ARENA_ARRAY(arena, samples->chunks, samples->n_chunks, error);
    if (!error->status)
        list_all(system, samples, error);
    cs_contact_set_init(&samples->current_set, system->view.n, samples->n_chunks, arena, error);
    cs_contact_set_init(&samples->matrix, system->view.n, samples->n_chunks, arena, error);
    if (!error->status)
        system->contact_samples = samples;
    return error->status;
}

/* --- gaps --- */

/* A triangle at x (3,n) by a collider. */
struct face {
    const struct cs_system *system;
    const struct cs_posed_collider *collider;
    double spacing;
    const double *x;
    struct cs_contact_sample_point corners;
    double longest, stretch; /* m, of its edges, and of one over that at the start */
};

/* Sets lengths; returns whether an edge is longer than its samples cover, and may move. */
static bool is_outgrown(struct face *face) {
    const struct cs_system *system = face->system;
    bool any = false;
    face->longest = face->stretch = 0;
    for (int k = 0; k < 3; k++) {
        const uint32_t a = face->corners.particles[k], b = face->corners.particles[(k + 1) % 3];
        const double now = cs_vec3_distance_at(face->x, system->view.n, a, b);
        const double planned = length_of(system, a, b);
        const double parts = fmin(ceil(planned / face->spacing), CS_CONTACT_SAMPLE_PARTS_MAX);
        any = any || (now > planned && now > parts * face->spacing &&
                      system->inv_mass[a] + system->inv_mass[b] > 0);
        face->longest = fmax(face->longest, now);
        face->stretch = fmax(face->stretch, now / planned);
    }
    face->stretch *= system->scene->contact->sample_stretch;
    return any && !cs_contact_sample_is_tangled(system, &face->corners);
}

/* m, largest depth of points of a triangle in the collider; negative outside. */
static double depth_of(struct face *face) {
    const double parts = fmin(4 * ceil(face->longest / face->spacing), 64);
    double deepest = -HUGE_VAL, normal[3], p[3];
    for (int a = 0; a <= parts; a++)
        for (int b = 0; a + b <= parts; b++) {
            face->corners.w[0] = 1 - (a + b) / parts;
            face->corners.w[1] = a / parts, face->corners.w[2] = b / parts;
            cs_contact_sample_interpolate(&face->corners, face->system->view.n, face->x, p);
            deepest = fmax(deepest, -cs_posed_collider_distance(face->collider, p, normal));
        }
    return deepest;
}

/* Adds the triangles of a body. */
static void add_gaps(struct face *face, const struct cs_body_range *body, uint32_t collider,
                     struct cs_outgrown_samples *gap) {
    const size_t n = face->system->view.n;
    for (uint32_t k = 0; k < cs_faces_count(body); k++) {
        cs_face_corners(body, k, face->corners.particles);
        for (int v = 0; v < 3; v++)
            face->corners.particles[v] += body->first;
        const double *x = face->x + face->corners.particles[0], p[3] = {x[0], x[n], x[2 * n]};
        if (!is_outgrown(face) || !cs_posed_collider_is_near(face->collider, face->longest, p))
            continue;
        const double depth = depth_of(face);
        if (depth > CS_PENETRATION_MIN)
            gap->stretch = fmax(gap->stretch, face->stretch);
        if (depth > fmax(gap->depth, CS_PENETRATION_MIN))
            gap->depth = depth, gap->collider = collider;
    }
}

struct cs_outgrown_samples cs_contact_samples_find_outgrown(const struct cs_system *system,
                                                            double t, const double *x) {
    struct cs_outgrown_samples gap = {0};
    for (uint32_t c = 0; c < system->scene->colliders.n && system->collider_params; c++) {
        struct cs_posed_collider at;
        cs_posed_collider_at(system, c, t, &at);
        struct face face = {.system = system, .collider = &at, .x = x, .corners = {.n = 3}};
        face.spacing = cs_contact_sample_spacing(&at, system->collider_params[c].range);
        for (uint32_t b = 0; b < system->scene->bodies.n && face.spacing < HUGE_VAL; b++)
            add_gaps(&face, system->bodies + b, c, &gap);
    }
    return gap;
}

/* --- points --- */

void cs_contact_sample_first(const struct cs_contact_sample_chunk *chunk, uint32_t item,
                             struct cs_contact_sample_point *point) {
    *point = (struct cs_contact_sample_point){.n = chunk->vertices_per_item,
                                              .subdivisions =
                                                  chunk->subdivisions[item - chunk->begin],
                                              .a = chunk->vertices_per_item == 3};
    // the first step of the iteration counts too
    point->number = chunk->first_numbers[item - chunk->begin] - 1;
    for (uint32_t k = 0; k < chunk->vertices_per_item; k++)
        point->particles[k] = chunk->vertices[(size_t)chunk->vertices_per_item * item + k];
}

bool cs_contact_sample_next(struct cs_contact_sample_point *point) {
    point->number++;
    if (point->n == 2)
        point->a++;
    else if (point->a + ++point->b >= point->subdivisions)
        point->a++, point->b = 1;
    if (point->a + point->b >= point->subdivisions)
        return false;
    const double part = 1.0 / point->subdivisions;
    point->w[0] = (point->subdivisions - point->a - point->b) * part;
    point->w[1] = point->a * part;
    point->w[2] = point->b * part;
    return true;
}

void cs_contact_points_visit(const struct cs_system *system, uint32_t collider,
                             void (*visit)(void *arg,
                                           const struct cs_contact_sample_point *point),
                             void *arg) {
    const struct cs_contact_samples *samples = system->contact_samples;
    struct cs_contact_sample_point point = {.n = 1, .w = {1}};
    for (uint32_t i = 0; i < system->view.n; i++) {
        point.particles[0] = i;
        visit(arg, &point);
    }
    // chunks come by colliders
    for (uint32_t l = 0; samples && l < samples->n_chunks; l++)
        for (uint32_t i = samples->chunks[l].begin;
             samples->chunks[l].collider == collider && i < samples->chunks[l].end; i++)
            for (cs_contact_sample_first(samples->chunks + l, i, &point);
                 cs_contact_sample_next(&point);)
                visit(arg, &point);
}

double cs_contact_sample_mass(const struct cs_system *system,
                              const struct cs_contact_sample_point *point) {
    double inverse = 0;
    for (uint32_t k = 0; k < point->n; k++)
        inverse += point->w[k] * point->w[k] * system->inv_mass[point->particles[k]];
    return inverse > 0 && !cs_contact_sample_is_tangled(system, point) ? 1 / inverse : HUGE_VAL;
}
