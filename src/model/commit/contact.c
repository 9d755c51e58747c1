#include "model/commit/contact.h"

#include "base/vector.h"

#include <math.h>
#include <stdatomic.h>

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

struct resolving {
    const struct cs_system *system;
    double *x, *v;
    atomic_ullong tests, pushed; /* whole numbers: their sum has no order */
};

static struct cs_contact_counts resolve_range(const struct resolving *resolving,
                                              const struct cs_collider *collider, size_t begin,
                                              size_t end) {
    const size_t n = resolving->system->view.n;
    double *x = resolving->x, *v = resolving->v;
    struct cs_contact_counts counts = {0};
    for (size_t i = begin; i < end; i++) {
        if (resolving->system->inv_mass[i] == 0)
            continue;
        counts.tests++;
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        double normal[3];
        const double distance = distance_of(collider, p, normal);
        /* a particle that is not finite is left for the blow-up test */
        if (!(distance < 0))
            continue;
        counts.pushed++;
        double velocity[3] = {v[i], v[n + i], v[2 * n + i]};
        absorb(collider, normal, velocity);
        for (size_t c = 0; c < 3; c++) {
            x[c * n + i] = p[c] - distance * normal[c];
            v[c * n + i] = velocity[c];
        }
    }
    return counts;
}

static void resolve_part(void *arg, size_t begin, size_t end) {
    struct resolving *resolving = arg;
    const struct cs_scene *scene = resolving->system->scene;
    for (uint32_t k = 0; k < scene->colliders.n; k++) {
        const struct cs_contact_counts counts =
            resolve_range(resolving, cs_scene_colliders(scene) + k, begin, end);
        resolving->tests += counts.tests;
        resolving->pushed += counts.pushed;
    }
}

struct cs_contact_counts cs_contact_resolve(const struct cs_system *system, double *x,
                                            double *v) {
    struct resolving resolving = {.system = system, .x = x, .v = v};
    cs_vector_share(system->view.n, resolve_part, &resolving);
    return (struct cs_contact_counts){resolving.tests, resolving.pushed};
}
