/* project_particle.c - one particle against one collider: normal push, absorption and friction.
 */
#include "model/post_step/project_particle.h"

#include "base/vec3.h"

#include <math.h>

/* Shortens the part of a across n by `lost`; returns whether nothing of it is left. */
static bool apply_friction(double a[3], const double n[3], double lost) {
    const double along = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
    double across[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        across[c] = a[c] - along * n[c];
        squared += across[c] * across[c];
    }
    const double length = sqrt(squared), kept = length > lost ? 1 - lost / length : 0;
    for (int c = 0; c < 3; c++)
        a[c] = kept * across[c] + along * n[c];
    return kept == 0;
}

/* Factor of the inward velocity that is taken away: above 1 the velocity is reflected. */
static double fraction_of(const struct cs_collider *collider) {
    const double ka = collider->absorption;
    return ka < 0 ? 1 - ka : ka;
}

/* Corrects the velocity relative to the collider; returns whether nothing of it is left. */
static bool absorb(const struct cs_collider *collider, const double n[3], double v[3]) {
    const double inward = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    if (inward >= 0)
        return false;
    const double changed = -inward * fraction_of(collider);
    const bool held =
        apply_friction(v, n, collider->friction * changed) && collider->absorption == 1;
    for (int c = 0; c < 3; c++)
        v[c] = held ? 0 : v[c] + changed * n[c];
    return held;
}

enum cs_project_result cs_project_particle(const struct cs_posed_collider *obstacle, double dt,
                                           const double last[3], double p[3], double v[3]) {
    const struct cs_collider *collider = obstacle->collider;
    double n[3], provenance[3], from[3], move[3];
    const double gap = cs_posed_collider_signed_distance(obstacle, p, n);
    if (!(gap < 0))
        return CS_PROJECT_NONE;

    /* position that the particle would have, had it moved with the collider */
    cs_posed_collider_velocity(obstacle, p, provenance);
    for (int c = 0; c < 3; c++) {
        from[c] = last[c] + dt * provenance[c];
        move[c] = p[c] - from[c];
        v[c] -= provenance[c];
    }
    const bool stopped = absorb(collider, n, v);
    const bool kept =
        apply_friction(move, n, collider->friction * fmin(fraction_of(collider), 1) * -gap);
    for (int c = 0; c < 3; c++) {
        v[c] += provenance[c];
        p[c] = from[c] + move[c] - gap * n[c];
    }
    return stopped && kept && cs_vec3_is_zero(provenance) ? CS_PROJECT_STUCK
                                                          : CS_PROJECT_PUSHED;
}
