/* temporary_pins.h - temporary pins, in addition to those of the scene and its events.
 *
 * While they are set, pinned particles have inverse mass 0 and are in the system's list of
 * pins, so that forces, solvers and preconditioners treat them like permanent ones. */
#ifndef CS_TEMPORARY_PINS_H
#define CS_TEMPORARY_PINS_H

#include "base/arena.h"
#include "model/system/system.h"

/* A replacement of the system's list of pins. */
struct cs_temporary_pins {
    struct cs_system *system; /* borrowed: inv_mass and the list of pins are changed */
    /* (n) pins of the system and temporary ones */
    uint32_t *list;
    uint32_t *scene_list,
        n_scene_list; /* the system's list, kept; NULL while it has that one */
};

/* Allocates the list in the arena. CS_ERR_MEMORY. */
enum cs_status cs_temporary_pins_init(struct cs_temporary_pins *pins, struct cs_system *system,
                                      struct cs_arena *arena, struct cs_error *error);

/* Pins the particles marked in marks (n); none of them may be pinned already. */
void cs_temporary_pins_set(struct cs_temporary_pins *pins, const bool *marks);

/* Restores masses and list for the same marks; does nothing if no pins are set. */
void cs_temporary_pins_clear(struct cs_temporary_pins *pins, const bool *marks);

#endif
