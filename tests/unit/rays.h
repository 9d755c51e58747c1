/* rays.h - a scene with obstacles, and whether a particle of it is seen by a ray test over
 * every triangle and obstacle. */
#ifndef CS_TEST_RAYS_H
#define CS_TEST_RAYS_H

#include "model/event/event_state.h"

#include "mesh/trimesh.h"
#include "model/contact/posed_collider.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"
#include "sheet.h"

/* two cloths, a closed mesh, and obstacles of every kind; %s: keys of the last sphere */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [13, 9]}, \"mass\": {\"total\": 1}},"                \
    " {\"mesh\": {\"shape\": \"sphere\", \"detail\": 4, \"place\":"                            \
    " {\"translate\": [0.3, 0.2, -0.6]}}, \"mass\": {\"total\": 1}},"                          \
    " {\"cloth\": {\"grid\": [6, 17], \"place\": {\"translate\": [0, 0, -1.2]}},"              \
    " \"mass\": {\"total\": 1}}],"                                                             \
    " \"colliders\": [{\"sphere\": {\"centre\": [0.2, -0.1, 0.3], \"radius\": 0.2}},"          \
    " {\"plane\": {\"point\": [0, -0.4, 0], \"normal\": [0.1, 1, -0.2]}}, {\"floor\": "        \
    "{\"height\": -0.45}},"                                                                    \
    " {\"sphere\": {\"centre\": [0, 0, 0.5], \"radius\": 3}, \"visible\": false},"             \
    " {\"box\": {\"centre\": [-0.4, 0.3, 0.2], \"size\": [0.3, 0.2, 0.4],"                     \
    " \"rotate\": [0.1, 0.4, 0.2, 0.9], \"radius\": 0.04}},"                                   \
    " {\"capsule\": {\"from\": [0.3, 0.4, 0.2], \"to\": [0.1, 0, 0.6], \"radius\": 0.06}}]}"

static inline double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross(const double a[3], const double b[3], double out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

/* a look at one particle: whether it is seen, and how clearly the least clear of all tests was
 * passed */
struct verdict {
    bool seen;
    double margin;
};

static inline void require(struct verdict *verdict, double by) {
    verdict->seen &= by > 0;
    verdict->margin = fmin(verdict->margin, fabs(by));
}

/* Moeller and Trumbore 1997: the ray from eye along way meets the triangle at share t of it */
static inline void look_past_triangle(struct verdict *verdict, const struct sheet *sheet,
                                      const uint32_t corners[3], const double eye[3],
                                      const double way[3]) {
    double p[3][3], a[3], b[3], s[3], h[3], q[3];
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++)
            p[k][c] = sheet->x[c * sheet->n + corners[k]];
    for (int c = 0; c < 3; c++) {
        a[c] = p[1][c] - p[0][c];
        b[c] = p[2][c] - p[0][c];
        s[c] = eye[c] - p[0][c];
    }
    cross(way, b, h);
    cross(s, a, q);
    const double f = 1 / dot(a, h), u = f * dot(s, h), v = f * dot(way, q), t = f * dot(b, q);
    const double inside = fmin(fmin(u, v), fmin(1 - u - v, fmin(t, 1 - t)));
    require(verdict, -inside);
}

static inline void look_past_triangles(struct verdict *verdict, const struct sheet *sheet,
                                       uint32_t i, const double eye[3], const double way[3]) {
    const struct cs_body_range *bodies = sheet->system.bodies;
    for (uint32_t b = 0; b < 3; b++) {
        const uint32_t columns = bodies[b].columns, first = bodies[b].first;
        const uint32_t cells = b == 1 ? 0 : (columns - 1) * (bodies[b].rows - 1);
        const uint32_t n = b == 1 ? bodies[b].mesh->n_triangles : 2 * cells;
        for (uint32_t t = 0; t < n; t++) {
            uint32_t corners[3];
            const uint32_t cell = t % (cells ? cells : 1);
            const uint32_t at = first + cell + (b == 1 ? 0 : cell / (columns - 1));
            for (size_t k = 0; k < 3; k++)
                corners[k] = b == 1      ? first + bodies[b].mesh->triangles[3 * (size_t)t + k]
                             : t < cells ? at + (k == 1) + columns * (k == 2)
                                         : at + columns + (k == 1) + (k == 2) * (1 - columns);
            if (i != corners[0] && i != corners[1] && i != corners[2])
                look_past_triangle(verdict, sheet, corners, eye, way);
        }
    }
}

/* the least distance of a convex obstacle from the way: by thirds, for it is convex too */
static inline double least_distance(const struct cs_posed_collider *of, const double eye[3],
                                    const double way[3]) {
    double low = 0, high = 1, d[2] = {0, 0};
    for (int k = 0; k < 100; k++) {
        const double at[2] = {low + (high - low) / 3, high - (high - low) / 3};
        for (int s = 0; s < 2; s++) {
            double n[3];
            const double p[3] = {eye[0] + at[s] * way[0], eye[1] + at[s] * way[1],
                                 eye[2] + at[s] * way[2]};
            d[s] = cs_posed_collider_distance(of, p, n);
        }
        *(d[0] < d[1] ? &high : &low) = d[0] < d[1] ? at[1] : at[0];
    }
    return fmin(d[0], d[1]);
}

static inline void look_past_obstacles(struct verdict *verdict, const struct sheet *sheet,
                                       const double eye[3], const double way[3]) {
    const struct cs_collider *colliders = cs_scene_colliders(&sheet->scene);
    const struct cs_sphere *sphere = &colliders[0].sphere;
    /* |eye + t way - centre| = radius */
    double to[3];
    for (int c = 0; c < 3; c++)
        to[c] = eye[c] - sphere->centre[c];
    const double a = dot(way, way), b = dot(way, to),
                 c = dot(to, to) - sphere->radius * sphere->radius;
    const double inside = b * b - a * c, root = sqrt(fmax(inside, 0));
    const double enters = (-b - root) / a, leaves = (-b + root) / a;
    require(verdict, inside < 0 ? -inside : fmax(enters - 1, -leaves));

    const double normal[3] = {colliders[1].plane.normal[0], colliders[1].plane.normal[1],
                              colliders[1].plane.normal[2]};
    double end[3];
    for (int k = 0; k < 3; k++)
        end[k] = eye[k] + way[k];
    require(verdict, dot(eye, normal) + 0.4 * normal[1]);
    require(verdict, dot(end, normal) + 0.4 * normal[1]);
    require(verdict, eye[1] + 0.45);
    require(verdict, end[1] + 0.45);
    for (uint32_t k = 4; k < 6; k++) {
        struct cs_posed_collider of;
        cs_posed_collider_at(&sheet->system, k, 0, &of);
        require(verdict, least_distance(&of, eye, way));
    }
}

static inline struct verdict look_at(const struct sheet *sheet,
                                     const struct cs_viewpoint_force *viewpoint_force,
                                     uint32_t i) {
    struct verdict verdict = {true, 1};
    const struct cs_viewpoint *from = &viewpoint_force->viewpoint;
    double eye[3], way[3], view[3], right[3], up[3];
    for (size_t c = 0; c < 3; c++) {
        eye[c] = from->eye[c];
        view[c] = from->target[c] - eye[c];
        way[c] = sheet->x[c * sheet->n + i] - eye[c];
        up[c] = from->up[c];
    }
    cross(view, up, right);
    cross(right, view, up);
    /* shares of the picture */
    const double slope = tan(from->fov * 3.14159265358979323846 / 360);
    const double depth = dot(way, view) / dot(view, view);
    const double length = sqrt(dot(view, view));
    const double across = 0.5 + dot(way, right) / sqrt(dot(right, right)) /
                                    (2 * depth * length * slope * from->aspect);
    const double down = 0.5 - dot(way, up) / sqrt(dot(up, up)) / (2 * depth * length * slope);
    require(&verdict, depth);
    require(&verdict, across - viewpoint_force->rectangle[0]);
    require(&verdict, viewpoint_force->rectangle[2] - across);
    require(&verdict, down - viewpoint_force->rectangle[1]);
    require(&verdict, viewpoint_force->rectangle[3] - down);
    look_past_triangles(&verdict, sheet, i, eye, way);
    look_past_obstacles(&verdict, sheet, eye, way);
    return verdict;
}

#endif
