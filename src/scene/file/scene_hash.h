/* scene_hash.h - hash of the meaning of a scene, independent of the form of its file. */
#ifndef CS_SCENE_HASH_H
#define CS_SCENE_HASH_H

#include "base/hash.h"
#include "base/status.h"
#include "base/text.h"
#include "scene/scene.h"

/* Hashes a scene with a method's options (its table and filled struct): XXH3 of 128 bits over
 * lines of text, sorted by their bytes, after the line "clothsim scene 1".
 *
 * A value that is not its row's default has a line "path=value", with the value as --resolved
 * prints it (the shortest decimal that reads back; -0 is 0). An element of a list and an
 * optional table that is present have a line "path={}", because presence has a meaning: a scene
 * has wind or not. The integrator's name has a line, and the hash of each mesh file. Defaults
 * have none, so a new key changes the hash of no scene. A changed default must raise the number
 * in the first line.
 *
 * Fails with CS_ERR_MEMORY; digits are then empty. */
enum cs_status cs_scene_hash(const struct cs_scene *scene,
                             const struct cs_table *integrator_table,
                             const void *integrator_options, char digits[CS_HASH_DIGITS],
                             struct cs_error *error);

/* Adds the lines of one struct, in the order of its table; each starts with path ("time."). */
void cs_scene_add_canonical(const struct cs_table *table, const void *object, const char *path,
                            struct cs_text *out);

#endif
