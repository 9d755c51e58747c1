/* contact_note.h - notes on the role of contact in the stability studies, as text. */
#ifndef CS_CONTACT_NOTE_H
#define CS_CONTACT_NOTE_H

#include "base/text.h"
#include "model/system/system.h"

/* Adds `before` and whether contact is a part of linear theory and of runs. Adds nothing for
 * scenes without contact. */
void cs_contact_note_add(const struct cs_scene *scene, const char *before, struct cs_text *out);

/* Adds the energy in J that a particle needs to cross the thinnest collider, next to the
 * kinetic energy of the heaviest particle at `speed` (m/s; 0: unknown). Adds the damping by
 * friction that limits explicit steps. Adds nothing for scenes without contact by force. */
void cs_contact_note_add_crossing(const struct cs_system *system, double speed,
                                  struct cs_text *out);

#endif
