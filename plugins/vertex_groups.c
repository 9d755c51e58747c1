/* Groups of particles of one colour, with their springs in slots. */
#include "vertex_groups.h"

/* Number of slots of a group: the most springs that one of its particles has. */
static uint32_t count_slots(const struct cs_view *view, const uint32_t *item) {
    uint32_t most = 0;
    for (size_t l = 0; l < LANES; l++) {
        const uint32_t count = view->spring_begin[item[l] + 1] - view->spring_begin[item[l]];
        most = count > most ? count : most;
    }
    return most;
}

/* Cuts each colour into groups, and counts their slots. */
static void fill_groups(struct vertex_groups *groups, const struct cs_view *view) {
    uint32_t group = 0;
    for (uint32_t colour = 0; colour < view->n_colours; colour++) {
        const uint32_t end = view->colour_begin[colour + 1];
        groups->colour_begin[colour] = group;
        for (uint32_t k = view->colour_begin[colour]; k < end; k += LANES, group++) {
            uint32_t *item = groups->item + (size_t)group * LANES;
            for (uint32_t l = 0; l < LANES; l++)
                item[l] = view->colour_items[k + l < end ? k + l : end - 1];
            groups->slot_begin[group + 1] = groups->slot_begin[group] + count_slots(view, item);
        }
    }
    groups->colour_begin[view->n_colours] = group;
}

/* Names the springs of each slot, with their other ends. */
static void name_springs(struct vertex_groups *groups, const struct cs_view *view,
                         uint32_t group) {
    const uint32_t begin = groups->slot_begin[group], end = groups->slot_begin[group + 1];
    for (uint32_t l = 0; l < LANES; l++) {
        const uint32_t i = groups->item[(size_t)group * LANES + l];
        const uint32_t first = view->spring_begin[i], last = view->spring_begin[i + 1];
        for (uint32_t k = 0; k < end - begin; k++) {
            struct spring_slot *slot = groups->slots + begin + k;
            const bool there = first + k < last;
            const uint32_t s = there ? view->spring_items[first + k] : NO_SPRING;
            slot->spring[l] = s;
            slot->other[l] = !there ? i : view->ends[2 * s + (view->ends[2 * s] == i)];
        }
    }
}

enum cs_step vertex_groups_init(struct vertex_groups *groups, const struct cs_host *host) {
    const struct cs_view *view = host->view;
    if (!CS_HAS(view, spring_items) || !view->colour_begin)
        return host->fail(host->ctx, "this host does not colour particles");
    const size_t most = view->n / LANES + view->n_colours, word = sizeof(uint32_t);
    if (!(groups->item = host->alloc(host->ctx, most * LANES * word)) ||
        !(groups->slot_begin = host->alloc(host->ctx, (most + 1) * word)) ||
        !(groups->colour_begin = host->alloc(host->ctx, (view->n_colours + 1) * word)))
        return CS_STEP_FAIL;
    fill_groups(groups, view);
    const uint32_t n_groups = groups->colour_begin[view->n_colours];
    groups->slots = host->alloc(host->ctx, (groups->slot_begin[n_groups] + (size_t)1) *
                                               sizeof *groups->slots);
    if (!groups->slots)
        return CS_STEP_FAIL;
    for (uint32_t group = 0; group < n_groups; group++)
        name_springs(groups, view, group);
    return CS_STEP_OK;
}

void vertex_groups_read_springs(struct vertex_groups *groups, const struct cs_view *view,
                                const double *stiffness, const double *length, double h) {
    for (size_t k = 0; k < groups->slot_begin[groups->colour_begin[view->n_colours]]; k++)
        for (size_t l = 0; l < LANES; l++) {
            struct spring_slot *slot = groups->slots + k;
            const uint32_t s = slot->spring[l];
            if (s == NO_SPRING)
                continue;
            slot->stiffness[l] = h * h * stiffness[s];
            slot->length[l] = length[s];
            slot->axial[l] = view->axial[s] ? h * view->damping[s] : 0;
            slot->relative[l] = view->axial[s] ? 0 : h * view->damping[s];
        }
}
