/* Colliders as triangles: on the surface, outwards, closed, of the right volume. */
#include "base/vec3.h"
#include "draw/collider_mesh.h"
#include "mesh/trimesh.h"
#include "scene/collider_keys.h"
#include "scene/mesh_keys.h"

#include "unit.h"

#include <math.h>

static struct cs_collider colliders[] = {
    {.box = {true, {0.2, 0.1, -0.3}, {0.8, 0.5, 0.6}, {0.5, 0.5, 0.5, 0.5}, 0.06},
     .visible = true},
    {.capsule = {true, {-0.2, 0.1, 0.3}, {0.4, 0.5, -0.1}, 0.12}, .visible = true},
    // as round as can be: a capsule, and a ball
    {.box = {true, {0, 0, 0}, {0.4, 0.4, 1}, {0, 0, 0, 1}, 0.2}, .visible = true},
    {.box = {true, {0, 0, 0}, {0.4, 0.4, 0.4}, {0.6, 0, 0, 0.8}, 0.2}, .visible = true},
    {.plane = {true, {0.1, 0.2, 0.3}, {0.6, 0.8, 0}, 2}, .visible = true},
    {.floor = {true, 0.25, 3}, .visible = true},
    {.sphere = {true, {0, 0, 0}, 1}, .visible = true},
    {.floor = {true, 0.25, 3}, .visible = false},
};
enum { RADIUS = 7 }; // m, of the haze
enum { CURVED = 4, PLANE = 4, FLOOR, SPHERE, HIDDEN, N_COLLIDERS };

static struct cs_scene scene = {.colliders = {colliders, N_COLLIDERS}};
static const struct cs_system rest = {.scene = &scene};
static const float camera[4] = {0, 0, 5, 1};

static struct cs_arena arena;
static struct cs_collider_geometry geometries;

/* the vertices of one collider under cells of 0.02 m, in the arena; returns their number */
static uint32_t fill(const struct cs_posed_collider *of, const float eye[4]) {
    struct cs_error error = {0};
    struct cs_scene alone = {.colliders = {colliders, 1}};
    static const struct cs_ground no_ground = {.style.radius = RADIUS};
    cs_collider_geometry_init(&geometries, &(struct cs_system){.scene = &alone}, of, &no_ground,
                              &arena, &error);
    UNIT_ASSERT_OK(&error);
    geometries.cell = 0.02;
    if (geometries.of[0].n)
        cs_solids_fill(&geometries, 0, eye);
    return geometries.of[0].n;
}

static struct cs_vertex *make(uint32_t k, struct cs_posed_collider *of, uint32_t *n) {
    cs_posed_collider_at(&rest, k, 0, of);
    *n = fill(of, camera);
    return geometries.vertices;
}

/* distance 0 but for the floats, and the normal of the surface there */
TEST(vertices_lie_on_the_surface) {
    for (uint32_t k = 0; k < CURVED; k++) {
        struct cs_posed_collider of;
        uint32_t n;
        struct cs_vertex *vertices = make(k, &of, &n);
        ck_assert(n > 1000 && n % 3 == 0);
        for (uint32_t i = 0; i < n; i++) {
            double p[3], normal[3];
            for (int c = 0; c < 3; c++)
                p[c] = (double)vertices[i].position[c];
            ck_assert_double_eq_tol(cs_posed_collider_distance(&of, p, normal), 0, 1e-7);
            for (int c = 0; c < 3; c++)
                ck_assert_double_eq_tol((double)vertices[i].normal[c], normal[c], 3e-6);
        }
    }
}

/* Six times the volume under each triangle seen from the origin: the sum is that of the whole
 * only if the surface is closed and its triangles all turn outwards. Inscribed, it holds less.
 */
TEST(volume_is_that_of_the_solid) {
    const double pi = acos(-1), h[3] = {0.68, 0.38, 0.48}, r = 0.06;
    const double length = sqrt(0.36 + 0.16 + 0.16);
    const double volumes[CURVED] = {
        // Steiner: the core, slabs on its faces, quarter rods on its edges, a ball on its
        // corners
        h[0] * h[1] * h[2] + 2 * r * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0]) +
            pi * r * r * (h[0] + h[1] + h[2]) + 4 * pi / 3 * r * r * r,
        pi * 0.0144 * length + 4 * pi / 3 * 0.12 * 0.12 * 0.12,
        pi * 0.04 * 0.6 + 4 * pi / 3 * 0.008, 4 * pi / 3 * 0.008};
    for (uint32_t k = 0; k < CURVED; k++) {
        struct cs_posed_collider of;
        uint32_t n;
        struct cs_vertex *v = make(k, &of, &n);
        double six = 0;
        for (uint32_t i = 0; i < n; i += 3) {
            double p[3][3];
            for (uint32_t j = 0; j < 3; j++)
                for (int c = 0; c < 3; c++)
                    p[j][c] = (double)v[i + j].position[c];
            six += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                   p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                   p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        }
        ck_assert_double_le(six / 6, volumes[k]);
        ck_assert_double_ge(six / 6, 0.99 * volumes[k]);
    }
}

/* A tilted plane is as large as the scene says; a level floor hides its edges in the haze. */
TEST(planes_are_squares) {
    static const uint32_t list[] = {PLANE, FLOOR};
    static const double extents[] = {2, RADIUS};
    for (size_t k = 0; k < 2; k++) {
        struct cs_posed_collider of;
        uint32_t n;
        struct cs_vertex *v = make(list[k], &of, &n);
        ck_assert_uint_eq(n, 6);
        for (uint32_t i = 0; i < n; i++) {
            double p[3], normal[3], squared = 0;
            for (int c = 0; c < 3; c++) {
                p[c] = (double)v[i].position[c];
                squared += (p[c] - of.centre[c]) * (p[c] - of.centre[c]);
            }
            // 3 % of a cell below the plane
            ck_assert_double_eq_tol(cs_posed_collider_distance(&of, p, normal), -0.0006, 1e-6);
            ck_assert_double_eq_tol(squared, 2 * extents[k] * extents[k], 1e-5);
        }
    }
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* corners of a triangle from the middle of a sphere */
static void take(const struct cs_vertex *v, double p[3][3]) {
    for (int j = 0; j < 3; j++)
        for (int c = 0; c < 3; c++)
            p[j][c] = (double)v[j].position[c];
}

/* twice the area of a triangle, as a vector to its outside */
static void area_of(double p[3][3], double area[3]) {
    for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        area[c] = (p[1][d] - p[0][d]) * (p[2][e] - p[0][e]) -
                  (p[1][e] - p[0][e]) * (p[2][d] - p[0][d]);
    }
}

/* From afar the triangles lie side by side within the outline, a regular polygon, all facing
 * the eye: what they cover along the line of sight is its area. */
TEST(a_ball_covers_its_outline) {
    static const float light[4] = {0.6f, 0, 0.8f, 0};
    const double to[3] = {(double)light[0], (double)light[1], (double)light[2]};
    struct cs_posed_collider of;
    struct cs_vertex *v;
    double sum = 0;
    cs_posed_collider_at(&rest, SPHERE, 0, &of);
    ck_assert_uint_eq(fill(&of, light), CS_SPHERE_CAP_VERTICES);
    v = geometries.vertices;
    for (uint32_t i = 0; i < CS_SPHERE_CAP_VERTICES; i += 3) {
        double p[3][3], area[3];
        take(v + i, p);
        area_of(p, area);
        ck_assert_double_gt(dot(area, to), 0);
        sum += dot(area, to) / 2;
    }
    const double turn = 2 * acos(-1) / CS_SPHERE_CAP_OUTLINE;
    ck_assert_double_eq_tol(sum, 0.5 * CS_SPHERE_CAP_OUTLINE * sin(turn), 1e-5);
}

/* From a place at twice the radius: all points lie on the sphere on this side of the circle
 * where sight touches it, and the outline on that circle: (p - c) . (eye - p) = 0. */
TEST(a_ball_ends_where_sight_touches_it) {
    static const float eye[4] = {1.2f, 1.6f, 0, 1};
    struct cs_posed_collider of;
    const struct cs_vertex *v;
    uint32_t outline = 0;
    cs_posed_collider_at(&rest, SPHERE, 0, &of);
    fill(&of, eye);
    v = geometries.vertices;
    for (uint32_t i = 0; i < CS_SPHERE_CAP_VERTICES; i += 3) {
        double p[3][3];
        take(v + i, p);
        for (int j = 0; j < 3; j++) {
            double visibility = 0;
            for (int c = 0; c < 3; c++) {
                visibility += p[j][c] * ((double)eye[c] - p[j][c]);
                ck_assert_double_eq_tol((double)v[i + (uint32_t)j].normal[c], p[j][c], 1e-6);
            }
            ck_assert_double_eq_tol(dot(p[j], p[j]), 1, 1e-6);
            ck_assert_double_ge(visibility, -1e-6);
            outline += visibility < 1e-6;
        }
    }
    // each chord of the outline has a triangle of its own, each spoke's end one more
    ck_assert_uint_eq(outline, 2 * CS_SPHERE_CAP_OUTLINE + CS_SPHERE_CAP_SECTORS);
}

/* From within, the whole of it is there: its volume, as above. */
TEST(a_ball_is_whole_from_within) {
    static const float eye[4] = {0.1f, 0.2f, 0.3f, 1};
    struct cs_posed_collider of;
    const struct cs_vertex *v;
    double six = 0;
    cs_posed_collider_at(&rest, SPHERE, 0, &of);
    fill(&of, eye);
    v = geometries.vertices;
    for (uint32_t i = 0; i < CS_SPHERE_CAP_VERTICES; i += 3) {
        double p[3][3], area[3];
        take(v + i, p);
        area_of(p, area);
        six += dot(p[0], area);
    }
    ck_assert_double_le(six / 6, 4 * acos(-1) / 3);
    ck_assert_double_ge(six / 6, 0.98 * 4 * acos(-1) / 3);
}

/* a box of side 1, turned and moved: each triangle where it is met, closed, of volume 1; and
 * what a line meets of it */
TEST(a_mesh_is_as_it_is) {
    struct cs_error error = {0};
    struct cs_trimesh mesh = {0};
    cs_trimesh_make(&mesh, CS_MESH_BOX, 3, &arena, &error);
    cs_trimesh_finish(&mesh, "box", NULL, &arena, &error);
    UNIT_ASSERT_OK(&error);
    struct cs_mesh_source source = {
        .present = true,
        .place = {{3, -1, 2}, .rotate = {0.6, 0, 0, 0.8}, .matrix = {(double)NAN}}};
    struct cs_collider collider = {.mesh = &source, .geometry = &mesh, .visible = true};
    struct cs_scene of_mesh = {.colliders = {&collider, 1}};
    struct cs_posed_collider of;
    cs_posed_collider_at(&(struct cs_system){.scene = &of_mesh}, 0, 0, &of);
    const uint32_t n = fill(&of, camera);
    ck_assert_uint_eq(n, 3 * mesh.n_triangles);
    const struct cs_vertex *vertices = geometries.vertices;
    double volume = 0;
    for (uint32_t t = 0; t < n; t += 3) {
        double p[3][3], height = 0, cross[3];
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++)
                p[k][c] = (double)vertices[t + (uint32_t)k].position[c] -
                          collider.mesh->place.translate[c];
        cs_vec3_cross(p[1], p[2], cross);
        volume += cs_vec3_dot(p[0], cross) / 6;
        // a face of the box is half a side away from its middle, along the normal
        for (int c = 0; c < 3; c++)
            height += (double)vertices[t].normal[c] * p[0][c];
        ck_assert_double_eq_tol(height, 0.5, 1e-6);
    }
    ck_assert_double_eq_tol(volume, 1, 1e-6);
    const double from[3] = {3, -1, 7}, way[3] = {0, 0, -6}, beside[3] = {3.8, -1, 7};
    // the box is turned by 73.7 degrees about x: its side is 0.5/cos(16.3 degrees) high there
    const double gap = (5 - 0.5 / 0.96) / 6;
    ck_assert(cs_posed_collider_hits_segment(&of, from, way, 1));
    ck_assert(cs_posed_collider_hits_segment(&of, from, way, gap + 1e-6));
    ck_assert(!cs_posed_collider_hits_segment(&of, from, way, gap - 1e-6));
    ck_assert(!cs_posed_collider_hits_segment(&of, beside, way, 1));
}

TEST(hidden_ones_have_no_triangles) {
    struct cs_posed_collider of;
    cs_posed_collider_at(&rest, HIDDEN, 0, &of);
    ck_assert_uint_eq(fill(&of, camera), 0);
}
