/* system_build.h - makes the system of a scene. */
#ifndef CS_SYSTEM_BUILD_H
#define CS_SYSTEM_BUILD_H

#include "model/system/system.h"

/* Builds the system of a checked scene by its plan. On failure CS_ERR_MEMORY and *system is
 * empty. The scene must outlive the system. */
enum cs_status cs_system_build(struct cs_system *system, const struct cs_scene *scene,
                               const struct cs_plan *plan, struct cs_error *error);

#endif
