/* Reads stored provenance, and reports what has changed since. */
#include "reproduce/provenance_read.h"

#include "base/file.h"
#include "base/hash.h"
#include "session/provenance_write.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *cs_provenance_text(const struct cs_json *object, const char *key) {
    const struct cs_json *found = cs_json_find_kind(object, key, CS_JSON_TEXT);
    return found ? cs_json_text(found) : "";
}

double cs_provenance_number(const struct cs_json *object, const char *key) {
    const struct cs_json *found = cs_json_find_kind(object, key, CS_JSON_NUMBER);
    return found ? cs_json_number(found) : (double)NAN;
}

/* Returns the position after the object that begins at `at`, in a text that was parsed before.
 * Counts brackets outside of strings. */
static size_t end_of_object(const char *text, size_t at) {
    size_t depth = 0;
    do {
        depth += text[at] == '{' || text[at] == '[';
        depth -= text[at] == '}' || text[at] == ']';
        at = text[at] == '"' ? cs_json_skip_text(text, at) : at + 1;
    } while (depth > 0);
    return at;
}

/* Copies the scene's text, as it was read, out of the whole. */
static enum cs_status take_scene(struct cs_provenance *provenance, struct cs_error *error) {
    const struct cs_json *scene = cs_json_find_kind(provenance->json, "scene", CS_JSON_OBJECT);
    size_t begin;
    if (!scene || !*provenance->scene_file ||
        !cs_json_position(scene, provenance->text, false, &begin))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: expected \"scene\" and \"scene_file\", as clothsim writes them",
                       provenance->name);
    provenance->scene =
        strndup(provenance->text + begin, end_of_object(provenance->text, begin) - begin);
    return provenance->scene ? CS_OK
                             : cs_fail(error, CS_ERR_MEMORY, "out of memory for a scene");
}

/* Takes the members that older versions may lack: absent ones are "" or 0. */
static void take_members(struct cs_provenance *provenance) {
    const struct cs_json *root = provenance->json;
    const struct cs_json *fast = cs_json_find_kind(root, "fast_render", CS_JSON_BOOL);
    const struct cs_json *module = cs_json_find(root, "module");
    const double restarts = cs_provenance_number(root, "restarted_every");
    provenance->version = cs_provenance_text(cs_json_find(root, "versions"), "clothsim");
    provenance->scene_file = cs_provenance_text(root, "scene_file");
    provenance->scene_hash = cs_provenance_text(root, "scene_hash");
    provenance->method = cs_provenance_text(root, "method");
    provenance->renderer = cs_provenance_text(root, "renderer");
    provenance->renderer_name = cs_provenance_text(root, "renderer_name");
    provenance->module = cs_provenance_text(module, "file");
    provenance->module_hash = cs_provenance_text(module, "hash");
    provenance->library = cs_provenance_text(module, "library");
    provenance->restarts = restarts >= 1 && restarts < 1e9 ? (uint32_t)restarts : 0;
    provenance->fast_render = fast && cs_json_is_true(fast);
}

/* Parses the text and takes its members. A fault names line and column. */
static enum cs_status parse(struct cs_provenance *provenance, size_t length,
                            struct cs_error *error) {
    struct cs_json_fault fault;
    uint32_t line, column;
    const enum cs_status status =
        cs_json_parse(provenance->text, length, &provenance->json, &fault);
    if (status == CS_ERR_MEMORY)
        return cs_fail(error, status, "out of memory for \"%s\"", provenance->name);
    if (status) {
        cs_json_locate(provenance->text, fault.offset, &line, &column);
        return cs_fail(error, CS_ERR_FILE, "%s:%u:%u: %s", provenance->name, line, column,
                       fault.message);
    }
    take_members(provenance);
    return take_scene(provenance, error);
}

enum cs_status cs_provenance_read(struct cs_provenance *provenance, const char *file,
                                  struct cs_error *error) {
    size_t length;
    *provenance = (struct cs_provenance){.name = file};
    return cs_file_read(file, CS_JSON_BYTES_MAX, &provenance->text, &length, error)
               ? error->status
               : parse(provenance, length, error);
}

enum cs_status cs_provenance_read_text(struct cs_provenance *provenance, const char *name,
                                       const char *text, struct cs_error *error) {
    *provenance = (struct cs_provenance){.name = name, .text = strdup(text)};
    if (!provenance->text)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    return parse(provenance, strlen(text), error);
}

void cs_provenance_finish(struct cs_provenance *provenance) {
    cs_json_destroy(provenance->json);
    free(provenance->scene);
    free(provenance->text);
    *provenance = (struct cs_provenance){0};
}

/* The scene is taken from the stored text, not from its file: that may have changed. With
 * `folder` only the folder of the path is replaced, because meshes and textures are named
 * relative to it. */
enum cs_status cs_provenance_to_session(struct cs_provenance *provenance, const char *folder,
                                        struct cs_session_settings *settings,
                                        struct cs_error *error) {
    const char *slash = strrchr(provenance->scene_file, '/');
    const char *base = folder && slash ? slash + 1 : provenance->scene_file;
    if (snprintf(provenance->path, sizeof provenance->path, "%s%s%s", folder ? folder : "",
                 folder ? "/" : "", base) >= (int)sizeof provenance->path)
        return cs_fail(error, CS_ERR_USAGE, "the path of the scene is too long");
    provenance->folder = folder;
    settings->scene = provenance->path;
    settings->text = provenance->scene;
    settings->has_all_values = true;
    /* a module file is code: it is run where the user names it, and never by a result */
    if (!settings->n_plugins && strchr(provenance->module, '/'))
        return cs_fail(error, CS_ERR_USAGE,
                       "%s: its method is in %.300s; pass that with --plugin, or its program "
                       "with --program",
                       provenance->name, provenance->module);
    return CS_OK;
}

/* Adds "what was THEN, is NOW" if the two differ. */
void cs_provenance_add_change(const char *what, const char *then, const char *now,
                              struct cs_text *out) {
    if (strcmp(then, now) != 0)
        cs_text_add(out, "%s was %s, is %s\n", what, *then ? then : "none",
                    *now ? now : "none");
}

/* Changes of the method's library and of its module's build. */
static enum cs_status print_module(const struct cs_provenance *provenance,
                                   struct cs_session *session, struct cs_text *out,
                                   struct cs_error *error) {
    struct cs_provenance_out_module module;
    if (cs_provenance_out_find_module(session, &module, error))
        return error->status;
    cs_provenance_add_change("the library", provenance->library, module.library, out);
    if (strcmp(provenance->module_hash, module.hash) != 0)
        cs_text_add(out, "the module %s is a different build\n", provenance->module);
    return CS_OK;
}

/* Returns how a file has changed, or NULL. Files of the scene's folder are looked for in its
 * present folder. */
static const char *change_of(const struct cs_provenance *provenance, const char *path,
                             const char *then) {
    const char *slash = strrchr(provenance->scene_file, '/');
    const char *from = slash ? provenance->scene_file : ".";
    const size_t length = slash ? (size_t)(slash - from) : 1;
    char now[CS_HASH_DIGITS], moved[4096];
    uint64_t bytes;
    struct cs_error unread = {0};
    const bool beside = !strncmp(path, from, length) && path[length] == '/';
    snprintf(moved, sizeof moved, "%s%s",
             provenance->folder && beside ? provenance->folder : "",
             provenance->folder && beside ? path + length : path);
    if (cs_hash_file(moved, &bytes, now, &unread))
        return access(moved, F_OK) ? "is missing" : "cannot be read";
    return strcmp(then, now) != 0 ? "has changed" : NULL;
}

/* The scene's own file is not read again: what it held is carried. */
void cs_provenance_add_changed_files(const struct cs_provenance *provenance,
                                     struct cs_text *out) {
    const struct cs_json *files = cs_json_find(provenance->json, "files");
    const struct cs_json *file = files ? cs_json_first(files) : NULL;
    for (; file; file = cs_json_next(file)) {
        const char *path = cs_provenance_text(file, "path");
        const char *change = change_of(provenance, path, cs_provenance_text(file, "hash"));
        const bool scene = !strcmp(path, provenance->scene_file);
        if (change)
            cs_text_add(out, "%s %s%s\n", path, change,
                        scene ? "; the scene stored in the result was run" : "");
    }
}

/* A different hash of the resolved scene means that a default or the meaning of a key has
 * changed, since the text is the stored one. */
enum cs_status cs_provenance_add_changes(const struct cs_provenance *provenance,
                                         struct cs_session *session, struct cs_text *out,
                                         struct cs_error *error) {
    char hash[CS_HASH_DIGITS];
    const char *fault = cs_provenance_text(provenance->json, "arithmetic");
    if (cs_scene_hash(session->scene, &session->method.table, session->method.options, hash,
                      error))
        return error->status;
    cs_provenance_add_change("the version of clothsim", provenance->version, CS_VERSION, out);
    if (print_module(provenance, session, out, error))
        return error->status;
    cs_provenance_add_changed_files(provenance, out);
    if (*provenance->scene_hash && strcmp(hash, provenance->scene_hash) != 0)
        cs_text_add(out, "the scene has changed (hash was %s, is now %s)\n",
                    provenance->scene_hash, hash);
    if (*fault)
        cs_text_add(out, "it was made with different arithmetic: %s\n", fault);
    return out->failed ? cs_fail(error, CS_ERR_MEMORY, "out of memory for notes") : CS_OK;
}
