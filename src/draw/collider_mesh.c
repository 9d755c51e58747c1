/* Makes meshes as they are, planes as squares, spheres as balls, boxes and capsules as cubes
 * blown up to balls and pulled apart.
 *
 * Each face of a cube has a grid of directions, evenly spaced by angle. A direction d stands
 * for the point sign(d) core + radius d of the surface. Where a component is 0 the grid has the
 * line twice, once of each sign, if the core has an extent there: the strips and faces between
 * them are the flat parts.
 */
#include "draw/collider_mesh.h"

#include "draw/matrix.h"
#include "draw/sphere_cap.h"
#include "mesh/trimesh.h"

/* lines of a face's grid between its middle and its rim, less one */
enum { PARTS = 8, LINES = 2 * (PARTS + 1) };

/* a line of the grid: its place before directions are made unit vectors, and its side */
struct line {
    double at, side;
};

static bool is_curved(const struct cs_posed_collider *obstacle) {
    return obstacle->kind == CS_COLLIDER_BOX || obstacle->kind == CS_COLLIDER_CAPSULE;
}

/* the lines along an axis; returns their number */
static uint32_t make_lines(double core, struct line lines[LINES]) {
    uint32_t n = 0;
    for (int k = -PARTS; k <= PARTS; k++) {
        const double angle = 3.14159265358979323846 / 4 * k / PARTS;
        const double at = k < 0 ? -cs_tangent(-angle) : cs_tangent(angle);
        if (k == 0 && core > 0)
            lines[n++] = (struct line){at, -1};
        lines[n++] = (struct line){at, k < 0 ? -1 : 1};
    }
    return n;
}

uint32_t cs_collider_mesh_count(const struct cs_posed_collider *obstacle) {
    uint32_t n[3], quads = 0;
    struct line lines[LINES];
    if (!obstacle->collider->visible)
        return 0;
    if (obstacle->kind == CS_COLLIDER_MESH)
        return 3 * obstacle->collider->mesh.geometry->n_triangles;
    if (!is_curved(obstacle))
        return obstacle->kind == CS_COLLIDER_PLANE ? 6 : CS_SPHERE_CAP_VERTICES;
    for (int k = 0; k < 3; k++)
        n[k] = make_lines(obstacle->half_sizes[k], lines) - 1;
    for (int k = 0; k < 3; k++)
        quads += 2 * n[k] * n[(k + 1) % 3];
    return 6 * quads;
}

/* a square about the point of a plane, seen from the side of its normal */
static void fill_square(const struct cs_posed_collider *plane, double sink,
                        struct cs_vertex out[6]) {
    static const signed char signs[6][2] = {{-1, -1}, {1, -1}, {1, 1},
                                            {-1, -1}, {1, 1},  {-1, 1}};
    const struct cs_collider *collider = plane->collider;
    const double extent =
        collider->plane.present ? collider->plane.extent : collider->floor.extent;
    const double *normal = plane->axes[1];
    for (int k = 0; k < 6; k++) {
        for (int i = 0; i < 3; i++) {
            const double side =
                signs[k][0] * plane->axes[2][i] + signs[k][1] * plane->axes[0][i];
            out[k].position[i] = (float)(plane->centre[i] + extent * side - sink * normal[i]);
            out[k].normal[i] = (float)normal[i];
        }
        out[k].value = 0;
    }
}

/* the vertex of a direction of a cube's face, whose components are on the given sides */
static void set_vertex(const struct cs_posed_collider *obstacle, const double direction[3],
                       const double sides[3], struct cs_vertex *out) {
    double d[3] = {direction[0], direction[1], direction[2]};
    cs_normalise(d);
    for (int i = 0; i < 3; i++) {
        double place = obstacle->centre[i], normal = 0;
        for (int k = 0; k < 3; k++) {
            place += (sides[k] * obstacle->half_sizes[k] + obstacle->radius * d[k]) *
                     obstacle->axes[k][i];
            normal += d[k] * obstacle->axes[k][i];
        }
        out->position[i] = (float)place;
        out->normal[i] = (float)normal;
    }
    out->value = 0;
}

/* one side (-1 or 1) of the cube across an axis */
static struct cs_vertex *fill_face(const struct cs_posed_collider *obstacle, int axis, int side,
                                   struct cs_vertex *out) {
    static const unsigned char corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    // right-handed with the outward direction, so that triangles turn the same way
    const int u = (axis + (side > 0 ? 1 : 2)) % 3, v = (axis + (side > 0 ? 2 : 1)) % 3;
    struct line lines[2][LINES];
    const uint32_t n_u = make_lines(obstacle->half_sizes[u], lines[0]);
    const uint32_t n_v = make_lines(obstacle->half_sizes[v], lines[1]);
    for (uint32_t i = 0; i + 1 < n_u; i++)
        for (uint32_t j = 0; j + 1 < n_v; j++)
            for (int k = 0; k < 6; k++) {
                const struct line *a = lines[0] + i + corners[k][0];
                const struct line *b = lines[1] + j + corners[k][1];
                double direction[3], sides[3];
                direction[axis] = sides[axis] = side;
                direction[u] = a->at, sides[u] = a->side;
                direction[v] = b->at, sides[v] = b->side;
                set_vertex(obstacle, direction, sides, out++);
            }
    return out;
}

/* each triangle with its own normal: a mesh that is met as it is shows its edges */
static void fill_triangle(const struct cs_posed_collider *obstacle, uint32_t t,
                          struct cs_vertex out[3]) {
    const struct cs_trimesh *mesh = obstacle->collider->mesh.geometry;
    double normal[3];
    cs_trimesh_normal(mesh, t, mesh->positions, mesh->n, 0, normal);
    cs_normalise(normal);
    for (int k = 0; k < 3; k++) {
        const double *own = mesh->positions + mesh->triangles[3 * (size_t)t + (size_t)k];
        for (int i = 0; i < 3; i++) {
            double place = obstacle->centre[i], turned = 0;
            for (size_t a = 0; a < 3; a++) {
                place += obstacle->axes[a][i] * own[a * mesh->n];
                turned += obstacle->axes[a][i] * normal[a];
            }
            out[k].position[i] = (float)place;
            out[k].normal[i] = (float)turned;
        }
        out[k].value = 0;
    }
}

static void fill_mesh(const struct cs_posed_collider *obstacle, struct cs_vertex *out) {
    for (uint32_t t = 0; t < obstacle->collider->mesh.geometry->n_triangles; t++)
        fill_triangle(obstacle, t, out + 3 * (size_t)t);
}

void cs_collider_mesh_fill(const struct cs_posed_collider *obstacle, double cell,
                           const float eye[4], struct cs_vertex *out) {
    if (obstacle->kind == CS_COLLIDER_PLANE)
        fill_square(obstacle, 0.03 * cell, out);
    if (obstacle->kind == CS_COLLIDER_SPHERE)
        cs_sphere_cap_fill(obstacle->centre, obstacle->radius, eye, out);
    if (obstacle->kind == CS_COLLIDER_MESH)
        fill_mesh(obstacle, out);
    for (int axis = 0; axis < 3 && is_curved(obstacle); axis++)
        for (int side = -1; side <= 1; side += 2)
            out = fill_face(obstacle, axis, side, out);
}
