/* Contact energy with colliders that a step does not predict, point by point. */
#include "model/contact/step_check.h"

#include "base/vector.h"
#include "model/contact/barrier_law.h"
#include "model/contact/contact_samples.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <clothsim/clones.h>
#include <math.h>

/* particles of a row */
enum { ROW = 64 };

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
    const struct cs_barrier_model model = cs_barrier_model_at(d, range, k, !step->impacts);
    const int parts = cs_step_parts(move, range);
    double unseen = 0;
    for (int j = 1; j <= parts; j++) {
        const double at = distance_at(step, from, to, j / (double)parts);
        unseen = fmax(unseen, cs_barrier_missed(&model, at, d - at));
    }
    const double kinetic = 0.5 * mass * squared / (step->h * step->h);
    return excess(step, unseen, step->unresolved_max, kinetic + model.held);
}

/* J, by how much psi at p, the end of a particle in impact, departs from its second-order model
 * about d1; HUGE_VAL deeper in the pole of psi than half the flight. */
static double departure_of(const struct cs_rebound *rebound,
                           const struct cs_collider_step *step, const double p[3]) {
    const double range = step->params.range, k = step->params.k, d1 = rebound->distance;
    const double d = distance_at(step, p, p, 0);
    const struct cs_barrier_model model = cs_barrier_model_at(d1, range, k, true);
    return d1 > 0 && d < 0.5 * fmin(CS_BARRIER_CORE * range, d1)
               ? HUGE_VAL
               : cs_barrier_missed(&model, d, d1 - d);
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

/* Returns whether `count` particles from `first` on, and all points between them, stay out of
 * range: their ends lie in the box of the particles' ends, and none moves further than one of
 * these. Their excess is then exactly 0. */
static bool is_far(const struct cs_collider_step *step, size_t first, size_t count) {
    const size_t n = step->system->view.n;
    const double *a = step->at_t0.centre, *b = step->at_t1.centre;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double middle[3], squared = 0, longest = 0;
    for (size_t i = first; i < first + count; i++) {
        double move = 0;
        for (size_t c = 0; c < 3; c++) {
            const double end = step->x1[c * n + i];
            const double way = end - step->x0[c * n + i] - (b[c] - a[c]);
            low[c] = end < low[c] ? end : low[c];
            high[c] = end > high[c] ? end : high[c];
            move += way * way;
        }
        longest = move > longest ? move : longest;
    }
    for (int c = 0; c < 3; c++) {
        middle[c] = 0.5 * (low[c] + high[c]);
        squared += 0.25 * (high[c] - low[c]) * (high[c] - low[c]);
    }
    return !cs_posed_collider_is_near(
        &step->at_t1, step->params.range + sqrt(longest) + sqrt(squared), middle);
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
               : is_far(step, begin, count);
}

/* J, the excess of particle i. */
static double excess_of(const struct cs_collider_step *step, size_t i) {
    const size_t n = step->system->view.n;
    const struct cs_rebound *rebound = impacts_of(step);
    double from[3], to[3];
    cs_point_read(step->x0, n, i, from);
    cs_point_read(step->x1, n, i, to);
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
    step->unresolved_max = cs_step_missed_max(system);
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

/* --- contact samples --- */

/* One step of all samples. */
struct sampled {
    const struct cs_contact_samples *samples;
    double t0, t1;
    const double *x0, *x1;
};

/* J, the excess of one sample, with its effective mass; 0 of a pinned one. */
static double excess_of_sample(const struct cs_collider_step *step,
                               const struct cs_contact_sample_point *point) {
    const size_t n = step->system->view.n;
    const double mass = cs_contact_sample_mass(step->system, point);
    double from[3], to[3];
    cs_contact_sample_interpolate(point, n, step->x0, from);
    cs_contact_sample_interpolate(point, n, step->x1, to);
    return mass < HUGE_VAL ? cs_collider_step_excess(step, mass, from, to) : 0;
}

/* Returns whether items that were not listed, and move by `move` m at most in a step, all stay
 * out of range in it: the ends of their samples are further away than that. */
static bool is_listed(const struct sampled *sampled, const struct cs_collider_step *step,
                      double move) {
    const struct cs_contact_samples *samples = sampled->samples;
    const struct cs_posed_collider_law *listed = samples->listed + step->collider;
    const double since =
        cs_contact_samples_motion(step->system->view.n, listed->collider.centre,
                                  samples->x_listed, step->at_t1.centre, sampled->x1);
    return cs_posed_collider_is_shifted(&listed->collider, &step->at_t1) &&
           since + move < (1 - 1e-6) * (listed->params.range - step->params.range);
}

/* J, the excess of the samples in the chunks [begin, end), which are sorted by colliders. That
 * of a sample whose end is further away than it moves is exactly 0. */
static double sum_excess_of_samples(const void *arg, size_t begin, size_t end) {
    const struct sampled *sampled = arg;
    const struct cs_contact_samples *samples = sampled->samples;
    const size_t n = samples->system->view.n;
    struct cs_collider_step step = {.x0 = sampled->x0, .x1 = sampled->x1};
    bool listed = false;
    double sum = 0, move = 0;
    for (size_t l = begin; l < end; l++) {
        const struct cs_contact_sample_chunk *chunk = samples->chunks + l;
        if (l == begin || chunk->collider != step.collider) {
            cs_collider_step_set(&step, samples->system, chunk->collider, sampled->t0,
                                 sampled->t1);
            move = cs_contact_samples_motion(n, step.at_t0.centre, step.x0, step.at_t1.centre,
                                             step.x1);
            listed = is_listed(sampled, &step, move);
        }
        if (!listed && is_far(&step, chunk->first, (size_t)chunk->last - chunk->first + 1))
            continue;
        const uint32_t n_items = listed ? chunk->n_near : chunk->end - chunk->begin;
        for (uint32_t k = 0; k < n_items; k++) {
            const uint32_t i = chunk->begin + (listed ? chunk->near[k] : k);
            struct cs_contact_sample_point point;
            if (chunk->subdivisions[i - chunk->begin] &&
                cs_contact_sample_item_is_near(chunk, i, &step.at_t1, step.params.range + move,
                                               n, step.x1))
                for (cs_contact_sample_first(chunk, i, &point); cs_contact_sample_next(&point);)
                    sum += excess_of_sample(&step, &point);
        }
    }
    return sum;
}

/* Ends at the first collider whose contact the step misses; samples follow particles. The next
 * step's impacts are others.
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
    const struct sampled sampled = {system->contact_samples, t0, t1, x0, x1};
    return resolved && !(sampled.samples && cs_vector_sum(sampled.samples->n_chunks,
                                                          sum_excess_of_samples, &sampled) > 0);
}

double cs_step_missed_max(const struct cs_system *system) {
    return cs_impacts_are_resolved(system) ? CS_IMPACT_CHANGE_MAX : CS_UNRESOLVED_ENERGY_MAX;
}

bool cs_impacts_are_resolved(const struct cs_system *system) {
    return system->scene->contact->restitution >= 0;
}
