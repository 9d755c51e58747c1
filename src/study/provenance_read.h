/* provenance_read.h - reads the provenance stored in run.json, in a picture or in origin.json.
 */
#ifndef CS_PROVENANCE_READ_H
#define CS_PROVENANCE_READ_H

#include "base/text.h"
#include "scene/file/json.h"
#include "study/session.h"

/* Stored provenance; zeroed: nothing. Texts point into the JSON, which it owns. */
struct cs_provenance {
    char *text, *scene;   /* owned: the whole, and the scene in it */
    struct cs_json *json; /* owned: the whole */
    const char *name;     /* borrowed: of the file */
    /* borrowed from root; "" where nothing is said */
    const char *version, *scene_file, *scene_hash, *method, *renderer, *renderer_name;
    const char *module, *module_hash, *library;
    uint32_t restarts; /* see cs_provenance_out_add_restarts */
    bool fast_render;
    const char *folder; /* borrowed: where its files are now; NULL: where they were */
    char path[4096];    /* of the scene, as it is to be read */
};

/* Reads a file. CS_ERR_FILE where it is no such JSON, or holds no scene. */
enum cs_status cs_provenance_read(struct cs_provenance *provenance, const char *file,
                                  struct cs_error *error);
/* The same from a text, which is copied; name is for messages. */
enum cs_status cs_provenance_read_text(struct cs_provenance *provenance, const char *name,
                                       const char *text, struct cs_error *error);
/* Frees everything; all texts become invalid. */
void cs_provenance_finish(struct cs_provenance *provenance);

/* Member of an object as a text or a number; "" and NAN where it is none. */
const char *cs_provenance_text(const struct cs_json *object, const char *key);
double cs_provenance_number(const struct cs_json *object, const char *key);

/* Makes settings of a session run the scene that is carried, by its own method. folder: where
 * its meshes and textures are, NULL: where they were. carried must outlive them. CS_ERR_USAGE
 * where its method came from a module file, and the settings name none. */
enum cs_status cs_provenance_to_session(struct cs_provenance *provenance, const char *folder,
                                        struct cs_session_settings *settings,
                                        struct cs_error *error);

/* Adds a line for each thing that is not what it was when the result was made: the program's
 * version, the build of the module, a library, the files of the scene, what the scene means. */
enum cs_status cs_provenance_add_changes(const struct cs_provenance *provenance,
                                         struct cs_session *session, struct cs_text *out,
                                         struct cs_error *error);

/* Parts of it: the files alone, and one text that is not what it was. */
void cs_provenance_add_changed_files(const struct cs_provenance *provenance,
                                     struct cs_text *out);
void cs_provenance_add_change(const char *what, const char *then, const char *now,
                              struct cs_text *out);

#endif
