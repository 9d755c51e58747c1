/* overlap_warning.h - warns of bodies that overlap, or could collide during the run, while no
 * contact is defined between them. */
#ifndef CS_OVERLAP_WARNING_H
#define CS_OVERLAP_WARNING_H

#include "base/text.h"
#include "model/system/particle_system.h"
#include "scene/scene.h"

/* Adds one line about the first pair, and how many more there are; nothing if there is none.
 *
 * Compared are the bounding boxes at the start, then boxes of all positions reachable within
 * that many seconds: along its fall for a free body, and for a pinned body within the distance
 * from its last pin to its farthest particle. Boxes are larger than bodies, so a warning can be
 * false. CS_ERR_MEMORY. */
enum cs_status cs_overlap_warning_print(const struct cs_scene *scene, double seconds,
                                        struct cs_text *out, struct cs_error *error);

/* Warns of colliders that are too small for the contact samples of a mesh.
 */

/* Adds one line about the first collider that can enter between the samples of the longest edge
 * (model/contact/contact_samples.h), and how many more there are. Nothing if there is none, or
 * without contact by force. */
void cs_sampling_warning_print(const struct cs_system *system, struct cs_text *out);

/* Warns of bodies that start inside a closed surface they collide with.
 */

/* Adds one line about the first body inside a closed body or mesh collider that it collides
 * with, and how many more there are; nothing if there is none. Contact prevents crossing, hence
 * such a body cannot get out. */
void cs_containment_warning_print(const struct cs_system *system, struct cs_text *out);

#endif
