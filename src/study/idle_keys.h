/* idle_keys.h - keys that a scene gives, but nothing in it reads. */
#ifndef CS_IDLE_KEYS_H
#define CS_IDLE_KEYS_H

#include "base/text.h"
#include "scene/scene.h"

/* Adds the keys that have another value than their default, but no effect, one per line:
 * "bodies[0].thickness has no effect: ...". */
void cs_idle_keys_print(const struct cs_scene *scene, struct cs_text *out);

/* Returns the index of the rule about a key, "bodies[].springs.shear", or -1: each key of a
 * scene must have one, if only that it always acts. */
int cs_idle_keys_rule(const char *key);

#endif
