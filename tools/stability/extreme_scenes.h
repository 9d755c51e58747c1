/* extreme_scenes.h - scenes of the catalogue of extreme scenes, and what each expects. */
#ifndef CS_EXTREME_SCENES_H
#define CS_EXTREME_SCENES_H

#include "session/session.h"

/* Method classes with one expectation each. Adaptive methods form one class, explicit or not.
 */
enum cs_class { CS_CLASS_EXPLICIT, CS_CLASS_IMPLICIT, CS_CLASS_ADAPTIVE, CS_CLASSES };
extern const char *const cs_class_names[]; /* closed by NULL */

/* Head of a catalogue scene. Texts are copied: a scene can be moved in memory. */
struct cs_extreme_scene {
    char path[512], name[64];
    double seconds, dt; /* s */
    char expected[CS_CLASSES][64];
    struct {
        char method[64], expected[64];
    } per_method[16]; /* methods that are not like their class */
    uint32_t n_per_method;
};

/* Reads all scenes (*.json) of a folder, sorted by name. *scenes is malloc'd (n) and the
 * caller's, after a failure too. Returns CS_ERR_FILE if there are none; CS_ERR_SCENE,
 * CS_ERR_MEMORY. */
enum cs_status cs_extreme_scenes(const char *folder, struct cs_extreme_scene **scenes,
                                 uint32_t *n, struct cs_error *error);

/* Expected outcome of a method: the entry under its name, else that of its class. */
const char *cs_extreme_expected(const struct cs_extreme_scene *scene,
                                const struct cs_integrator *integrator);

/* true if word is among the words of expected ("bounded|refused"). */
bool cs_extreme_expects(const char *expected, const char *word);

#endif
