/* contact_note.h - how contact enters the studies of stability, in words. */
#ifndef CS_CONTACT_NOTE_H
#define CS_CONTACT_NOTE_H

#include "base/text.h"
#include "model/system/system.h"

/* Adds `before` and whether linear theory and runs have contact; nothing in scenes without
 * colliders. */
void cs_contact_note_add(const struct cs_scene *scene, const char *before, struct cs_text *out);

/* Adds the energy that a particle needs to cross the thinnest obstacle, beside the most that
 * one with the speed (m/s) can have, and what friction does to explicit steps; nothing in
 * scenes without contact by force. */
void cs_contact_note_add_crossing(const struct cs_system *system, double speed,
                                  struct cs_text *out);

#endif
