/* contact_capacity.h - the energy that contact by force can hold beside the energy that may
 * come, for reports and warnings. */
#ifndef CS_CONTACT_CAPACITY_H
#define CS_CONTACT_CAPACITY_H

#include "base/text.h"
#include "model/system/particle_system.h"

/* Capacity of the contact of two surfaces, beside the energy that comes. */
struct cs_contact_capacity {
    uint32_t a, b;   /* a body; itself, another body, or n_bodies + a collider */
    double range, k; /* m, N/m */
    double holds;    /* J that one contact takes up: cs_barrier_capacity */
    double comes;    /* J of one particle */
    double k_needed; /* N/m with which it holds CS_APPROACH_MARGIN times what comes */
};

/* Sets *out to the two surfaces that hold the least in terms of what comes; where nothing
 * comes, that hold the least. Returns false without contact by force, or if the system is not
 * built. */
bool cs_contact_capacity_find(const struct cs_system *system, struct cs_contact_capacity *out);

/* Adds "a contact of bodies[0] with colliders[0] takes up 3.3 J ...": one line without an end.
 */
void cs_contact_capacity_print(const struct cs_system *system,
                               const struct cs_contact_capacity *capacity, struct cs_text *out);

/* Adds a warning about the scene's contact.stiffness if it holds too little. */
void cs_contact_capacity_warn(const struct cs_system *system, struct cs_text *out);

/* Adds a line about the two surfaces that approach by most ranges of contact per step of dt in
 * s, if that is many; dt 0: nothing. */
void cs_contact_ranges_print(const struct cs_system *system, double dt, struct cs_text *out);

/* Adds `before` and whether contact is a part of linear theory and of runs. Adds nothing for
 * scenes without contact. */
void cs_contact_note_add(const struct cs_scene *scene, const char *before, struct cs_text *out);

/* Adds the energy in J that contact holds beside the one that comes, next
 * to the kinetic energy of the heaviest particle at `speed` (m/s; 0: unknown). Adds the damping
 * by friction, and what longer explicit steps do. Adds nothing for scenes without contact by
 * force. */
void cs_contact_note_add_crossing(const struct cs_system *system, double speed,
                                  struct cs_text *out);

#endif
