/* extreme_scene.h - a scene of the catalogue: its file, and what it expects of whom. */
#ifndef CS_EXTREME_SCENE_H
#define CS_EXTREME_SCENE_H

#include "base/status.h"

#include <clothsim/integrator.h>

enum cs_class { CS_CLASS_EXPLICIT, CS_CLASS_IMPLICIT, CS_CLASS_ADAPTIVE, CS_CLASSES };
extern const char *const cs_class_names[]; /* closed by NULL */
enum cs_class cs_class_of(const struct cs_integrator *integrator);

struct cs_extreme_scene {
    char path[512], name[64];
    double seconds, dt; /* s */
    char expected[CS_CLASSES][64];
    struct {
        char method[64], expected[64];
    } per_method[16]; /* methods that are not like their class */
    uint32_t n_per_method;
};

/* Reads "x-extreme" of a scene file. CS_ERR_FILE, CS_ERR_SCENE. */
enum cs_status cs_extreme_scene_read(struct cs_extreme_scene *scene, const char *folder,
                                     const char *file, struct cs_error *error);

/* The scenes of a folder by name, malloc'd. CS_ERR_FILE where there are none. */
enum cs_status cs_extreme_scenes(const char *folder, struct cs_extreme_scene **scenes,
                                 uint32_t *n, struct cs_error *error);

/* What a scene expects of a method: under its own name, else of its class. */
const char *cs_extreme_expected(const struct cs_extreme_scene *scene,
                                const struct cs_integrator *integrator);

/* true if word is among the words of expected ("bounded|refused"). */
bool cs_extreme_expects(const char *expected, const char *word);

#endif
