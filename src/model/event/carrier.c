/* Triangles that deform: their frames and rates, and points in them. */
#include "model/event/carrier.h"

#include "base/vec3.h"
#include "scene/collider_keys.h"

#include <math.h>

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
    const uint32_t *at = collider->collider->mesh.geometry->triangles + 3 * (size_t)triangle;
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
