/* solids.h - the colliders that are drawn, as closed triangle meshes where they are. */
#ifndef CS_EXPORT_SOLIDS_H
#define CS_EXPORT_SOLIDS_H

#include "export/skin.h"

/* Meshes as they are, planes and floors as the square that is drawn of them, spheres, boxes and
 * capsules with points on their surface. Empty where no collider is visible. */
enum cs_status cs_skin_of_colliders(struct cs_skin *skin, const struct cs_system *system,
                                    struct cs_arena *arena, struct cs_error *error);

/* Sets the positions at a time. */
void cs_skin_place_colliders(struct cs_skin *skin, const struct cs_system *system, double t);

#endif
