/* Springs as constraints, in groups of vectors. */
#include "spring_groups.h"

#include <clothsim/clones.h>
#include <float.h>
#include <math.h>
#include <string.h>

/* The four numbers from position k of the places on, which is a multiple of four. */
CS_INLINE spring_lanes *at(double *places, size_t k) {
    return (spring_lanes *)(places + k);
}

/* Finds the level of each spring, one more than those of all springs before it at its ends, and
 * the number of springs of each level. `after` (n): level after those of the springs at a
 * particle. Returns the number of levels. */
static uint32_t find_levels(const struct cs_view *view, uint32_t *level, uint32_t *count,
                            uint32_t *after) {
    uint32_t n = 0;
    for (size_t s = 0; s < view->n_springs; s++) {
        const uint32_t a = view->ends[2 * s], b = view->ends[2 * s + 1];
        level[s] = after[a] > after[b] ? after[a] : after[b];
        after[a] = after[b] = level[s] + 1;
        count[level[s]]++;
        n = after[a] > n ? after[a] : n;
    }
    return n;
}

/* Finds the place of each spring, LANES times its group and its lane, instead of its level.
 * `count` of a level becomes the next place. Returns the number of groups. */
static uint32_t find_places(const struct cs_view *view, uint32_t *place, uint32_t *count,
                            uint32_t n_levels) {
    uint32_t groups = 0;
    for (uint32_t k = 0; k < n_levels; k++) {
        const uint32_t first = groups * LANES;
        groups += (count[k] + LANES - 1) / LANES;
        count[k] = first;
    }
    for (size_t s = 0; s < view->n_springs; s++)
        place[s] = count[place[s]]++;
    return groups;
}

/* Names the springs of each group and their ends. */
static void fill_groups(struct spring_groups *self, const struct cs_view *view,
                        const uint32_t *place) {
    for (uint32_t g = 0; g < self->n; g++)
        for (uint32_t l = 0; l < LANES; l++)
            self->groups[g].a[l] = self->groups[g].b[l] = LANES * view->n;
    for (uint32_t s = 0; s < view->n_springs; s++) {
        struct spring_group *to = self->groups + place[s] / LANES;
        self->spring[place[s]] = s;
        to->a[place[s] % LANES] = LANES * view->ends[2 * (size_t)s];
        to->b[place[s] % LANES] = LANES * view->ends[2 * (size_t)s + 1];
    }
}

/* True if a spring has a damper against every relative velocity of its ends. */
static bool has_relative_dampers(const struct cs_view *view) {
    for (size_t s = 0; s < view->n_springs; s++)
        if (view->damping[s] > 0 && !view->axial[s])
            return true;
    return false;
}

enum cs_step spring_groups_init(struct spring_groups *self, const struct cs_host *host) {
    const struct cs_view *view = host->view;
    const size_t springs = view->n_springs + (size_t)1, word = sizeof(uint32_t);
    uint32_t *place = host->alloc(host->ctx, springs * word);
    uint32_t *count = host->alloc(host->ctx, springs * word);
    uint32_t *after = host->alloc(host->ctx, view->n * word);
    if (!place || !count || !after)
        return CS_STEP_FAIL;
    self->n = find_places(view, place, count, find_levels(view, place, count, after));
    const size_t n = self->n + (size_t)1, particles = view->n + (size_t)1;
    if (!(self->spring = host->alloc(host->ctx, n * LANES * word)) ||
        !(self->places = host->alloc(host->ctx, particles * sizeof(spring_lanes))) ||
        !(self->groups = host->alloc(host->ctx, n * sizeof *self->groups)) ||
        !(self->axial = host->alloc(host->ctx, n * sizeof *self->axial)))
        return CS_STEP_FAIL;
    if (has_relative_dampers(view) &&
        !(self->relative = host->alloc(host->ctx, n * sizeof *self->relative)))
        return CS_STEP_FAIL;
    fill_groups(self, view, place);
    return CS_STEP_OK;
}

void spring_groups_read_constants(struct spring_groups *self, const struct cs_view *view,
                                  double h) {
    self->is_damped = false;
    for (size_t g = 0; g < self->n; g++)
        for (size_t l = 0; l < LANES; l++) {
            const uint32_t s = self->spring[g * LANES + l];
            const double k = view->stiffness[s], c = view->damping[s];
            self->groups[g].length[l] = view->length[s];
            self->groups[g].compliance[l] = 1 / (k * h * h);
            self->axial[g].gamma[l] = view->axial[s] ? c / (k * h) : 0;
            self->is_damped |= self->axial[g].gamma[l] != 0;
            if (self->relative)
                self->relative[g].compliance[l] = !view->axial[s] && c > 0 ? 1 / (c * h) : 0;
        }
}

CS_CLONES void spring_groups_take(struct spring_groups *self, const struct cs_view *view,
                                  const double *x) {
    const size_t n = view->n;
    for (size_t i = 0; i < n; i++)
        *at(self->places, LANES * i) =
            (spring_lanes){x[i], x[n + i], x[2 * n + i], view->inv_mass[i]};
}

CS_CLONES void spring_groups_give(const struct spring_groups *self, const struct cs_view *view,
                                  double *x) {
    const size_t n = view->n;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            x[c * n + i] = self->places[LANES * i + c];
}

/* Turns four rows of four numbers into columns. */
CS_INLINE void transpose(const spring_lanes *from, spring_lanes *to) {
    const spring_lanes p = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6);
    const spring_lanes q = __builtin_shufflevector(from[0], from[1], 1, 5, 3, 7);
    const spring_lanes r = __builtin_shufflevector(from[2], from[3], 0, 4, 2, 6);
    const spring_lanes s = __builtin_shufflevector(from[2], from[3], 1, 5, 3, 7);
    to[0] = __builtin_shufflevector(p, r, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(q, s, 0, 1, 4, 5);
    to[2] = __builtin_shufflevector(p, r, 2, 3, 6, 7);
    to[3] = __builtin_shufflevector(q, s, 2, 3, 6, 7);
}

/* x, y, z and inverse mass of some particles. */
CS_INLINE void read_places(double *places, const uint32_t *item, spring_lanes to[LANES]) {
    const spring_lanes rows[LANES] = {*at(places, item[0]), *at(places, item[1]),
                                      *at(places, item[2]), *at(places, item[3])};
    transpose(rows, to);
}

CS_INLINE void write_places(double *places, const uint32_t *item,
                            const spring_lanes from[LANES]) {
    spring_lanes rows[LANES];
    transpose(from, rows);
    for (size_t l = 0; l < LANES; l++)
        *at(places, item[l]) = rows[l];
}

CS_CLONES void spring_groups_note_old(struct spring_groups *self) {
    spring_lanes a[LANES], b[LANES];
    for (size_t g = 0; (self->is_damped || self->relative) && g < self->n; g++) {
        read_places(self->places, self->groups[g].a, a);
        read_places(self->places, self->groups[g].b, b);
        for (size_t c = 0; c < 3; c++) {
            self->axial[g].old[c] = b[c] - a[c];
            if (self->relative)
                self->relative[g].old[c] = b[c] - a[c];
        }
    }
}

/* Corrects the springs of a group with their axial dampers. */
CS_INLINE void project_springs(struct spring_group *group, const struct axial_group *axial,
                               const bool damped, bool is_first, spring_lanes *a,
                               spring_lanes *b) {
    const spring_lanes dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
    const spring_lanes kept = is_first ? (spring_lanes){0} : group->multiplier;
    // two particles in one place have no direction: d is 0, and nothing moves
    spring_lanes length = DBL_MIN + dx * dx + dy * dy + dz * dz, weight = a[3] + b[3];
    for (size_t l = 0; l < LANES; l++)
        length[l] = sqrt(length[l]);
    spring_lanes miss = group->length - length - group->compliance * kept;
    if (damped) {
        miss -= axial->gamma *
                (dx / length * (dx - axial->old[0]) + dy / length * (dy - axial->old[1]) +
                 dz / length * (dz - axial->old[2]));
        weight *= 1 + axial->gamma;
    }
    const spring_lanes change = miss / (weight + group->compliance), push = change / length;
    group->multiplier = kept + change;
    const spring_lanes moved[3] = {dx * push, dy * push, dz * push};
    for (size_t c = 0; c < 3; c++) {
        a[c] -= a[3] * moved[c];
        b[c] += b[3] * moved[c];
    }
}

/* Corrects the relative dampers of a group: the constraints d = old. */
CS_INLINE void project_dampers(struct relative_group *damper, bool is_first, spring_lanes *a,
                               spring_lanes *b) {
    for (size_t c = 0; c < 3; c++)
        for (size_t l = 0; l < LANES; l++) {
            const double kept = is_first ? 0 : damper->multiplier[c][l];
            const double compliance = damper->compliance[l], d = b[c][l] - a[c][l];
            const double change =
                (damper->old[c][l] - d - compliance * kept) / (a[3][l] + b[3][l] + compliance);
            damper->multiplier[c][l] = kept;
            if (!(compliance > 0))
                continue;
            damper->multiplier[c][l] += change;
            a[c][l] -= a[3][l] * change;
            b[c][l] += b[3][l] * change;
        }
}

/* One pass; `damped` and `related` are constants of every caller. */
CS_INLINE void sweep(struct spring_groups *self, bool is_first, const bool damped,
                     const bool related) {
    spring_lanes a[LANES], b[LANES];
    for (size_t g = 0; g < self->n; g++) {
        struct spring_group *group = self->groups + g;
        read_places(self->places, group->a, a);
        read_places(self->places, group->b, b);
        project_springs(group, self->axial + g, damped, is_first, a, b);
        if (related)
            project_dampers(self->relative + g, is_first, a, b);
        write_places(self->places, group->a, a);
        write_places(self->places, group->b, b);
    }
}

CS_CLONES void spring_groups_sweep(struct spring_groups *self, bool is_first) {
    if (self->relative)
        sweep(self, is_first, true, true);
    else if (self->is_damped)
        sweep(self, is_first, true, false);
    else
        sweep(self, is_first, false, false);
}
