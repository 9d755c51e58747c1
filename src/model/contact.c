#include "model/contact.h"

#include <math.h>

/* removes the inward normal velocity and rubs on the tangential one */
static void absorb(const struct cs_collider *collider, const double n[3], double v[3]) {
    const double inward = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    if (inward >= 0)
        return;
    const double ka = collider->absorption;
    const double share = ka < 0 ? 1 - ka : ka;
    double tangential[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        tangential[c] = v[c] - inward * n[c];
        squared += tangential[c] * tangential[c];
    }

    /* what is left of the tangential velocity: none where friction can stop it (stick) */
    const double speed = sqrt(squared), lost = collider->friction * share * -inward;
    const double kept = speed > lost ? 1 - lost / speed : 0;
    for (int c = 0; c < 3; c++)
        v[c] = kept * tangential[c] + (1 - share) * inward * n[c];
}

/* Distance of p in front of the surface with its skin, and the normal there. A particle in the
 * very centre of a sphere is pushed upwards. */
static double distance_of(const struct cs_collider *collider, const double p[3], double n[3]) {
    if (collider->sphere.present) {
        double squared = 0;
        for (int c = 0; c < 3; c++) {
            n[c] = p[c] - collider->sphere.centre[c];
            squared += n[c] * n[c];
        }
        const double length = sqrt(squared);
        for (int c = 0; c < 3; c++)
            n[c] = length > 0 ? n[c] / length : c == 1;
        return length - collider->sphere.radius - collider->thickness;
    }
    if (collider->plane.present) {
        double distance = -collider->thickness;
        for (int c = 0; c < 3; c++) {
            n[c] = collider->plane.normal[c];
            distance += n[c] * (p[c] - collider->plane.point[c]);
        }
        return distance;
    }
    n[0] = n[2] = 0;
    n[1] = 1;
    return p[1] - collider->floor.height - collider->thickness;
}

struct cs_contact_counts cs_contact_resolve(const struct cs_system *system, double *x,
                                            double *v) {
    const size_t n = system->view.n;
    const struct cs_collider *colliders = cs_scene_colliders(system->scene);
    struct cs_contact_counts counts = {0};
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            if (system->inv_mass[i] == 0)
                continue;
            counts.tests++;
            const double p[3] = {x[i], x[n + i], x[2 * n + i]};
            double normal[3];
            const double distance = distance_of(colliders + k, p, normal);
            /* a particle that is not finite is left for the blow-up test */
            if (!(distance < 0))
                continue;
            counts.pushed++;
            double velocity[3] = {v[i], v[n + i], v[2 * n + i]};
            absorb(colliders + k, normal, velocity);
            for (size_t c = 0; c < 3; c++) {
                x[c * n + i] = p[c] - distance * normal[c];
                v[c * n + i] = velocity[c];
            }
        }
    return counts;
}
