/* The energy of contact that a step does not see, particle by particle. */
#include "model/contact/share.h"

#include "base/vector.h"
#include "model/contact/law.h"
#include "model/contact/obstacle.h"
#include "model/contact/pairing.h"

#include <math.h>

/* points of one move, at most */
enum { POINTS_MOST = 64 };

/* One obstacle during a step. */
struct passing {
    const struct cs_system *system;
    const double *x0, *x1;
    double h;
    struct cs_obstacle before, after;
    struct cs_pairing pairing;
};

/* distance at a share of the way; the obstacle's own turn within a step is left out */
static double distance_at(const struct passing *passing, const double from[3],
                          const double to[3], double share) {
    double p[3], g[3], h[6];
    for (int c = 0; c < 3; c++)
        p[c] = from[c] + share * (to[c] - from[c]);
    return cs_obstacle_smooth(&passing->after, p, g, h);
}

static bool is_unseen(const struct passing *passing, size_t i) {
    const size_t n = passing->system->view.n;
    const double range = passing->pairing.range, k = passing->pairing.k;
    // seen from the obstacle, which stands where it is after the step
    double from[3], to[3], squared = 0;
    for (size_t c = 0; c < 3; c++) {
        from[c] = passing->x0[c * n + i] + passing->after.centre[c] - passing->before.centre[c];
        to[c] = passing->x1[c * n + i];
        squared += (to[c] - from[c]) * (to[c] - from[c]);
    }
    const double move = sqrt(squared);
    if (!cs_obstacle_is_near(&passing->after, range + move, to))
        return false;
    const double d = distance_at(passing, from, to, 0);
    if (!(d - move < range))
        return false;
    const struct cs_law law = cs_law_at(d, range, k);
    const double held = cs_law_energy(d, range, k);
    const double has =
        0.5 * passing->system->mass[i] * squared / (passing->h * passing->h) + held;
    const int points =
        move < 0.5 * range * POINTS_MOST ? 1 + (int)(move / (0.5 * range)) : POINTS_MOST;
    double unseen = 0;
    for (int j = 1; j <= points; j++) {
        const double s = d - distance_at(passing, from, to, j / (double)points);
        unseen = fmax(unseen, fabs(cs_law_energy(d - s, range, k) - held - law.force * s -
                                   0.5 * law.stiffness * s * s));
    }
    return unseen > CS_SHARE_UNSEEN * has;
}

static double count_unseen(const void *arg, size_t begin, size_t end) {
    const struct passing *passing = arg;
    double unseen = 0;
    for (size_t i = begin; i < end; i++)
        unseen += passing->system->inv_mass[i] > 0 && is_unseen(passing, i);
    return unseen;
}

bool cs_contact_is_seen(const struct cs_system *system, double t0, const double *x0, double t1,
                        const double *x1) {
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct passing passing = {
            .system = system, .x0 = x0, .x1 = x1, .h = t1 - t0, .pairing = system->pairings[c]};
        cs_obstacle_at(system, c, t0, &passing.before);
        cs_obstacle_at(system, c, t1, &passing.after);
        if (cs_vector_sum(system->view.n, count_unseen, &passing) > 0)
            return false;
    }
    return true;
}
