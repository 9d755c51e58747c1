/* event_key.h - the number that a ramp moves, found by its path: forces.wind.strength */
#ifndef CS_EVENT_KEY_H
#define CS_EVENT_KEY_H

#include "scene/scene.h"

struct cs_event_key {
    const struct cs_option *row;
    double *value; /* in the scene */
};

/* Finds the number of a path such as bodies[0].springs.stretch or forces.gravity[1].
 * CS_ERR_SCENE with a reason where there is none, or where it cannot change during a run. Of
 * one number there is one spelling. */
enum cs_status cs_event_key_find(struct cs_scene *scene, const char *path,
                                 struct cs_event_key *key, struct cs_error *error);

/* true if an event of the scene gives a value above 0 (or other than 0 where it may be
 * negative) to a key that ends with (or, with an index behind it, is) `key` */
bool cs_event_key_changes(const struct cs_scene *scene, const char *key);

/* Whether a number of the scene is ever other than 0: now, or by an event that changes `key`.
 */
bool cs_event_key_acts(const struct cs_scene *scene, double value, const char *key);

/* Whether an event of a checked scene changes masses. */
bool cs_event_changes_mass(const struct cs_event *event);

#endif
