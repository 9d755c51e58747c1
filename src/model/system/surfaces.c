/* Builds triangles and unique edges of all bodies and mesh colliders, and the triangles at each
 * edge. */
#include "model/system/surfaces.h"

#include "scene/body_pairs.h"
#include "scene/collider_keys.h"

/* Edges of a body. A grid has them along its rows, along its columns, and one diagonal per
 * cell. */
static uint32_t count_edges(const struct cs_body_range *body) {
    const uint32_t columns = body->columns, rows = body->rows;
    return body->mesh
               ? body->mesh->n_edges
               : (columns - 1) * rows + columns * (rows - 1) + (columns - 1) * (rows - 1);
}

/* Appends an edge. */
static void add_edge(uint32_t *edges, uint32_t *n, uint32_t a, uint32_t b) {
    edges[2 * (size_t)*n] = a;
    edges[2 * (size_t)*n + 1] = b;
    ++*n;
}

/* Edges of a grid, ascending by both ends. A cell's diagonal runs from top right to bottom
 * left, as in surfaces.h. */
static void list_grid_edges(const struct cs_body_range *body, uint32_t *edges) {
    uint32_t n = 0;
    for (uint32_t r = 0; r < body->rows; r++)
        for (uint32_t c = 0; c < body->columns; c++) {
            const uint32_t i = body->first + r * body->columns + c;
            if (c + 1 < body->columns)
                add_edge(edges, &n, i, i + 1);
            if (r + 1 < body->rows && c > 0)
                add_edge(edges, &n, i, i + body->columns - 1);
            if (r + 1 < body->rows)
                add_edge(edges, &n, i, i + body->columns);
        }
}

/* Edges of a body; a mesh has them in that order already. */
static void list_edges(const struct cs_body_range *body, uint32_t *edges) {
    if (!body->mesh) {
        list_grid_edges(body, edges);
        return;
    }
    for (size_t e = 0; e < 2 * (size_t)body->mesh->n_edges; e++)
        edges[e] = body->first + body->mesh->edges[e];
}

/* Binary search. */
uint32_t cs_edge_find(const uint32_t *edges, uint32_t first, uint32_t end, uint32_t a,
                      uint32_t b) {
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    while (end - first > 1) {
        const uint32_t middle = first + (end - first) / 2;
        const uint32_t *edge = edges + 2 * (size_t)middle;
        if (edge[0] < low || (edge[0] == low && edge[1] <= high))
            first = middle;
        else
            end = middle;
    }
    return first;
}

/* Enters each triangle at its three edges. Triangles come in ascending order, so the first free
 * entry is the right one. */
static void own_edges(struct cs_surfaces *surfaces, uint32_t body) {
    for (uint32_t t = surfaces->first_triangle[body]; t < surfaces->first_triangle[body + 1];
         t++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t *corner = surfaces->triangles + 3 * (size_t)t;
            const uint32_t edge =
                cs_edge_find(surfaces->edges, surfaces->first_edge[body],
                             surfaces->first_edge[body + 1], corner[k], corner[(k + 1) % 3]);
            uint32_t *owners = surfaces->edge_triangles + 2 * (size_t)edge;
            owners[owners[0] == CS_NO_TRIANGLE ? 0 : 1] = t;
        }
}

/* Returns the range of a body, or an equivalent one for a collider: without particles if it has
 * no mesh. */
static struct cs_body_range range_of(const struct cs_system *system, uint32_t body,
                                     const struct cs_surfaces *surfaces) {
    const struct cs_collider *collider = cs_scene_collider_at(system->scene, body);
    if (!collider)
        return system->bodies[body];
    const struct cs_trimesh *mesh = collider->geometry;
    return (struct cs_body_range){.first = surfaces->first_point[body],
                                  .count = mesh ? mesh->n : 0,
                                  .columns = 1,
                                  .rows = 1,
                                  .mesh = mesh};
}

/* Fills triangles, edges and edge_triangles of one body. */
static void fill_body(const struct cs_system *system, uint32_t body,
                      struct cs_surfaces *surfaces) {
    const struct cs_body_range range = range_of(system, body, surfaces);
    const uint32_t first = surfaces->first_triangle[body];
    for (uint32_t t = 0; t < cs_faces_count(&range); t++) {
        uint32_t *corners = surfaces->triangles + 3 * (size_t)(first + t);
        cs_face_corners(&range, t, corners);
        for (size_t k = 0; k < 3; k++)
            corners[k] += range.first;
    }
    list_edges(&range, surfaces->edges + 2 * (size_t)surfaces->first_edge[body]);
    own_edges(surfaces, body);
}

/* Sets the first point, triangle and edge of each body, and the totals. */
static void count(const struct cs_system *system, struct cs_surfaces *surfaces) {
    for (uint32_t b = 0; b < surfaces->n_bodies; b++) {
        const struct cs_body_range range = range_of(system, b, surfaces);
        surfaces->first_point[b + 1] = surfaces->first_point[b] + range.count;
        surfaces->first_triangle[b + 1] = surfaces->first_triangle[b] + cs_faces_count(&range);
        surfaces->first_edge[b + 1] = surfaces->first_edge[b] + count_edges(&range);
    }
    surfaces->n_points = surfaces->first_point[surfaces->n_bodies];
    surfaces->n_triangles = surfaces->first_triangle[surfaces->n_bodies];
    surfaces->n_edges = surfaces->first_edge[surfaces->n_bodies];
}

enum cs_status cs_surfaces_build(struct cs_system *system, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    const uint32_t n_bodies = cs_scene_surfaces(system->scene);
    if (system->surfaces)
        return CS_OK;
    struct cs_surfaces *surfaces = cs_arena_alloc(arena, sizeof *surfaces, error);
    uint32_t *firsts =
        cs_arena_alloc_array(arena, 3 * ((size_t)n_bodies + 1), sizeof *firsts, error);
    if (error->status)
        return error->status;
    surfaces->n_bodies = n_bodies;
    surfaces->first_triangle = firsts;
    surfaces->first_edge = firsts + n_bodies + 1;
    surfaces->first_point = surfaces->first_edge + n_bodies + 1;
    count(system, surfaces);
    const size_t corners = 3 * (size_t)surfaces->n_triangles,
                 ends = 2 * (size_t)surfaces->n_edges;
    surfaces->triangles = cs_arena_alloc_array(arena, corners, sizeof(uint32_t), error);
    surfaces->edges = cs_arena_alloc_array(arena, ends, sizeof(uint32_t), error);
    surfaces->edge_triangles = cs_arena_alloc_array(arena, ends, sizeof(uint32_t), error);
    if (error->status)
        return error->status;
    for (size_t e = 0; e < ends; e++)
        surfaces->edge_triangles[e] = CS_NO_TRIANGLE;
    for (uint32_t b = 0; b < n_bodies; b++)
        fill_body(system, b, surfaces);
    system->surfaces = surfaces;
    return CS_OK;
}

void cs_surfaces_print_point(const struct cs_system *system, uint32_t point,
                             struct cs_text *out) {
    const struct cs_surfaces *surfaces = system->surfaces;
    const uint32_t body = cs_surfaces_body(surfaces->first_point, surfaces->n_bodies, point);
    if (point < system->view.n)
        cs_system_print_particle(system, point, out);
    else
        cs_text_add(out, "vertex %u of colliders[%u]", point - surfaces->first_point[body],
                    body - system->scene->bodies.n);
}
