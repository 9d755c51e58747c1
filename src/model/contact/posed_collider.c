/* posed_collider.c - poses of a system's colliders at a time, at rest or moved by events. */
#include "model/contact/posed_collider.h"

#include "base/portable_sine.h"
#include "base/vec3.h"
#include "scene/collider_keys.h"

#include <clothsim/clones.h>
#include <math.h>

/* Pose at rest, as the scene defines it. */
static void pose(struct cs_posed_collider *out, const struct cs_collider *collider) {
    *out = (struct cs_posed_collider){.shape = cs_collider_shape(collider),
                                      .collider = collider,
                                      .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    out->shape->pose(collider, out);
}

/* out = a b for 3 x 3 matrices by rows */
static void multiply(const double a[9], const double b[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] =
                a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

/* turn = rotation about the axis of `spin` by |spin| (t - t_begin), times the rotation at
 * t_begin. Sine and cosine are portable (base/portable_sine.h), with the same bits on all
 * machines. */
void cs_posed_collider_rotate(const struct cs_collider_motion *motion, double t,
                              double turn[9]) {
    const double speed = sqrt(cs_vec3_dot(motion->spin, motion->spin)),
                 time = t - motion->t_begin;
    memcpy(turn, motion->rotation, sizeof motion->rotation);
    if (speed == 0)
        return;
    double a[3], sine, cosine, by[9];
    for (int c = 0; c < 3; c++)
        a[c] = motion->spin[c] / speed;
    cs_sine_cosine(speed * fabs(time), &sine, &cosine);
    sine = time < 0 ? -sine : sine;

    // Rodrigues' formula: I cos + (1 - cos) a a^T + sin [a]x
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            by[3 * i + j] = (1 - cosine) * a[i] * a[j] + (i == j ? cosine : 0);
    for (int c = 0; c < 3; c++) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        by[3 * e + d] += sine * a[c];
        by[3 * d + e] -= sine * a[c];
    }
    multiply(by, motion->rotation, turn);
}

void cs_posed_collider_translate(const struct cs_collider_motion *motion, double t,
                                 double shift[3]) {
    // from whichever end is nearer in time, so that the far end is met exactly
    for (int c = 0; c < 3; c++)
        shift[c] = t < motion->t_end
                       ? motion->shift_begin[c] + motion->rate[c] * (t - motion->t_begin)
                       : motion->shift_end[c] + motion->rate[c] * (t - motion->t_end);
}

/* Returns whether a rotation is not the identity. */
static bool is_turned(const double turn[9]) {
    static const double same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int k = 0; k < 9; k++)
        if (turn[k] != same[k])
            return true;
    return false;
}

/* Applies a motion at t to a pose. */
static void move(struct cs_posed_collider *out, const struct cs_collider_motion *motion,
                 double t) {
    double turn[9], shift[3];
    cs_posed_collider_rotate(motion, t, turn);
    cs_posed_collider_translate(motion, t, shift);
    for (int k = 0; k < 3 && is_turned(turn); k++) {
        const double axis[3] = {out->axes[k][0], out->axes[k][1], out->axes[k][2]};
        for (int c = 0; c < 3; c++)
            out->axes[k][c] = cs_vec3_dot(turn + 3 * (size_t)c, axis);
    }
    for (int c = 0; c < 3; c++) {
        out->centre[c] += shift[c];
        out->rotation_centre[c] = out->centre[c] + motion->pivot[c];
        if (motion->pivot[0] != 0 || motion->pivot[1] != 0 || motion->pivot[2] != 0)
            out->centre[c] =
                out->rotation_centre[c] + cs_vec3_dot(turn + 3 * (size_t)c, motion->arm);
        out->velocity[c] = motion->rate[c];
        out->spin[c] = motion->spin[c];
    }
    out->growth = motion->growth;
    if (motion->radius_changes)
        out->radius = motion->radius_begin + motion->radius_rate * (t - motion->t_growth);
}

/* Pose at t of a collider that has moved by motion; NULL: not at all. */
static void pose_at(const struct cs_collider *collider, const struct cs_collider_motion *motion,
                    double t, struct cs_posed_collider *out) {
    pose(out, collider);
    memcpy(out->rotation_centre, out->centre, sizeof out->rotation_centre);
    if (motion)
        move(out, motion, t);
    if (collider->paths)
        out->path = cs_vertex_paths_weights(collider->paths, t);
}

void cs_posed_collider_at(const struct cs_system *system, uint32_t k, double t,
                          struct cs_posed_collider *out) {
    pose_at(cs_scene_colliders(system->scene) + k, system->motions ? system->motions + k : NULL,
            t, out);
}

void cs_posed_colliders_at_start(const struct cs_system *system,
                                 struct cs_posed_collider *out) {
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        pose_at(cs_scene_colliders(system->scene) + k, NULL, 0, out + k);
}

void cs_posed_colliders_at(const struct cs_system *system, double t,
                           struct cs_posed_collider *out) {
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        cs_posed_collider_at(system, k, t, out + k);
}

void cs_posed_collider_velocity(const struct cs_posed_collider *collider, const double p[3],
                                double v[3]) {
    const double *w = collider->spin;
    const double arm[3] = {p[0] - collider->rotation_centre[0],
                           p[1] - collider->rotation_centre[1],
                           p[2] - collider->rotation_centre[2]};
    double turned[3];
    cs_vec3_cross(w, arm, turned);
    for (int c = 0; c < 3; c++)
        v[c] = collider->velocity[c] + turned[c];
    if (collider->growth != 0) {
        double normal[3];
        collider->shape->distance(collider, 0, p, normal);
        for (int c = 0; c < 3; c++)
            v[c] += collider->growth * normal[c];
    }
}

void cs_posed_collider_vertex(const struct cs_posed_collider *collider, uint32_t i, double p[3],
                              double v[3]) {
    const struct cs_vertex_paths *paths = collider->collider->paths;
    double own[3], own_velocity[3], turned[3];
    cs_collider_mesh_vertex(collider, i, own);
    for (int c = 0; c < 3; c++)
        p[c] = collider->axes[0][c] * own[0] + collider->axes[1][c] * own[1] +
               collider->axes[2][c] * own[2] + collider->centre[c];
    if (v)
        cs_posed_collider_velocity(collider, p, v);
    if (!v || !paths)
        return;
    cs_vertex_paths_sum(paths, &collider->path, collider->path.velocity, i, own_velocity);
    cs_collider_rotate(collider, own_velocity, turned);
    for (int c = 0; c < 3; c++)
        v[c] += turned[c];
}

double cs_posed_colliders_depth(const struct cs_system *system, double t, const double *x) {
    const size_t n = system->view.n;
    double largest = 0, normal[3];
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        struct cs_posed_collider posed;
        cs_posed_collider_at(system, k, t, &posed);
        for (size_t i = 0; i < n; i++) {
            const double p[3] = {x[i], x[n + i], x[2 * n + i]};
            if (system->inv_mass[i] > 0 && cs_posed_collider_is_near(&posed, 0, p))
                largest = fmax(largest, -cs_posed_collider_distance(&posed, p, normal));
        }
    }
    return largest;
}

double cs_posed_collider_signed_distance(const struct cs_posed_collider *collider,
                                         const double p[3], double n[3]) {
    return collider->shape->distance(collider, collider->collider->thickness, p, n);
}

/* Sets over[i] to a positive number if point i is out of reach; returns how many are not.
 * bounds: a constant, so that the loop has no branch. */
CS_INLINE uint32_t measure(const struct cs_posed_collider *collider,
                           const enum cs_shape_bounds bounds, const double *reach, size_t n,
                           const double *x, size_t count, double *over) {
    const double *c = collider->centre, *half = collider->half_sizes;
    const double(*axes)[3] = collider->axes, radius = collider->radius;
    uint32_t near = 0;
    for (size_t i = 0; i < count; i++) {
        const double d[3] = {x[i] - c[0], x[n + i] - c[1], x[2 * n + i] - c[2]};
        const double all = (radius + reach[i]) * (1 + 1e-9);
        double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (bounds == CS_BOUNDS_BOX) {
            squared = 0;
            for (int k = 0; k < 3; k++) {
                const double out = fabs(cs_vec3_dot(axes[k], d)) - half[k];
                squared += out > 0 ? out * out : 0;
            }
        }
        over[i] = bounds == CS_BOUNDS_HALF_SPACE ? cs_vec3_dot(axes[1], d) - (all + 1e-9)
                                                 : squared - all * all;
        near += !(over[i] > 0);
    }
    return near;
}

CS_CLONES uint32_t cs_posed_collider_list_near(const struct cs_posed_collider *collider,
                                               const double *reach, size_t n, const double *x,
                                               size_t count, uint8_t list[CS_COLLIDER_ROW]) {
    const enum cs_shape_bounds bounds = collider->shape->bounds;
    double over[CS_COLLIDER_ROW];
    uint32_t near = 0;
    if (bounds == CS_BOUNDS_SPHERE)
        near = measure(collider, CS_BOUNDS_SPHERE, reach, n, x, count, over);
    else if (bounds == CS_BOUNDS_HALF_SPACE)
        near = measure(collider, CS_BOUNDS_HALF_SPACE, reach, n, x, count, over);
    else if (bounds == CS_BOUNDS_BOX)
        near = measure(collider, CS_BOUNDS_BOX, reach, n, x, count, over);
    if (!near)
        return 0;
    near = 0;
    for (size_t i = 0; i < count; i++) {
        list[near] = (uint8_t)i;
        near += !(over[i] > 0);
    }
    return near;
}
