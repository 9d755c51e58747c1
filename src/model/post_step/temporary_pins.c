/* temporary_pins.c - exchanges the system's list of pins; see temporary_pins.h. */
#include "model/post_step/temporary_pins.h"

enum cs_status cs_temporary_pins_init(struct cs_temporary_pins *pins, struct cs_system *system,
                                      struct cs_arena *arena, struct cs_error *error) {
    *pins = (struct cs_temporary_pins){.system = system};
    pins->list = cs_arena_alloc_array(arena, system->view.n, sizeof *pins->list, error);
    return error->status;
}

/* Pinned particles of the system have inverse mass 0 already, and enter the list with the
 * marked ones, in ascending order. */
void cs_temporary_pins_set(struct cs_temporary_pins *pins, const bool *marks) {
    struct cs_system *system = pins->system;
    pins->scene_list = system->pinned;
    pins->n_scene_list = system->n_pinned;
    system->pinned = pins->list;
    system->n_pinned = 0;
    for (uint32_t i = 0; i < system->view.n; i++) {
        if (marks[i])
            system->inv_mass[i] = 0;
        if (system->inv_mass[i] == 0)
            system->pinned[system->n_pinned++] = i;
    }
}

/* Marked particles get 1/mass back, the inverse mass that they had before. */
void cs_temporary_pins_clear(struct cs_temporary_pins *pins, const bool *marks) {
    struct cs_system *system = pins->system;
    if (!pins->scene_list)
        return;
    system->pinned = pins->scene_list;
    system->n_pinned = pins->n_scene_list;
    pins->scene_list = NULL;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (marks[i])
            system->inv_mass[i] = 1 / system->mass[i];
}
