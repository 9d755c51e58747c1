/* posed_collider.c - the poses of a system's colliders at a time, at rest or moved by events.
 */
#include "model/contact/posed_collider.h"

#include "base/portable_sine.h"
#include "base/vec3.h"
#include "scene/shape.h"

#include <math.h>
#include <string.h>

/* axes[1] is there; the others at right angles to it, right-handed */
static void complete_axes(double axes[3][3]) {
    const double *along = axes[1];
    const double other[3] = {fabs(along[0]) < 0.6, fabs(along[0]) >= 0.6, 0};
    cs_vec3_cross(other, along, axes[2]);
    cs_vec3_normalise(axes[2]);
    cs_vec3_cross(along, axes[2], axes[0]);
}

static void pose_plane(struct cs_posed_collider *out, const double point[3],
                       const double normal[3]) {
    out->kind = CS_COLLIDER_PLANE;
    memcpy(out->centre, point, sizeof out->centre);
    memcpy(out->axes[1], normal, sizeof out->axes[1]);
    complete_axes(out->axes);
}

static void pose_box(struct cs_posed_collider *out, const struct cs_cuboid *box) {
    double r[9];
    out->kind = CS_COLLIDER_BOX;
    out->radius = box->radius;
    memcpy(out->centre, box->centre, sizeof out->centre);
    cs_quaternion_matrix(box->rotate, r);
    for (int k = 0; k < 3; k++) {
        out->half_sizes[k] = fmax(0.5 * box->size[k] - box->radius, 0);
        for (int c = 0; c < 3; c++)
            out->axes[k][c] = r[3 * c + k];
    }
}

static void pose_capsule(struct cs_posed_collider *out, const struct cs_capsule *capsule) {
    out->kind = CS_COLLIDER_CAPSULE;
    out->radius = capsule->radius;
    for (int c = 0; c < 3; c++) {
        out->centre[c] = 0.5 * (capsule->from[c] + capsule->to[c]);
        out->axes[1][c] = capsule->to[c] - capsule->from[c];
    }
    out->half_sizes[1] = 0.5 * sqrt(cs_vec3_dot(out->axes[1], out->axes[1]));
    cs_vec3_normalise(out->axes[1]);
    complete_axes(out->axes);
}

static void pose_mesh(struct cs_posed_collider *out, const struct cs_mesh_source *mesh) {
    double r[9];
    out->kind = CS_COLLIDER_MESH;
    memcpy(out->centre, mesh->place.translate, sizeof out->centre);
    cs_pose_rotation(&mesh->place, r);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            out->axes[k][c] = r[3 * c + k];
}

/* as the scene has it */
static void pose(struct cs_posed_collider *out, const struct cs_collider *collider) {
    static const double up[3] = {0, 1, 0};
    const double height[3] = {0, collider->floor.height, 0};
    *out = (struct cs_posed_collider){.collider = collider,
                                      .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (collider->sphere.present) {
        out->radius = collider->sphere.radius;
        memcpy(out->centre, collider->sphere.centre, sizeof out->centre);
    } else if (collider->plane.present)
        pose_plane(out, collider->plane.point, collider->plane.normal);
    else if (collider->box.present)
        pose_box(out, &collider->box);
    else if (collider->capsule.present)
        pose_capsule(out, &collider->capsule);
    else if (collider->mesh.present)
        pose_mesh(out, &collider->mesh);
    else
        pose_plane(out, height, up);
}

/* out = a b */
static void multiply(const double a[9], const double b[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] =
                a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

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

    // Rodrigues' formula
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

static bool is_turned(const double turn[9]) {
    static const double same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int k = 0; k < 9; k++)
        if (turn[k] != same[k])
            return true;
    return false;
}

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
        out->velocity[c] = motion->rate[c];
        out->spin[c] = motion->spin[c];
    }
}

void cs_posed_collider_at(const struct cs_system *system, uint32_t k, double t,
                          struct cs_posed_collider *out) {
    pose(out, cs_scene_colliders(system->scene) + k);
    if (system->motions)
        move(out, system->motions + k, t);
    memcpy(out->rotation_centre, out->centre, sizeof out->rotation_centre);
}

void cs_posed_colliders_at(const struct cs_system *system, double t,
                           struct cs_posed_collider *out) {
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        cs_posed_collider_at(system, k, t, out + k);
}

void cs_posed_collider_velocity(const struct cs_posed_collider *obstacle, const double p[3],
                                double v[3]) {
    const double *w = obstacle->spin;
    const double arm[3] = {p[0] - obstacle->rotation_centre[0],
                           p[1] - obstacle->rotation_centre[1],
                           p[2] - obstacle->rotation_centre[2]};
    double turned[3];
    cs_vec3_cross(w, arm, turned);
    for (int c = 0; c < 3; c++)
        v[c] = obstacle->velocity[c] + turned[c];
}
