/* plan.h - the plan of a scene and a method: which features are needed, decided once, and the
 * basis of all that is built and printed. */
#ifndef CS_PLAN_H
#define CS_PLAN_H

#include "base/text.h"
#include "model/system/particle_system.h"

#include <clothsim/integrator.h>

/* Decides all features of a checked scene, for a method with these needs (set of enum cs_need),
 * with or without drawn frames. Overwrites *plan; allocates nothing. */
void cs_plan_make(struct cs_plan *plan, const struct cs_scene *scene, uint32_t needs,
                  bool render);

/* Chooses the law of contact of a scene that names none: force, or project for a method that
 * cannot follow a force, and for bodies without springs or membranes to derive its stiffness
 * from. Surfaces of bodies and meshes always meet by force. */
void cs_plan_choose_contact_law(struct cs_scene *scene, const struct cs_integrator *method);

/* Checks that a method can follow the scene. Shape matching is no force law, so it needs a
 * method of its own, and that method needs shape matching; contact by force is too stiff for
 * methods that treat it explicitly, and colliders that move make energy in one whose drag holds
 * what they should carry. Returns CS_ERR_SCENE; the message begins with the JSON
 * path. */
enum cs_status cs_plan_check(const struct cs_scene *scene, const struct cs_integrator *method,
                             struct cs_error *error);

/* Tells whether a method moves springs by a model of its own instead of their force: elastic
 * bodies are not for it. */
bool cs_plan_has_own_springs(const struct cs_integrator *method);

/* Appends the plan as aligned text, one feature per line, with the bytes allocated for it so
 * far. */
void cs_plan_print(const struct cs_plan *plan, struct cs_text *out);

/* Builds the system of a scene. */

/* Builds the system of a checked scene by its plan, with all arrays in the system's arena. The
 * scene must outlive it. On failure *system is empty, and the status is CS_ERR_MEMORY, or
 * CS_ERR_SCENE from a force. */
enum cs_status cs_system_build(struct cs_system *system, const struct cs_scene *scene,
                               const struct cs_plan *plan, struct cs_error *error);

/* How the threads of the pool share a system: blocks of particles, chunks
 * of springs.
 *
 * Each thread adds forces to the particles of its own block alone, in the order in which one
 * thread would. Sums, and the bits of the state, are therefore those of one thread. */

/* Fills the partition in system->springs for the pool's present number of threads; bodies and
 * runs must be there. It stays valid for any number of threads. Returns CS_ERR_MEMORY if out of
 * memory. */
enum cs_status cs_thread_partition_build(struct cs_system *system, struct cs_error *error);

#endif
