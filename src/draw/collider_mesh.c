/* Makes spheres as balls, shapes with a core as smooth lattices, and all others of their
 * triangles, each with its own normal: a mesh that is met as it is shows its edges. */
#include "draw/collider_mesh.h"

#include "draw/matrix.h"
#include "draw/scene_extent.h"
#include "draw/sphere_cap.h"
#include "scene/shape_core.h"

/* lines of a face's grid between its middle and its rim, less one */
enum { PARTS = 8, LINES = 2 * (PARTS + 1) };

static bool is_ball(const struct cs_posed_collider *obstacle) {
    return obstacle->shape->bounds == CS_BOUNDS_SPHERE;
}

static enum cs_status make(struct cs_solid *solid, struct cs_arena *arena,
                           struct cs_error *error) {
    const struct cs_posed_collider *at = &solid->at;
    if (!at->collider->visible)
        return CS_OK;
    if (is_ball(at))
        solid->n = CS_SPHERE_CAP_VERTICES;
    else if (at->shape->is_core)
        solid->n = 6 * 6 * (LINES - 1) * (LINES - 1);
    else if (!at->shape->triangles(at, &solid->mesh, arena, error))
        solid->n = 3 * solid->mesh.n_triangles;
    return error->status;
}

enum cs_status cs_collider_geometry_init(struct cs_collider_geometry *solids,
                                         const struct cs_system *system,
                                         const struct cs_posed_collider *obstacles,
                                         struct cs_arena *arena, struct cs_error *error) {
    uint32_t most = 0;
    solids->n = system->scene->colliders.n;
    solids->cell = cs_scene_extent_cell(system);
    solids->of = cs_arena_alloc_array(arena, solids->n, sizeof *solids->of, error);
    for (uint32_t i = 0; i < solids->n && !error->status; i++) {
        solids->of[i].at = obstacles[i];
        make(solids->of + i, arena, error);
        most = solids->of[i].n > most ? solids->of[i].n : most;
    }
    solids->vertices = cs_arena_alloc_array(arena, most, sizeof *solids->vertices, error);
    return error->status;
}

bool cs_solid_move(struct cs_solid *solid, const struct cs_posed_collider *now) {
    const struct cs_posed_collider *at = &solid->at;
    const bool moved = memcmp(at->centre, now->centre, sizeof at->centre) ||
                       memcmp(at->axes, now->axes, sizeof at->axes);
    solid->at = *now;
    return moved;
}

/* place and normal in the own frame */
static void set_vertex(const struct cs_posed_collider *at, const double own[3],
                       const double normal[3], struct cs_vertex *out) {
    double place[3], turned[3];
    cs_collider_to_world(at, own, place);
    cs_collider_rotate(at, normal, turned);
    for (int i = 0; i < 3; i++) {
        out->position[i] = (float)place[i];
        out->normal[i] = (float)turned[i];
    }
    out->value = 0;
}

/* a line of the grid: its place before directions are made unit vectors, and its side */
struct line {
    double at, side;
};

/* one side (-1 or 1) of the cube across an axis */
static struct cs_vertex *fill_face(const struct cs_posed_collider *at,
                                   const struct line lines[LINES], int axis, int side,
                                   struct cs_vertex *out) {
    static const unsigned char corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    // right-handed with the outward direction, so that triangles turn the same way
    const int u = (axis + (side > 0 ? 1 : 2)) % 3, v = (axis + (side > 0 ? 2 : 1)) % 3;
    for (int i = 0; i + 1 < LINES; i++)
        for (int j = 0; j + 1 < LINES; j++)
            for (int k = 0; k < 6; k++) {
                const struct line *a = lines + i + corners[k][0];
                const struct line *b = lines + j + corners[k][1];
                double direction[3], sides[3], own[3];
                direction[axis] = sides[axis] = side;
                direction[u] = a->at, sides[u] = a->side;
                direction[v] = b->at, sides[v] = b->side;
                cs_core_surface(at, sides, direction, own);
                set_vertex(at, own, direction, out++);
            }
    return out;
}

static void fill_core(const struct cs_posed_collider *at, struct cs_vertex *out) {
    struct line lines[LINES];
    for (int k = 0; k <= PARTS; k++) {
        const double tangent = cs_tangent(3.14159265358979323846 / 4 * k / PARTS);
        lines[PARTS - k] = (struct line){-tangent, -1};
        lines[PARTS + 1 + k] = (struct line){tangent, 1};
    }
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2)
            out = fill_face(at, lines, axis, side, out);
}

static void fill_triangle(const struct cs_solid *solid, uint32_t t, double sink,
                          struct cs_vertex out[3]) {
    const struct cs_trimesh *mesh = &solid->mesh;
    double normal[3];
    cs_trimesh_normal(mesh, t, mesh->positions, mesh->n, 0, normal);
    cs_normalise(normal);
    for (size_t k = 0; k < 3; k++) {
        const double *from = mesh->positions + mesh->triangles[3 * (size_t)t + k];
        double own[3];
        for (size_t a = 0; a < 3; a++)
            own[a] = from[a * mesh->n] - sink * normal[a];
        set_vertex(&solid->at, own, normal, out + k);
    }
}

void cs_solids_fill(const struct cs_collider_geometry *solids, uint32_t i, const float eye[4]) {
    const struct cs_solid *solid = solids->of + i;
    const struct cs_posed_collider *at = &solid->at;
    const double sink = cs_shape_is_endless(at->shape) ? 0.03 * solids->cell : 0;
    if (is_ball(at))
        cs_sphere_cap_fill(at->centre, at->radius, eye, solids->vertices);
    else if (at->shape->is_core)
        fill_core(at, solids->vertices);
    for (uint32_t t = 0; t < solid->mesh.n_triangles; t++)
        fill_triangle(solid, t, sink, solids->vertices + 3 * (size_t)t);
}
