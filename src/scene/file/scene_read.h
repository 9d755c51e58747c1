/* scene_read.h - strict reader of scene files. */
#ifndef CS_SCENE_READ_H
#define CS_SCENE_READ_H

#include "base/hash.h"
#include "base/status.h"
#include "base/text.h"

struct cs_scene;
struct cs_table;

/* One --set: a JSON path, and a JSON value or a bare word, which is taken as a text. */
struct cs_override {
    const char *path, *value; /* "bodies[0].springs.stretch", "200" */
};

/* Reads, overrides, parses and checks (cs_scene_check) a scene. Every message starts with
 * `file:line:column: path: ` (values from --set: `--set path: `). On failure CS_ERR_FILE,
 * CS_ERR_SCENE, CS_ERR_USAGE (a --set that cannot be read) or CS_ERR_MEMORY; *scene is then
 * empty. The caller releases it by cs_scene_finish. */
enum cs_status cs_scene_read(struct cs_scene *scene, const char *path,
                             const struct cs_override *overrides, uint32_t n_overrides,
                             struct cs_error *error);

/* The same from text in memory; path is for messages, and for the folder of textures and
 * meshes. */
enum cs_status cs_scene_read_text(struct cs_scene *scene, const char *path, const char *text,
                                  size_t bytes, const struct cs_override *overrides,
                                  uint32_t n_overrides, struct cs_error *error);

/* Fails with a message about a scene that has been read: `file:line:column: message` with the
 * position of the value that the message names by a path before its first colon, or of the
 * nearest above it; `--set message` where an override gave that value, else `file: message`. */
enum cs_status cs_scene_refuse(const struct cs_scene *scene,
                               const struct cs_override *overrides, uint32_t n_overrides,
                               enum cs_status status, const char *message,
                               struct cs_error *error);

/* Prints a complete scene, the schema and the manual from the same tables. */

/* Adds the scene as JSON with every value present (absent optional ones left out), indented by
 * `indent` spaces after the first line. The integrator is printed with the given resolved
 * options (its table and filled struct; table NULL: the scene's own settings as they stand).
 * Reading it back gives the same scene. */
void cs_scene_print(const struct cs_scene *scene, const struct cs_table *integrator_table,
                    const void *integrator_options, int indent, struct cs_text *out);

/* Hash of the meaning of a scene, independent of the form of its file. */

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
