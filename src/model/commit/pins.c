/* pins.c - a list of pins in place of the system's; see pins.h. */
#include "model/commit/pins.h"

enum cs_status cs_pins_init(struct cs_pins *pins, struct cs_system *system,
                            struct cs_arena *arena, struct cs_error *error) {
    *pins = (struct cs_pins){.system = system};
    pins->list = cs_arena_take_n(arena, system->view.n, sizeof *pins->list, error);
    return error->status;
}

void cs_pins_set(struct cs_pins *pins, const bool *marks) {
    struct cs_system *system = pins->system;
    pins->own = system->pinned;
    pins->n_own = system->n_pinned;
    system->pinned = pins->list;
    system->n_pinned = 0;
    for (uint32_t i = 0; i < system->view.n; i++) {
        if (marks[i])
            system->inv_mass[i] = 0;
        if (system->inv_mass[i] == 0)
            system->pinned[system->n_pinned++] = i;
    }
}

void cs_pins_clear(struct cs_pins *pins, const bool *marks) {
    struct cs_system *system = pins->system;
    if (!pins->own)
        return;
    system->pinned = pins->own;
    system->n_pinned = pins->n_own;
    pins->own = NULL;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (marks[i])
            system->inv_mass[i] = 1 / system->mass[i];
}
