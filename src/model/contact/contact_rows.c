/* Contact with spheres and planes, vectorised: the formulas of point_contact.h with selections
 * for branches. Rows without a particle in range are skipped. Within a row a particle out of
 * range adds 0, since its law is 0 there. |g| is 1 for both shapes. */
#include "model/contact/contact_rows.h"

#include <clothsim/clones.h>
#include <math.h>

/* particles per row */
enum { ROW = 64 };

bool cs_contact_rows_supported(const struct cs_posed_collider_law *near) {
    const struct cs_posed_collider *pose = &near->collider;
    const double *spin = pose->spin;
    const enum cs_shape_bounds bounds = pose->shape->bounds;
    return (bounds == CS_BOUNDS_HALF_SPACE || bounds == CS_BOUNDS_SPHERE) && spin[0] == 0 &&
           spin[1] == 0 && spin[2] == 0;
}

/* Distances and gradients of one row; a plane's gradient is its normal and is not stored. */
struct row {
    double d[ROW], x[ROW], y[ROW], z[ROW];
    size_t start, count; /* of a row of bounds */
};

/* Sets distances in m and gradients of `count` particles; returns how many are in range. */
CS_INLINE uint32_t measure(const struct cs_posed_collider_law *near, size_t n, const double *x,
                           size_t count, const bool sphere, struct row *row) {
    const struct cs_posed_collider *pose = &near->collider;
    const double *c = pose->centre, *g = pose->axes[1];
    const double radius = pose->radius, range = near->params.range;
    uint32_t inside = 0;
    for (size_t i = 0; i < count; i++) {
        const double rx = x[i] - c[0], ry = x[n + i] - c[1], rz = x[2 * n + i] - c[2];
        if (sphere) {
            const double length = sqrt(rx * rx + ry * ry + rz * rz), inverse = 1 / length;
            row->d[i] = length - radius;
            row->x[i] = rx * inverse;
            row->y[i] = ry * inverse;
            row->z[i] = rz * inverse;
        } else
            row->d[i] = g[0] * rx + g[1] * ry + g[2] * rz;
        inside += row->d[i] < range;
    }
    return inside;
}

/* Adds the forces of one row. rubs: friction or damping act; a constant, so that the loop has
 * no branch. */
CS_INLINE void push(const struct cs_posed_collider_law *near, size_t n, const double *v,
                    size_t count, struct cs_contact_force_parts parts, const bool sphere,
                    const bool rubs, const struct row *row, double *restrict f) {
    const double *normal = near->collider.axes[1], *u = near->collider.velocity;
    const double k = near->params.k, range = near->params.range;
    const double mu = parts.friction * near->friction, tau = parts.friction * near->damping;
    const double least = near->friction_speed * near->friction_speed;
    for (size_t i = 0; i < count; i++) {
        const double gx = sphere ? row->x[i] : normal[0];
        const double gy = sphere ? row->y[i] : normal[1];
        const double gz = sphere ? row->z[i] : normal[2];
        const struct cs_barrier law = cs_barrier_at(row->d[i], range, k);
        double along = parts.elastic * law.force;
        double fx = 0, fy = 0, fz = 0;
        if (rubs) {
            const double vx = v[i] - u[0], vy = v[n + i] - u[1], vz = v[2 * n + i] - u[2];
            const double approach = gx * vx + gy * vy + gz * vz;
            const double tx = vx - gx * approach, ty = vy - gy * approach;
            const double tz = vz - gz * approach;
            const double rub = mu * law.force / sqrt(tx * tx + ty * ty + tz * tz + least);
            along -= tau * law.stiffness * approach;
            fx = rub * tx, fy = rub * ty, fz = rub * tz;
        }
        f[i] += along * gx - fx;
        f[n + i] += along * gy - fy;
        f[2 * n + i] += along * gz - fz;
    }
}

/* Adds the forces of all rows of a block. */
CS_INLINE void add(const struct cs_posed_collider_law *near, size_t n, const struct cs_eval *at,
                   struct cs_contact_force_parts parts, const bool sphere, double *f) {
    const bool rubs = parts.friction * (near->friction + near->damping) > 0;
    for (size_t start = at->block->begin; start < at->block->end; start += ROW) {
        const size_t left = at->block->end - start, count = left < ROW ? left : ROW;
        struct row row;
        if (measure(near, n, at->x + start, count, sphere, &row) == 0)
            continue;
        if (rubs)
            push(near, n, at->v + start, count, parts, sphere, true, &row, f + start);
        else
            push(near, n, at->v + start, count, parts, sphere, false, &row, f + start);
    }
}

CS_CLONES void cs_contact_rows_add(const struct cs_posed_collider_law *near, size_t n,
                                   const struct cs_eval *at,
                                   struct cs_contact_force_parts parts, double *f) {
    if (near->collider.shape->bounds == CS_BOUNDS_SPHERE)
        add(near, n, at, parts, true, f);
    else
        add(near, n, at, parts, false, f);
}

/* Adds the bounds of one row, those of cs_point_contact_bound for |g| = 1. */
CS_INLINE void bound(const struct cs_posed_collider_law *near, const struct cs_eval *at,
                     size_t n, const struct row *row, const bool sphere,
                     const struct cs_gershgorin *sums) {
    const double *normal = near->collider.axes[1], *u = near->collider.velocity;
    const double *v = at->v + row->start;
    double *restrict stiffness = sums->stiffness + row->start;
    double *restrict damping = sums->damping + row->start;
    const double k = near->params.k, range = near->params.range;
    const double least = near->friction_speed * near->friction_speed;
    for (size_t i = 0; i < row->count; i++) {
        const double gx = sphere ? row->x[i] : normal[0];
        const double gy = sphere ? row->y[i] : normal[1];
        const double gz = sphere ? row->z[i] : normal[2];
        const struct cs_barrier law = cs_barrier_at(row->d[i], range, k);
        const double vx = v[i] - u[0], vy = v[n + i] - u[1], vz = v[2 * n + i] - u[2];
        const double approach = gx * vx + gy * vy + gz * vz;
        const double tx = vx - gx * approach, ty = vy - gy * approach, tz = vz - gz * approach;
        stiffness[i] += law.stiffness;
        damping[i] += near->damping * law.stiffness +
                      near->friction * law.force / sqrt(tx * tx + ty * ty + tz * tz + least);
    }
}

CS_INLINE void add_bounds(const struct cs_posed_collider_law *near, size_t n,
                          const struct cs_eval *at, const bool sphere,
                          const struct cs_gershgorin *sums) {
    for (size_t start = 0; start < n; start += ROW) {
        const size_t left = n - start;
        struct row row;
        row.start = start, row.count = left < ROW ? left : ROW;
        if (measure(near, n, at->x + start, row.count, sphere, &row) > 0)
            bound(near, at, n, &row, sphere, sums);
    }
}

CS_CLONES void cs_contact_rows_add_bounds(const struct cs_posed_collider_law *near, size_t n,
                                          const struct cs_eval *at,
                                          const struct cs_gershgorin *sums) {
    if (near->collider.shape->bounds == CS_BOUNDS_SPHERE)
        add_bounds(near, n, at, true, sums);
    else
        add_bounds(near, n, at, false, sums);
}
