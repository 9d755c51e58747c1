/* scene_write.h - prints a complete scene, the schema and the manual from the same tables. */
#ifndef CS_SCENE_WRITE_H
#define CS_SCENE_WRITE_H

#include "base/text.h"
#include "scene/scene.h"

/* Adds the scene as JSON with every value present (absent optional ones left out), indented by
 * `indent` spaces after the first line. The integrator is printed with the given resolved
 * options (its table and filled struct; table NULL: the scene's own settings as they stand).
 * Reading it back gives the same scene. */
void cs_scene_print(const struct cs_scene *scene, const struct cs_table *integrator_table,
                    const void *integrator_options, int indent, struct cs_text *out);

/* Adds the JSON schema (2020-12) of scene files. */
void cs_scene_print_schema(struct cs_text *out);

/* Adds the rows of the scene tables as scdoc text, for clothsim-scene(5). */
void cs_scene_print_manual(struct cs_text *out);

#endif
