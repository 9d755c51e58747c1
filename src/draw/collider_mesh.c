/* Makes the drawn triangles of colliders: caps of spheres, smooth lattices of shapes with a
 * core, meshes with interpolated normals but for creases. Planes keep one normal. */
#include "draw/collider_mesh.h"

#include "draw/matrix.h"
#include "draw/view.h"
#include "scene/scene.h"
#include "scene/shape_core.h"

/* Makes the visible side of a sphere: rings about the line of sight, the last on
 * the outline.
 *
 * From distance D the lines of sight touch a sphere of radius r at the angle a from the axis,
 * with cos a = r / D; from far away cos a = 0. Rings are at a k / 16. All angles come from
 * halving,
 *   cos(t / 2) = sqrt((1 + cos t) / 2),   sin(t / 2) = sqrt((1 - cos t) / 2),
 * and from the addition theorems, so the vertices have the same bits on every machine. A round
 * outline matters more than a round inside: the outline has four times the corners. */

enum { STEP = CS_SPHERE_CAP_OUTLINE / CS_SPHERE_CAP_SECTORS }; // outline corners per sector

// cosine and sine of an angle
struct turn {
    double cosine, sine;
};

// a sphere and the directions that its vertices are made from
struct ball {
    const double *centre;
    double radius, across[3], third[3], along[3]; // unit vectors, the last towards the eye
    struct turn rings[CS_SPHERE_CAP_STACKS + 1];  // from the middle to the outline
    struct turn spokes[CS_SPHERE_CAP_OUTLINE];
    struct cs_vertex *out; // the next vertex
};

// half of an angle of 0..pi
static struct turn halved(struct turn t) {
    return (struct turn){sqrt((1 + t.cosine) / 2), sqrt((1 - t.cosine) / 2)};
}

// the sum of two angles
static struct turn sum(struct turn a, struct turn b) {
    return (struct turn){a.cosine * b.cosine - a.sine * b.sine,
                         a.sine * b.cosine + a.cosine * b.sine};
}

// the first n multiples of an angle, from 0 on
static void fill_turns(struct turn step, int n, struct turn *turns) {
    turns[0] = (struct turn){1, 0};
    for (int k = 1; k < n; k++)
        turns[k] = sum(turns[k - 1], step);
}

// sets the axis to the eye, and the angles of rings and spokes
static void aim(struct ball *ball, const float eye[4]) {
    const double far = (double)eye[3];
    for (int i = 0; i < 3; i++)
        ball->along[i] = (double)eye[i] - far * ball->centre[i];
    const double distance = cs_vec3_length(ball->along);
    cs_normalise(ball->along);
    cs_frame_from_direction(ball->along, ball->across, ball->third);
    // the outline is where sight touches the sphere
    const double least = far > 0 ? ball->radius : 0;
    const double cosine = distance > least ? least / distance : -1;
    struct turn ring = {cosine, 0}, spoke = {0, 1};
    for (int n = CS_SPHERE_CAP_STACKS; n > 1; n /= 2)
        ring = halved(ring);
    for (int n = CS_SPHERE_CAP_OUTLINE; n > 4; n /= 2)
        spoke = halved(spoke);
    fill_turns(ring, CS_SPHERE_CAP_STACKS + 1, ball->rings);
    fill_turns(spoke, CS_SPHERE_CAP_OUTLINE, ball->spokes);
}

// the vertex on a ring and a spoke
static void add_vertex(struct ball *ball, int ring, int spoke) {
    const struct turn out = ball->rings[ring],
                      around = ball->spokes[spoke % CS_SPHERE_CAP_OUTLINE];
    struct cs_vertex *vertex = ball->out++;
    for (int i = 0; i < 3; i++) {
        const double side = around.cosine * ball->across[i] + around.sine * ball->third[i];
        const double d = out.cosine * ball->along[i] + out.sine * side;
        vertex->position[i] = (float)(ball->centre[i] + ball->radius * d);
        vertex->normal[i] = (float)d;
    }
    vertex->value = 0;
}

// triangles between two spokes and two rings, the outer side divided into `parts`
static void add_cell(struct ball *ball, int ring, int spoke, int parts) {
    for (int k = 0; k < parts; k++) {
        add_vertex(ball, ring, spoke);
        add_vertex(ball, ring + 1, spoke + k * (STEP / parts));
        add_vertex(ball, ring + 1, spoke + (k + 1) * (STEP / parts));
    }
    // in the middle the inner side is a point
    if (ring == 0)
        return;
    add_vertex(ball, ring, spoke);
    add_vertex(ball, ring + 1, spoke + STEP);
    add_vertex(ball, ring, spoke + STEP);
}

/* Fills CS_SPHERE_CAP_VERTICES vertices, three per triangle, counter-clockwise seen from
 * outside. They cover the part of a sphere (m) that is visible from eye: a position and 1, or
 * the direction to an eye far away and 0. An eye inside gets the whole sphere. */
static void fill_cap(const double centre[3], double radius, const float eye[4],
                     struct cs_vertex *out) {
    struct ball ball = {.centre = centre, .radius = radius, .out = out};
    aim(&ball, eye);
    for (int ring = 0; ring < CS_SPHERE_CAP_STACKS; ring++)
        for (int spoke = 0; spoke < CS_SPHERE_CAP_OUTLINE; spoke += STEP)
            add_cell(&ball, ring, spoke, ring + 1 < CS_SPHERE_CAP_STACKS ? 1 : STEP);
}

/* steps of angle from the middle of a cube's face to its border; lines of its grid, of which
 * the middle one is double (shape_core.h) */
enum { PARTS = 8, LINES = 2 * (PARTS + 1) };

static bool is_ball(const struct cs_posed_collider *collider) {
    return collider->shape->bounds == CS_BOUNDS_SPHERE;
}

// the collider at this time; the last one may be the ground
static const struct cs_posed_collider *pose_of(const struct cs_collider_geometry *geometries,
                                               const struct cs_posed_collider *colliders,
                                               uint32_t i) {
    return geometries->ground->present && i + 1 == geometries->n ? &geometries->ground->pose
                                                                 : colliders + i;
}

/* Enlarges the square of a floor until haze hides its edges; a tilted one lies over less. */
static void extend(struct cs_solid *solid, const struct cs_ground *ground) {
    const struct cs_ground_style *style = &ground->style;
    const double *centre = solid->collider.centre;
    const double aside = fmax(fabs(centre[0] - (double)style->centre[0]),
                              fabs(centre[2] - (double)style->centre[1]));
    const double half = ((double)style->radius + aside) / solid->collider.axes[1][1];
    const double factor = half / fabs(solid->mesh.positions[0]);
    for (uint32_t k = 0; cs_ground_is(ground, &solid->collider) && k < 3 * solid->mesh.n; k++)
        solid->mesh.positions[k] *= factor;
}

/* Fills the unit normals of a mesh's corners: of each the sum of the normals, by area, of the
 * triangles at its vertex that lean by less than 40 degrees from its own. */
static void fill_normals(struct cs_solid *solid) {
    const double crease = 0.77; // cosine of 40 degrees
    const struct cs_trimesh *mesh = &solid->mesh;
    for (uint32_t c = 0; solid->normals && c < 3 * mesh->n_triangles; c++) {
        const uint32_t i = mesh->triangles[c];
        double own[3], *sum = solid->normals + 3 * (size_t)c;
        cs_trimesh_normal(mesh, c / 3, mesh->positions, mesh->n, 0, own);
        memcpy(sum, own, sizeof own);
        for (uint32_t k = cs_trimesh_around_begin(mesh, i); k < mesh->vertex_triangles_end[i];
             k++) {
            const uint32_t t = mesh->vertex_triangles[k];
            double other[3];
            cs_trimesh_normal(mesh, t, mesh->positions, mesh->n, 0, other);
            const bool smooth =
                cs_vec3_dot(own, other) > crease * cs_vec3_length(own) * cs_vec3_length(other);
            for (int a = 0; a < 3 && smooth && t != c / 3; a++)
                sum[a] += other[a];
        }
        cs_normalise(sum);
    }
}

/* Counts the vertices of a collider, and makes its triangles if they are drawn. */
static enum cs_status make(struct cs_solid *solid, struct cs_arena *arena,
                           struct cs_error *error) {
    const struct cs_posed_collider *collider = &solid->collider;
    if (!collider->collider->visible)
        return CS_OK;
    if (is_ball(collider))
        solid->n = CS_SPHERE_CAP_VERTICES;
    else if (collider->shape->is_core)
        solid->n = 6 * 6 * (LINES - 1) * (LINES - 1);
    else if (!collider->shape->triangles(collider, &solid->mesh, arena, error))
        solid->n = 3 * solid->mesh.n_triangles;
    if (solid->mesh.vertex_triangles)
        CS_ARENA_ARRAY(arena, solid->normals, 3 * (size_t)solid->n, error);
    fill_normals(solid);
    return error->status;
}

enum cs_status cs_collider_geometry_init(struct cs_collider_geometry *geometries,
                                         const struct cs_system *system,
                                         const struct cs_posed_collider *colliders,
                                         const struct cs_ground *ground, struct cs_arena *arena,
                                         struct cs_error *error) {
    uint32_t most = 0;
    geometries->n = system->scene->colliders.n + ground->present;
    geometries->ground = ground;
    geometries->cell = cs_scene_extent_cell(system);
    geometries->of = cs_arena_alloc_array(arena, geometries->n, sizeof *geometries->of, error);
    for (uint32_t i = 0; i < geometries->n && !error->status; i++) {
        geometries->of[i].collider = *pose_of(geometries, colliders, i);
        if (!make(geometries->of + i, arena, error) && geometries->of[i].mesh.n)
            extend(geometries->of + i, ground);
        most = geometries->of[i].n > most ? geometries->of[i].n : most;
    }
    CS_ARENA_ARRAY(arena, geometries->vertices, most, error);
    return error->status;
}

/* Takes a collider's pose and key frame; returns true if it has moved, turned, grown or
 * deformed. */
static bool move_solid(struct cs_solid *solid, const struct cs_posed_collider *now) {
    const struct cs_posed_collider *collider = &solid->collider;
    const bool deformed = memcmp(&collider->path.t, &now->path.t, sizeof collider->path.t);
    const bool moved = deformed ||
                       memcmp(collider->centre, now->centre, sizeof collider->centre) ||
                       memcmp(collider->axes, now->axes, sizeof collider->axes) ||
                       collider->radius != now->radius;
    solid->collider = *now;
    if (deformed && solid->n > 0) {
        cs_collider_mesh_vertices(now, solid->mesh.positions);
        fill_normals(solid);
    }
    return moved;
}

bool cs_collider_geometry_move(struct cs_collider_geometry *geometries,
                               const struct cs_posed_collider *now) {
    bool moved = false;
    for (uint32_t i = 0; i < geometries->n; i++)
        moved = move_solid(geometries->of + i, pose_of(geometries, now, i)) || moved;
    return moved;
}

void cs_collider_geometry_style(const struct cs_collider_geometry *geometries, uint32_t i,
                                struct cs_surface_style *style) {
    cs_style_solid(style, &geometries->of[i].collider, geometries->cell);
    cs_ground_style_of(geometries->ground, &geometries->of[i].collider, style);
}

/* Writes a vertex whose position and normal are given in the own frame. */
static void set_vertex(const struct cs_posed_collider *collider, const double own[3],
                       const double normal[3], struct cs_vertex *out) {
    double place[3], turned[3];
    cs_collider_to_world(collider, own, place);
    cs_collider_rotate(collider, normal, turned);
    for (int i = 0; i < 3; i++) {
        out->position[i] = (float)place[i];
        out->normal[i] = (float)turned[i];
    }
    out->value = 0;
}

/* a line of the grid: its coordinate on the cube before normalisation, and its sign */
struct line {
    double at, side;
};

/* Fills the face of the cube on one side (-1 or 1) of an axis; returns the next vertex. */
static struct cs_vertex *fill_face(const struct cs_posed_collider *collider,
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
                cs_core_surface(collider, sides, direction, own);
                set_vertex(collider, own, direction, out++);
            }
    return out;
}

/* Fills the six faces; lines are evenly spaced by angle. */
static void fill_core(const struct cs_posed_collider *collider, struct cs_vertex *out) {
    struct line lines[LINES];
    for (int k = 0; k <= PARTS; k++) {
        const double tangent = cs_tangent(3.14159265358979323846 / 4 * k / PARTS);
        lines[PARTS - k] = (struct line){-tangent, -1};
        lines[PARTS + 1 + k] = (struct line){tangent, 1};
    }
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2)
            out = fill_face(collider, lines, axis, side, out);
}

/* Fills a triangle with its own normal or those of its corners, moved back by `sink` m. */
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
        set_vertex(&solid->collider, own,
                   solid->normals ? solid->normals + 3 * (3 * (size_t)t + k) : normal, out + k);
    }
}

void cs_solids_fill(const struct cs_collider_geometry *geometries, uint32_t i,
                    const float eye[4]) {
    const struct cs_solid *solid = geometries->of + i;
    const struct cs_posed_collider *collider = &solid->collider;
    const double sink = cs_shape_is_endless(collider->shape) ? 0.03 * geometries->cell : 0;
    if (is_ball(collider))
        fill_cap(collider->centre, collider->radius, eye, geometries->vertices);
    else if (collider->shape->is_core)
        fill_core(collider, geometries->vertices);
    for (uint32_t t = 0; t < solid->mesh.n_triangles; t++)
        fill_triangle(solid, t, sink, geometries->vertices + 3 * (size_t)t);
    // the ground hides nothing from an eye below it
    if (collider->collider == &geometries->ground->collider &&
        (double)eye[1] <= (eye[3] > 0 ? collider->centre[1] : 0))
        memset(geometries->vertices, 0, solid->n * sizeof *geometries->vertices);
}
