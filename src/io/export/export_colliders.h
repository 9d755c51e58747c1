/* export_colliders.h - the colliders that are drawn, as closed triangle meshes where they are.
 */
#ifndef CS_EXPORT_EXPORT_COLLIDERS_H
#define CS_EXPORT_EXPORT_COLLIDERS_H

#include "io/export/export_mesh.h"

/* Meshes as they are, planes and floors as the square that is drawn of them, spheres, boxes and
 * capsules with points on their surface. Empty where no collider is visible. */
enum cs_status cs_export_mesh_of_colliders(struct cs_export_mesh *skin,
                                           const struct cs_system *system,
                                           struct cs_arena *arena, struct cs_error *error);

/* Sets the positions at a time. */
void cs_export_mesh_pose_colliders(struct cs_export_mesh *skin, const struct cs_system *system,
                                   double t);

#endif
