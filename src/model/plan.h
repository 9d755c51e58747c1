/* plan.h - what a scene and a method ask for: decided once, built by it, and printed. */
#ifndef CS_PLAN_H
#define CS_PLAN_H

#include "base/text.h"
#include "model/system/feature.h"
#include "scene/scene.h"

#include <clothsim/integrator.h>

/* Decides from a checked scene, the method's needs (enum cs_need) and whether frames are drawn.
 */
void cs_plan_make(struct cs_plan *plan, const struct cs_scene *scene, uint32_t needs,
                  bool render);

/* Whether a method can follow the scene: shape matching is no force law, and a
 * method that is made for it has nothing to do without; and contact by force is stiff. The
 * message starts with the JSON path. CS_ERR_SCENE. */
enum cs_status cs_plan_check(const struct cs_scene *scene, const struct cs_integrator *method,
                             struct cs_error *error);

/* Prints it as aligned text, one feature a line, with the bytes that were taken for it so far.
 */
void cs_plan_print(const struct cs_plan *plan, struct cs_text *out);

#endif
