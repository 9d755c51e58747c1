/* Makes colliders of triangles: each in its own frame once, then placed at every sample. */
#include "export/solids.h"

#include "base/little.h"

static void fill(struct cs_skin *skin, uint32_t item, const struct cs_trimesh *mesh) {
    const uint32_t first = skin->first_point[item];
    for (size_t i = 0; i < mesh->n; i++)
        for (size_t k = 0; k < 3; k++)
            skin->own[3 * (first + i) + k] = mesh->places[k * mesh->n + i];
    uint32_t *corner = skin->triangles + 3 * (size_t)skin->first_triangle[item];
    for (size_t k = 0; k < 3 * (size_t)mesh->n_triangles; k++)
        corner[k] = first + mesh->triangles[k];
}

/* meshes (colliders.n) of those that are visible */
static enum cs_status join(struct cs_skin *skin, const struct cs_obstacle *obstacles,
                           const struct cs_trimesh *meshes, struct cs_arena *arena,
                           struct cs_error *error) {
    skin->own = cs_arena_take_n(arena, skin->n, 3 * sizeof *skin->own, error);
    if (cs_skin_take(skin, false, arena, error))
        return error->status;
    for (uint32_t k = 0, item = 0; item < skin->n_items; k++) {
        if (!obstacles[k].collider->visible)
            continue;
        skin->items[item] = k;
        skin->first_point[item + 1] = skin->first_point[item] + meshes[k].n;
        skin->first_triangle[item + 1] = skin->first_triangle[item] + meshes[k].n_triangles;
        fill(skin, item++, meshes + k);
    }
    return CS_OK;
}

enum cs_status cs_skin_of_colliders(struct cs_skin *skin, const struct cs_system *system,
                                    struct cs_arena *arena, struct cs_error *error) {
    const uint32_t n = system->scene->colliders.n;
    struct cs_arena making = {0};
    struct cs_obstacle *obstacles = cs_arena_take_n(&making, n, sizeof *obstacles, error);
    struct cs_trimesh *meshes = cs_arena_take_n(&making, n, sizeof *meshes, error);
    *skin = (struct cs_skin){
        .name = "colliders", .item = "collider", .moves = system->motions != NULL};
    if (!error->status)
        cs_obstacles_at(system, 0, obstacles);
    for (uint32_t k = 0; k < n && !error->status; k++) {
        if (!obstacles[k].collider->visible ||
            obstacles[k].shape->triangles(obstacles + k, meshes + k, &making, error))
            continue;
        skin->n += meshes[k].n;
        skin->n_triangles += meshes[k].n_triangles;
        skin->n_items++;
    }
    if (!error->status)
        join(skin, obstacles, meshes, arena, error);
    cs_arena_finish(&making);
    return error->status;
}

void cs_skin_place_colliders(struct cs_skin *skin, const struct cs_system *system, double t) {
    uint64_t *out = skin->fields[0].words;
    for (uint32_t item = 0; item < skin->n_items; item++) {
        struct cs_obstacle at;
        cs_obstacle_at(system, skin->items[item], t, &at);
        for (size_t i = skin->first_point[item]; i < skin->first_point[item + 1]; i++) {
            double place[3];
            cs_obstacle_place(&at, skin->own + 3 * i, place);
            for (size_t c = 0; c < 3; c++)
                out[3 * i + c] = cs_little_double(place[c]);
        }
    }
}
