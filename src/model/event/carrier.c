/* carrier.c - colliders that carry particles: triangles that deform, their frames, rates and
 * points; the points that particles are sewn to. */
#include "model/event/carrier.h"

#include "base/vec3.h"
#include "model/event/event_state.h"
#include "model/system/seams.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"

#include <math.h>
#include <string.h>

/* Sets the normal of a triangle from its edges e and f, and its rate:
 * n = e x f / |e x f|, n' = (I - n n^T) (e' x f + e x f') / |e x f|. */
static void set_normal(struct cs_carrier *at) {
    double first[3], second[3], *n = at->place[3];
    cs_vec3_cross(at->place[1], at->place[2], n);
    const double length = sqrt(cs_vec3_dot(n, n)), inverse = length > 0 ? 1 / length : 0;
    cs_vec3_cross(at->rate[1], at->place[2], first);
    cs_vec3_cross(at->place[1], at->rate[2], second);
    for (int c = 0; c < 3; c++) {
        n[c] *= inverse;
        at->rate[3][c] = (first[c] + second[c]) * inverse;
    }
    const double along = cs_vec3_dot(n, at->rate[3]);
    for (int c = 0; c < 3; c++)
        at->rate[3][c] -= along * n[c];
}

void cs_carrier_at(const struct cs_posed_collider *collider, uint32_t triangle,
                   struct cs_carrier *out) {
    const uint32_t *at = collider->collider->geometry->triangles + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++)
        cs_posed_collider_vertex(collider, at[k], out->place[k], out->rate[k]);
    for (int k = 1; k < 3; k++)
        for (int c = 0; c < 3; c++) {
            out->place[k][c] -= out->place[0][c];
            out->rate[k][c] -= out->rate[0][c];
        }
    set_normal(out);
}

double cs_carrier_find(const struct cs_carrier *at, const double p[3], double own[3]) {
    const double *e = at->place[1], *f = at->place[2];
    double d[3], squared = 0;
    own[0] = own[1] = own[2] = 0;
    for (int c = 0; c < 3; c++)
        d[c] = p[c] - at->place[0][c];
    const double ee = cs_vec3_dot(e, e), ef = cs_vec3_dot(e, f), ff = cs_vec3_dot(f, f),
                 de = cs_vec3_dot(d, e), df = cs_vec3_dot(d, f), area = ee * ff - ef * ef;
    if (!(area > 0))
        return HUGE_VAL;
    own[0] = (ff * de - ef * df) / area;
    own[1] = (ee * df - ef * de) / area;
    own[2] = cs_vec3_dot(d, at->place[3]);
    const double a = fmin(fmax(own[0], 0), 1), b = fmin(fmax(own[1], 0), 1 - a);
    for (int c = 0; c < 3; c++) {
        const double gap = d[c] - a * e[c] - b * f[c];
        squared += gap * gap;
    }
    return squared;
}

/* Squared distance in m2 of p from the nearest point q of a triangle: that in its plane, or of
 * one of its edges. */
static double find_nearest_of(const struct cs_posed_collider *mesh, uint32_t triangle,
                              const double p[3], double q[3]) {
    struct cs_carrier at;
    double own[3], least = HUGE_VAL;
    cs_carrier_at(mesh, triangle, &at);
    const double *e = at.place[1], *f = at.place[2];
    const double inner = cs_carrier_find(&at, p, own);
    if (own[0] >= 0 && own[1] >= 0 && own[0] + own[1] <= 1 && inner < HUGE_VAL) {
        for (int c = 0; c < 3; c++)
            q[c] = at.place[0][c] + own[0] * e[c] + own[1] * f[c];
        return inner;
    }
    for (int k = 0; k < 3; k++) {
        double way[3], to[3], gap[3];
        for (int c = 0; c < 3; c++) {
            way[c] = k == 0 ? e[c] : k == 1 ? f[c] : f[c] - e[c];
            to[c] = p[c] - at.place[0][c] - (k == 2 ? e[c] : 0);
        }
        const double length = cs_vec3_dot(way, way);
        const double u = length > 0 ? fmin(fmax(cs_vec3_dot(to, way) / length, 0), 1) : 0;
        for (int c = 0; c < 3; c++)
            gap[c] = to[c] - u * way[c];
        if (!(cs_vec3_dot(gap, gap) < least))
            continue;
        least = cs_vec3_dot(gap, gap);
        for (int c = 0; c < 3; c++)
            q[c] = p[c] - gap[c];
    }
    return least;
}

/* The points of a collider that particles are sewn to, at time 0. */
struct sewing {
    struct cs_posed_collider posed;
    struct cs_body mesh; /* of the collider, whose vertices are n */
    uint32_t n;
    double *vertices, *targets; /* (3, vertices) and (3, particles) m */
    uint32_t *chosen, *list;    /* (vertices) and (particles) */
    bool *marks;                /* (vertices) */
};

/* Sets p to the nearest point of the collider. */
static void find_nearest(const struct sewing *sewing, double p[3]) {
    const struct cs_trimesh *mesh = sewing->mesh.geometry;
    double normal[3], from[3], least = HUGE_VAL;
    memcpy(from, p, sizeof from);
    if (!mesh) {
        const double gap = cs_posed_collider_distance(&sewing->posed, from, normal);
        for (int c = 0; c < 3; c++)
            p[c] -= gap * normal[c];
        return;
    }
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        double q[3];
        const double squared = find_nearest_of(&sewing->posed, k, from, q);
        if (!(squared < least))
            continue;
        least = squared;
        memcpy(p, q, sizeof q);
    }
}

/* Lists the vertices that a seam names; returns their number. */
static uint32_t list_vertices(const struct sewing *sewing, const struct cs_list *particles) {
    const struct cs_seam_points points = {&sewing->mesh, sewing->vertices, sewing->n, 0,
                                          sewing->n};
    for (uint32_t i = 0; i < sewing->n; i++) {
        double p[3];
        cs_posed_collider_vertex(&sewing->posed, i, p, NULL);
        for (size_t c = 0; c < 3; c++)
            sewing->vertices[c * sewing->n + i] = p[c];
    }
    return cs_seam_points_list(&points, particles, sewing->marks, sewing->chosen);
}

/* Sets p, of the k-th particle of a seam, to the point of the collider that it is sewn to. */
static void find_target(const struct sewing *sewing, const struct cs_seam *seam, uint32_t k,
                        double p[3]) {
    const double *w = seam->to.weights;
    const uint32_t *at = sewing->chosen;
    if (!seam->to.side.particles.n)
        find_nearest(sewing, p);
    for (size_t c = 0; c < 3 && seam->to.side.particles.n; c++) {
        const double *x = sewing->vertices + c * sewing->n;
        p[c] = isnan(w[0]) ? x[at[k]] : w[0] * x[at[0]] + w[1] * x[at[1]] + w[2] * x[at[2]];
    }
}

/* Finds the points of the collider for the particles of a seam. */
static enum cs_status sew(struct cs_system *system, uint32_t s, struct sewing *sewing,
                          struct cs_error *error) {
    const struct cs_seam *seam = (const struct cs_seam *)system->scene->seams.items + s;
    const struct cs_list *to = &seam->to.side.particles;
    const struct cs_seam_points side = cs_seam_points_of(system, &seam->side);
    struct cs_events *events = system->events;
    const size_t n = system->view.n;
    memset(events->work, 0, n * sizeof *events->work);
    uint32_t count[2];
    count[0] = cs_seam_points_list(&side, &seam->side.particles, events->work, sewing->list);
    count[1] = to->n ? list_vertices(sewing, to) : count[0];
    if (cs_seam_check_counts(s, seam, count, error))
        return error->status;
    // a particle has one holder, so that the order of seams does not matter
    for (uint32_t k = 0; k < count[0]; k++) {
        const size_t i = sewing->list[k];
        const double *x = system->state + i, from[3] = {x[0], x[n], x[2 * n]};
        double p[3] = {from[0], from[1], from[2]}, squared = 0;
        if (system->inv_mass[i] == 0)
            return cs_fail(error, CS_ERR_SCENE,
                           "seams[%u]: particle %u of body %u is pinned, or sewn to a collider "
                           "already; expected a free one",
                           s, (uint32_t)i - side.first, (uint32_t)seam->side.body);
        find_target(sewing, seam, k, p);
        for (size_t c = 0; c < 3; c++) {
            sewing->targets[c * n + i] = p[c];
            squared += (p[c] - from[c]) * (p[c] - from[c]);
        }
        events->gap_of = sqrt(squared) > events->gap ? (uint32_t)i : events->gap_of;
        events->gap = fmax(events->gap, sqrt(squared));
        events->seam_of[i] = s + 1;
    }
    return CS_OK;
}

enum cs_status cs_carrier_sew(struct cs_system *system, uint32_t seam, double *targets,
                              struct cs_error *error) {
    const struct cs_seam *of = (const struct cs_seam *)system->scene->seams.items + seam;
    struct sewing sewing = {.targets = targets};
    struct cs_arena arena = {0};
    cs_posed_collider_at(system, (uint32_t)of->to.collider, 0, &sewing.posed);
    sewing.mesh.mesh = sewing.posed.collider->mesh;
    sewing.mesh.geometry = sewing.posed.collider->geometry;
    sewing.n = sewing.mesh.mesh ? sewing.mesh.geometry->n : 0;
    CS_ARENA_ARRAY(&arena, sewing.vertices, 3 * (size_t)sewing.n, error);
    CS_ARENA_ARRAY(&arena, sewing.chosen, sewing.n, error);
    CS_ARENA_ARRAY(&arena, sewing.list, system->view.n, error);
    CS_ARENA_ARRAY(&arena, sewing.marks, sewing.n, error);
    if (!error->status)
        sew(system, seam, &sewing, error);
    cs_arena_finish(&arena);
    return error->status;
}
