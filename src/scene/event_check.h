/* event_check.h - what single ranges cannot say about a scene's events. */
#ifndef CS_EVENT_CHECK_H
#define CS_EVENT_CHECK_H

#include "scene/scene.h"

/* Times in order, particles that exist, keys that can change; makes directions unit vectors.
 * Called by cs_scene_check, whose conditions hold: path_out (CS_TEXT_MAX bytes) is the place.
 */
enum cs_status cs_events_check(struct cs_scene *scene, char *path_out, struct cs_error *error);

#endif
