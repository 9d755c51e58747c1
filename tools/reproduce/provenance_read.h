/* provenance_read.h - reads the provenance stored in run.json, in a picture or in origin.json.
 */
#ifndef CS_PROVENANCE_READ_H
#define CS_PROVENANCE_READ_H

#include "base/text.h"
#include "scene/file/json.h"
#include "session/session.h"

/* Stored provenance; zeroed: nothing. Texts point into the JSON, which it owns. */
struct cs_provenance {
    char *text, *scene;   /* owned: the whole, and the scene in it */
    struct cs_json *json; /* owned: the whole */
    const char *name;     /* borrowed: of the file */
    /* borrowed from json; "" if absent */
    const char *version, *scene_file, *scene_hash, *method, *renderer, *renderer_name;
    const char *module, *module_hash, *library;
    uint32_t restarts; /* see cs_provenance_out_add_restarts */
    bool fast_render;
    const char *folder; /* borrowed: present folder of its files; NULL: unchanged */
    char path[4096];    /* of the scene, to be read now */
};

/* Reads a file. CS_ERR_FILE if it is no such JSON or contains no scene; CS_ERR_MEMORY. Must be
 * finished in any case. */
enum cs_status cs_provenance_read(struct cs_provenance *provenance, const char *file,
                                  struct cs_error *error);
/* The same from a text, which is copied; name is for messages. */
enum cs_status cs_provenance_read_text(struct cs_provenance *provenance, const char *name,
                                       const char *text, struct cs_error *error);
/* Frees everything; all texts become invalid. */
void cs_provenance_finish(struct cs_provenance *provenance);

/* Returns the member of an object as a text or a number; "" or NAN if there is none of that
 * type. */
const char *cs_provenance_text(const struct cs_json *object, const char *key);
double cs_provenance_number(const struct cs_json *object, const char *key);

/* Sets up a session that runs the stored scene with its method. folder: present folder of its
 * meshes and textures; NULL: unchanged. The settings borrow from the provenance, which must
 * outlive them. CS_ERR_USAGE if the method came from a module file and the settings name none:
 * a module is code, and a result must not choose the code that runs. */
enum cs_status cs_provenance_to_session(struct cs_provenance *provenance, const char *folder,
                                        struct cs_session_settings *settings,
                                        struct cs_error *error);

/* Adds a line for each change since the result was made: version of the program, build of the
 * module, library, files of the scene, meaning of the scene. CS_ERR_MEMORY. */
enum cs_status cs_provenance_add_changes(const struct cs_provenance *provenance,
                                         struct cs_session *session, struct cs_text *out,
                                         struct cs_error *error);

/* Parts of it: the changed files only, and one text if it differs. */
void cs_provenance_add_changed_files(const struct cs_provenance *provenance,
                                     struct cs_text *out);
void cs_provenance_add_change(const char *what, const char *then, const char *now,
                              struct cs_text *out);

#endif
