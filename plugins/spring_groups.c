/* Springs as constraints, in groups of vectors. */
#include "spring_groups.h"

#include "positions.h"

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
            self->groups[g].a[l] = self->groups[g].b[l] = PLACE * view->n;
    for (uint32_t s = 0; s < view->n_springs; s++) {
        struct spring_group *to = self->groups + place[s] / LANES;
        self->spring[place[s]] = s;
        to->a[place[s] % LANES] = PLACE * view->ends[2 * (size_t)s];
        to->b[place[s] % LANES] = PLACE * view->ends[2 * (size_t)s + 1];
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
    // one more, since an allocation of nothing is none
    const size_t springs = view->n_springs + (size_t)1, word = sizeof(uint32_t);
    uint32_t *place = host->alloc(host->ctx, springs * word);
    uint32_t *count = host->alloc(host->ctx, springs * word);
    uint32_t *after = host->alloc(host->ctx, view->n * word);
    if (!place || !count || !after)
        return CS_STEP_FAIL;
    self->n = find_places(view, place, count, find_levels(view, place, count, after));
    const size_t n = self->n + (size_t)1, particles = view->n + (size_t)1;
    if (!(self->spring = host->alloc(host->ctx, n * LANES * word)) ||
        !(self->positions = host->alloc(host->ctx, particles * sizeof(quad))) ||
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
            // a lane left over has the constants of spring 0, and moves nothing
            self->is_damped |= self->axial[g].gamma[l] != 0;
            if (self->relative)
                self->relative[g].compliance[l] = !view->axial[s] && c > 0 ? 1 / (c * h) : 0;
        }
}

void spring_groups_gather(struct spring_groups *self, const struct cs_view *view,
                          const double *x) {
    gather_positions(self->positions, view->n, x, view->inv_mass);
}

void spring_groups_scatter(const struct spring_groups *self, const struct cs_view *view,
                           double *x) {
    scatter_positions(self->positions, view->n, x);
}

const struct spring_sweeps *spring_sweeps(void) {
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx512f"))
        return &spring_sweeps_8;
    if (__builtin_cpu_supports("avx2"))
        return &spring_sweeps_4;
#endif
    return &spring_sweeps_2;
}
