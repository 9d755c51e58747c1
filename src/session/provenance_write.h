/* provenance_write.h - writes the provenance of a result: everything needed to reproduce it. */
#ifndef CS_PROVENANCE_WRITE_H
#define CS_PROVENANCE_WRITE_H

#include "base/text.h"
#include "session/session.h"

/* Calls take for each file that a scene was read from or names. what: "the scene", "a mesh", "a
 * texture". Standard input is skipped; a texture may be missing. */
void cs_scene_each_file(const struct cs_scene *scene,
                        void (*take)(void *ctx, const char *path, const char *what), void *ctx);

/* Adds the members of a scene, each line indented by two. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_provenance_out_print_scene(const struct cs_scene *scene, struct cs_text *out,
                                             struct cs_error *error);

/* Prints a scene as given: what each method chooses of contact stays absent, in *scene too. */
void cs_provenance_out_print_given(struct cs_scene *scene, struct cs_text *out);

/* Adds those of an open session, scene and method; hash and method are those of
 * the resolved scene. As above. */
enum cs_status cs_provenance_out_print(struct cs_session *session, const char *hash,
                                       const char *method, struct cs_text *out,
                                       struct cs_error *error);

/* Provenance stored in a single picture. */
struct cs_picture_provenance {
    const char *provenance;                      /* the members above */
    const char *scene;                           /* as cs_scene_print prints it */
    const char *renderer, *renderer_description; /* name, and description */
    bool fast_render;                            /* --fast-render */
    uint32_t restarts;                           /* see cs_provenance_out_add_restarts */
};

/* Adds it as one JSON object in one line. */
void cs_provenance_out_print_recipe(const struct cs_picture_provenance *provenance,
                                    struct cs_text *out);

/* Adds the member "restarted_every": frames between the checkpoints at which a method without
 * saved history restarts; nothing for 0. */
void cs_provenance_out_add_restarts(uint32_t frames, struct cs_text *out);

/* The module of a session's method: its name in the program's own folder, or else its path; its
 * hash; its library, or "". */
struct cs_provenance_out_module {
    char file[4096];
    char hash[CS_HASH_DIGITS];
    const char *library; /* borrowed from the module */
};

/* CS_ERR_FILE if it cannot be read. */
enum cs_status cs_provenance_out_find_module(struct cs_session *session,
                                             struct cs_provenance_out_module *module,
                                             struct cs_error *error);

/* Describes the machine that a measurement was made on. */

/* Facts of the machine and the build; texts without a size are constants. */
struct cs_machine {
    char host[64], processor[128]; /* "" unknown */
    long processors;
    double load; /* of the last minute */
    const char *version, *compiler, *flags;
};

/* Fills in what can be found out; unknown facts are "" or 0. Does not fail. */
void cs_machine_detect(struct cs_machine *machine);

enum { CS_MACHINE_NAME = 200 };

/* Writes "host: processor". Times under equal names are comparable. */
void cs_machine_name(char name[CS_MACHINE_NAME]);

#endif
