/* scene_hash.h - a name for what a scene means, whatever its file looks like. */
#ifndef CS_SCENE_HASH_H
#define CS_SCENE_HASH_H

#include "base/hash.h"
#include "base/status.h"
#include "base/text.h"
#include "scene/scene.h"

/* The hash of a scene with a method's options (its table and filled struct): XXH3 of 128 bits
 * over lines of text, sorted by their bytes, below the line "clothsim scene 1".
 *
 * A value that is not its row's default has a line "path=value", with the value as --resolved
 * prints it (the shortest decimal that reads back; -0 is 0). An element of a list and an
 * optional table that is there have a line "path={}": that a scene has wind at all means
 * something. The integrator's name has a line, and so has the hash of each mesh file. What
 * stays at its default has none, so that a key which the program learns later changes no
 * scene's hash; who changes a default raises the number in the first line.
 *
 * CS_ERR_MEMORY; digits are then empty. */
enum cs_status cs_scene_hash(const struct cs_scene *scene,
                             const struct cs_table *integrator_table,
                             const void *integrator_options, char digits[CS_HASH_DIGITS],
                             struct cs_error *error);

/* Adds the lines of one struct, in the order of its table; path stands before each ("time.").
 */
void cs_scene_add_canonical(const struct cs_table *table, const void *object, const char *path,
                            struct cs_text *out);

#endif
