/* event_key.h - the number that a ramp changes, found by its path: forces.wind.strength */
#ifndef CS_EVENT_KEY_H
#define CS_EVENT_KEY_H

#include "base/status.h"

#include <stdbool.h>

struct cs_event;
struct cs_option;
struct cs_scene;

/* A number of the scene and its row of the tables. */
struct cs_event_key {
    const struct cs_option *row;
    double *value; /* in the scene, borrowed */
};

/* Finds the number of a path such as bodies[0].springs.stretch or forces.gravity[1]. Fails with
 * CS_ERR_SCENE and a reason if there is none, or if it cannot change during a run. Each number
 * has exactly one spelling, so equal paths mean equal numbers. */
enum cs_status cs_event_key_find(struct cs_scene *scene, const char *path,
                                 struct cs_event_key *key, struct cs_error *error);

/* Returns true for an event that is a ramp of such a key: it has no times in a run. */
bool cs_event_is_picture(const struct cs_event *event);

/* Returns true if a ramp of the scene gives a value other than 0 to a key whose path contains
 * `key`. */
bool cs_event_key_changes(const struct cs_scene *scene, const char *key);

/* Returns true if a number of the scene is ever other than 0: now, or after a ramp of `key`. */
bool cs_event_key_acts(const struct cs_scene *scene, double value, const char *key);

/* Returns true if an event releases pins. */
bool cs_event_releases_any(const struct cs_scene *scene);

/* Returns true if an event of a checked scene moves the surface of a collider by its radius or
 * thickness. */
bool cs_event_grows(const struct cs_event *event);

/* Returns true if an event of a checked scene changes masses. */
bool cs_event_changes_mass(const struct cs_event *event);

/* Check of a view: an eye, its target, and the direction up. */

/* Returns the fault of a view, or NULL; *key is then "target" or "up". */
const char *cs_viewpoint_fault(const double eye[3], const double target[3], const double up[3],
                               const char **key);

#endif
