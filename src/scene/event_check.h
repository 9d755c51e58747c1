/* event_check.h - checks of a scene's events that ranges cannot express. */
#ifndef CS_EVENT_CHECK_H
#define CS_EVENT_CHECK_H

#include "scene/scene.h"

/* Checks that times are in order, particles exist and keys can change; normalises directions
 * and fills absent values of viewpoints. cs_scene_check calls it, and its failures are alike:
 * path_out (CS_TEXT_MAX bytes) gets the JSON path. */
enum cs_status cs_events_check(struct cs_scene *scene, char *path_out, struct cs_error *error);

#endif
