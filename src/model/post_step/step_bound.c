/* step_bound.c - the longest step with contact by projection: the time to a surface, and to the
 * admissible depth behind it, in free fall. With contact by force see ccd/step_limit.h. */
#include "model/post_step/contact_projection.h"

#include "model/contact/posed_collider.h"
#include "model/force/diagnostics.h"
#include "scene/force_keys.h"

#include <math.h>

double cs_step_bound_depth(const struct cs_system *system) {
    const double shortest = cs_diagnostics_shortest(system);
    return shortest > 0 ? 0.1 * shortest : HUGE_VAL;
}

/* Time in s to cover the distance way > 0 at speed s with acceleration a, the root of way = s t
 * + a t^2/2 in a form without cancellation:
 *
 *   t = 2 way / (s + sqrt(s^2 + 2 a way))
 *
 * HUGE_VAL if it turns back before, or stands. */
static double time_to(double way, double s, double a) {
    const double squared = s * s + 2 * a * way;
    const double sum = s + sqrt(fmax(squared, 0));
    // never, if it turns back before, or stands
    return squared >= 0 && sum > 0 ? 2 * way / sum : HUGE_VAL;
}

/* Time in s of one particle to the depth behind one collider. speed and pull are the components
 * of relative velocity and gravity against the normal. */
static double time_of(const struct cs_system *system, const struct cs_posed_collider *collider,
                      double depth, const double p[3], const double v[3]) {
    const double *g = system->scene->forces->gravity;
    double n[3], provenance[3], speed = 0, pull = 0;
    const double gap = cs_posed_collider_signed_distance(collider, p, n);
    cs_posed_collider_velocity(collider, p, provenance);
    for (int c = 0; c < 3; c++) {
        speed -= (v[c] - provenance[c]) * n[c];
        pull -= g[c] * n[c];
    }
    return time_to(fmax(gap, 0) + depth, speed, pull);
}

/* Minimum over all free particles and colliders. */
double cs_step_bound_step(const struct cs_system *system,
                          const struct cs_posed_collider *colliders, double depth,
                          const double *x, const double *v) {
    const size_t n = system->view.n;
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        for (size_t i = 0; i < n; i++) {
            const double p[3] = {x[i], x[n + i], x[2 * n + i]};
            const double w[3] = {v[i], v[n + i], v[2 * n + i]};
            if (system->inv_mass[i] > 0)
                least = fmin(least, time_of(system, colliders + k, depth, p, w));
        }
    return least;
}
