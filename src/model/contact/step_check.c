/* Contact energy with colliders that a step does not predict, particle by particle. */
#include "model/contact/step_check.h"

#include "base/vector.h"
#include "model/contact/barrier_law.h"
#include "model/contact/collider_params.h"
#include "model/contact/posed_collider.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <clothsim/clones.h>
#include <math.h>

/* largest number of samples of one move; particles of a row */
enum { POINTS_MAX = 64, ROW = 64 };

/* m, distance at a fraction of the way; the rotation of the collider within the step is left
 * out */
static double distance_at(const struct cs_collider_step *step, const double from[3],
                          const double to[3], double share) {
    double p[3], g[3], h[6];
    for (int c = 0; c < 3; c++)
        p[c] = from[c] + share * (to[c] - from[c]);
    return cs_posed_collider_smooth_distance(&step->at_t1, p, g, h);
}

/* J: `missed` beyond the fraction that a point of this energy may miss. */
static double excess(const struct cs_collider_step *step, double missed, double fraction,
                     double energy) {
    const double whole = energy + step->spare_energy;
    return missed > step->alone * whole ? HUGE_VAL : missed - fraction * whole;
}

/* Samples the straight way of a point relative to the collider, at most half a range apart. */
double cs_collider_step_excess(const struct cs_collider_step *step, double mass,
                               const double start[3], const double to[3]) {
    const double range = step->params.range, k = step->params.k;
    // relative to the collider, which keeps its position after the step
    double from[3], squared = 0;
    for (int c = 0; c < 3; c++) {
        from[c] = start[c] + step->at_t1.centre[c] - step->at_t0.centre[c];
        squared += (to[c] - from[c]) * (to[c] - from[c]);
    }
    const double move = sqrt(squared);
    if (!cs_posed_collider_is_near(&step->at_t1, range + move, to))
        return 0;
    const double d = distance_at(step, from, to, 0);
    if (!(d - move < range))
        return 0;
    const struct cs_barrier barrier =
        step->impacts ? (struct cs_barrier){0} : cs_barrier_at(d, range, k);
    const double held = cs_barrier_energy(d, range, k);
    const int points =
        move < 0.5 * range * POINTS_MAX ? 1 + (int)(move / (0.5 * range)) : POINTS_MAX;
    double unseen = 0;
    for (int j = 1; j <= points; j++) {
        const double s = d - distance_at(step, from, to, j / (double)points);
        unseen = fmax(unseen, fabs(cs_barrier_energy(d - s, range, k) - held -
                                   barrier.force * s - 0.5 * barrier.stiffness * s * s));
    }
    const double kinetic = 0.5 * mass * squared / (step->h * step->h);
    return excess(step, unseen, step->unresolved_max, kinetic + held);
}

/* J, by how much psi at p, the end of a particle in impact, departs from its second-order model
 * about d1; HUGE_VAL deeper in the pole of psi than half the flight. */
static double departure_of(const struct cs_rebound *rebound,
                           const struct cs_collider_step *step, const double p[3]) {
    const double range = step->params.range, k = step->params.k, d1 = rebound->distance;
    const double d = distance_at(step, p, p, 0), s = d1 - d;
    const struct cs_barrier barrier = cs_barrier_at(d1, range, k);
    return d1 > 0 && d < 0.5 * fmin(CS_BARRIER_CORE * range, d1)
               ? HUGE_VAL
               : fabs(cs_barrier_energy(d, range, k) - cs_barrier_energy(d1, range, k) -
                      barrier.force * s - 0.5 * barrier.stiffness * s * s);
}

/* Number of particles of a row that may be unresolved at a plane or sphere: a conservative test
 * without branches. On a way of length s, y is nowhere below (d1 - s)/D, with d1 the distance
 * at its end. By Taylor's formula e is at most s^3/6 max |psi'''|, and |psi'''| <= k/(2 D y^4)
 * there. It is compared with the kinetic energy m s^2 / 2h^2 alone:
 *
 *   s^3 k / (12 D y^4) <= a m s^2 / 2h^2   <=>   s k h^2 <= 6 a D m y^4,   a = unresolved_max
 *
 * so that no particle with an excess is left out; a spare energy only lessens the excess. */
CS_CLONES static uint32_t count_suspect(const struct cs_collider_step *step, size_t begin,
                                        size_t count) {
    const struct cs_posed_collider *after = &step->at_t1, *before = &step->at_t0;
    const size_t n = step->system->view.n;
    const double *a = step->x0 + begin, *b = step->x1 + begin;
    const double *mass = step->system->mass + begin, *c = after->centre;
    const double *g = after->axes[1], range = step->params.range;
    const bool sphere = after->shape->bounds == CS_BOUNDS_SPHERE;
    const double ux = c[0] - before->centre[0], uy = c[1] - before->centre[1];
    const double uz = c[2] - before->centre[2];
    const double stiff = step->params.k * step->h * step->h;
    const double give = 6 * step->unresolved_max * range;
    uint32_t risky = 0;
    for (size_t i = 0; i < count; i++) {
        const double mx = b[i] - a[i] - ux, my = b[n + i] - a[n + i] - uy;
        const double mz = b[2 * n + i] - a[2 * n + i] - uz;
        const double rx = b[i] - c[0], ry = b[n + i] - c[1], rz = b[2 * n + i] - c[2];
        const double way = sqrt(mx * mx + my * my + mz * mz);
        const double d = sphere ? sqrt(rx * rx + ry * ry + rz * rz) - after->radius
                                : g[0] * rx + g[1] * ry + g[2] * rz;
        const double y = (d - way) / range, square = y * y;
        // NaN counts as suspect
        risky += !(y >= 1 ||
                   (y > CS_BARRIER_CORE && way * stiff <= give * mass[i] * square * square));
    }
    return risky;
}

/* Box of both ends of all particles, relative to the collider, as a sphere around its middle.
 */
bool cs_collider_step_is_far(const struct cs_collider_step *step, size_t begin, size_t count) {
    const size_t n = step->system->view.n;
    double middle[3], reach = step->params.range, squared = 0;
    for (size_t c = 0; c < 3; c++) {
        const double shift = step->at_t1.centre[c] - step->at_t0.centre[c];
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = c * n + begin; i < c * n + begin + count; i++) {
            const double from = step->x0[i] + shift, to = step->x1[i];
            low = from < low ? from : low, high = from > high ? from : high;
            low = to < low ? to : low, high = to > high ? to : high;
        }
        middle[c] = 0.5 * (low + high);
        squared += 0.25 * (high - low) * (high - low);
    }
    reach += sqrt(squared);
    return !cs_posed_collider_is_near(&step->at_t1, reach, middle);
}

/* The impacts of the step that was finished last, if that is this one; NULL: none. */
static const struct cs_rebound *impacts_of(const struct cs_collider_step *step) {
    const struct cs_rebounds *rebounds = step->system->rebounds;
    return rebounds && rebounds->judged && rebounds->any ? rebounds->list : NULL;
}

/* Returns whether a row needs no test particle by particle. */
static bool row_is_resolved(const struct cs_collider_step *step, size_t begin, size_t count) {
    const enum cs_shape_bounds bounds = step->at_t1.shape->bounds;
    return !step->impacts && !impacts_of(step) &&
                   (bounds == CS_BOUNDS_HALF_SPACE || bounds == CS_BOUNDS_SPHERE)
               ? count_suspect(step, begin, count) == 0
               : cs_collider_step_is_far(step, begin, count);
}

/* J, the excess of particle i. */
static double excess_of(const struct cs_collider_step *step, size_t i) {
    const size_t n = step->system->view.n;
    const struct cs_rebound *rebound = impacts_of(step);
    double from[3], to[3];
    for (size_t c = 0; c < 3; c++) {
        from[c] = step->x0[c * n + i];
        to[c] = step->x1[c * n + i];
    }
    return rebound && rebound[i].collider == step->collider + 1
               ? excess(step, departure_of(rebound + i, step, to),
                        CS_UNRESOLVED_BESIDE_REBOUNDS, rebound[i].energy)
               : cs_collider_step_excess(step, step->system->mass[i], from, to);
}

/* J, the excess of the particles in [begin, end). */
static double sum_excess(const void *arg, size_t begin, size_t end) {
    const struct cs_collider_step *step = arg;
    double unseen = 0;
    for (size_t start = begin; start < end; start += ROW) {
        const size_t left = end - start, count = left < ROW ? left : ROW;
        if (row_is_resolved(step, start, count))
            continue;
        for (size_t i = start; i < start + count; i++)
            unseen += step->system->inv_mass[i] > 0 ? excess_of(step, i) : 0;
    }
    return unseen;
}

void cs_collider_step_set(struct cs_collider_step *step, const struct cs_system *system,
                          uint32_t collider, double t0, double t1) {
    step->system = system;
    step->collider = collider;
    step->impacts = cs_impacts_are_resolved(system);
    step->unresolved_max = step->impacts ? CS_IMPACT_CHANGE_MAX : CS_UNRESOLVED_ENERGY_MAX;
    step->alone =
        system->rebounds && !step->impacts ? CS_UNRESOLVED_ALONE : step->unresolved_max;
    step->spare_energy = 0;
    step->h = t1 - t0;
    step->params = system->collider_params[collider];
    cs_posed_collider_at(system, collider, t0, &step->at_t0);
    cs_posed_collider_at(system, collider, t1, &step->at_t1);
}

/* J, the most that a free particle brings: by its mean velocity relative to the collider, and
 * by its weight over the range. */
static double most_energy(const struct cs_collider_step *step) {
    const struct cs_system *system = step->system;
    const size_t n = system->view.n;
    const double *g = system->scene->forces->gravity;
    const double fall = sqrt(cs_vec3_dot(g, g)) * step->params.range;
    double most = 0, shift[3];
    for (int c = 0; c < 3; c++)
        shift[c] = step->at_t1.centre[c] - step->at_t0.centre[c];
    for (size_t i = 0; i < n; i++) {
        double squared = 0;
        for (size_t c = 0, k = i; c < 3; c++, k += n) {
            const double move = step->x1[k] - step->x0[k] - shift[c];
            squared += move * move;
        }
        const double energy = system->mass[i] * (0.5 * squared / (step->h * step->h) + fall);
        most = system->inv_mass[i] > 0 && energy > most ? energy : most;
    }
    return most;
}

void cs_collider_step_set_beside_rebounds(struct cs_collider_step *step) {
    const struct cs_collider_params *params = &step->params;
    if (!step->system->rebounds || step->impacts)
        return;
    step->unresolved_max = CS_UNRESOLVED_BESIDE_REBOUNDS;
    step->spare_energy = CS_SPARE_BESIDE_REBOUNDS *
                         fmin(cs_barrier_energy(0.5 * params->range, params->range, params->k),
                              most_energy(step));
}

/* Ends at the first collider whose contact the step misses. The next step's impacts are others.
 */
bool cs_collider_contact_resolves_step(const struct cs_system *system, double t0,
                                       const double *x0, double t1, const double *x1) {
    bool resolved = true;
    for (uint32_t c = 0; c < system->scene->colliders.n && resolved; c++) {
        struct cs_collider_step step = {.x0 = x0, .x1 = x1};
        cs_collider_step_set(&step, system, c, t0, t1);
        cs_collider_step_set_beside_rebounds(&step);
        resolved = !(cs_vector_sum(system->view.n, sum_excess, &step) > 0);
    }
    if (system->rebounds)
        system->rebounds->judged = false;
    return resolved;
}

bool cs_impacts_are_resolved(const struct cs_system *system) {
    return system->scene->contact->restitution >= 0;
}
