#include "model/commit/contact.h"

#include "base/vector.h"
#include "model/contact/obstacle.h"

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

/* the same for the velocity against the obstacle's */
static void absorb_moving(const struct cs_obstacle *obstacle, const double p[3],
                          const double n[3], double v[3]) {
    double of[3];
    cs_obstacle_velocity(obstacle, p, of);
    for (int c = 0; c < 3; c++)
        v[c] -= of[c];
    absorb(obstacle->collider, n, v);
    for (int c = 0; c < 3; c++)
        v[c] += of[c];
}

struct resolving {
    const struct cs_system *system;
    double t;
    double *x, *v;
    atomic_ullong tests, pushed; /* whole numbers: their sum has no order */
};

static struct cs_contact_counts resolve_range(const struct resolving *resolving,
                                              const struct cs_obstacle *obstacle, size_t begin,
                                              size_t end) {
    const size_t n = resolving->system->view.n;
    double *x = resolving->x, *v = resolving->v;
    const double skin = obstacle->collider->thickness;
    struct cs_contact_counts counts = {0};
    for (size_t i = begin; i < end; i++) {
        if (resolving->system->inv_mass[i] == 0)
            continue;
        counts.tests++;
        const double p[3] = {x[i], x[n + i], x[2 * n + i]};
        double normal[3];
        if (!cs_obstacle_is_near(obstacle, skin, p))
            continue;
        const double distance = cs_obstacle_gap(obstacle, p, normal);
        /* a particle that is not finite is left for the blow-up test */
        if (!(distance < 0))
            continue;
        counts.pushed++;
        double velocity[3] = {v[i], v[n + i], v[2 * n + i]};
        if (resolving->system->motions)
            absorb_moving(obstacle, p, normal, velocity);
        else
            absorb(obstacle->collider, normal, velocity);
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
        struct cs_obstacle obstacle;
        cs_obstacle_at(resolving->system, k, resolving->t, &obstacle);
        const struct cs_contact_counts counts = resolve_range(resolving, &obstacle, begin, end);
        resolving->tests += counts.tests;
        resolving->pushed += counts.pushed;
    }
}

struct cs_contact_counts cs_contact_resolve(const struct cs_system *system, double t, double *x,
                                            double *v) {
    struct resolving resolving = {.system = system, .t = t, .x = x, .v = v};
    cs_vector_share(system->view.n, resolve_part, &resolving);
    return (struct cs_contact_counts){resolving.tests, resolving.pushed};
}
