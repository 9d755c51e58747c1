/* system_build.h - builds the system of a scene. */
#ifndef CS_SYSTEM_BUILD_H
#define CS_SYSTEM_BUILD_H

#include "model/system/system.h"

/* Builds the system of a checked scene by its plan, with all arrays in the system's arena. The
 * scene must outlive it. On failure *system is empty, and the status is CS_ERR_MEMORY, or
 * CS_ERR_SCENE from a force. */
enum cs_status cs_system_build(struct cs_system *system, const struct cs_scene *scene,
                               const struct cs_plan *plan, struct cs_error *error);

#endif
