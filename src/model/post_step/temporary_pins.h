/* temporary_pins.h - particles that are pinned for a while beside those of the scene and its
 * events. */
#ifndef CS_TEMPORARY_PINS_H
#define CS_TEMPORARY_PINS_H

#include "base/arena.h"
#include "model/system/system.h"

struct cs_temporary_pins {
    struct cs_system *system; /* borrowed: inv_mass and the list of pins are changed */
    uint32_t *list;           /* (n) the system's own and the others */
    uint32_t *scene_list,
        n_scene_list; /* the system's list, kept; NULL while it has that one */
};

/* Takes the list from arena. CS_ERR_MEMORY. */
enum cs_status cs_temporary_pins_init(struct cs_temporary_pins *pins, struct cs_system *system,
                                      struct cs_arena *arena, struct cs_error *error);

/* Pins the particles marked in marks (n), of which the system has pinned none. */
void cs_temporary_pins_set(struct cs_temporary_pins *pins, const bool *marks);

/* Undoes that; nothing where it was not done. */
void cs_temporary_pins_clear(struct cs_temporary_pins *pins, const bool *marks);

#endif
