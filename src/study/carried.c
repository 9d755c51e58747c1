/* Reads what a result carries, and says what has changed since. */
#include "study/carried.h"

#include "base/file.h"
#include "base/hash.h"
#include "io/scene_hash.h"
#include "study/origin.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *cs_carried_text(const struct cs_json *object, const char *key) {
    const struct cs_json *found = cs_json_find_kind(object, key, CS_JSON_TEXT);
    return found ? cs_json_text(found) : "";
}

double cs_carried_number(const struct cs_json *object, const char *key) {
    const struct cs_json *found = cs_json_find_kind(object, key, CS_JSON_NUMBER);
    return found ? cs_json_number(found) : (double)NAN;
}

/* behind the object that begins at a place of a text that was checked */
static size_t end_of_object(const char *text, size_t at) {
    size_t depth = 0;
    do {
        depth += text[at] == '{' || text[at] == '[';
        depth -= text[at] == '}' || text[at] == ']';
        at = text[at] == '"' ? cs_json_skip_text(text, at) : at + 1;
    } while (depth > 0);
    return at;
}

static enum cs_status take_scene(struct cs_carried *carried, struct cs_error *error) {
    const struct cs_json *scene = cs_json_find_kind(carried->root, "scene", CS_JSON_OBJECT);
    size_t begin;
    if (!scene || !*carried->scene_file || !cs_json_place(scene, carried->text, false, &begin))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: expected \"scene\" and \"scene_file\", as clothsim writes them",
                       carried->name);
    carried->scene =
        strndup(carried->text + begin, end_of_object(carried->text, begin) - begin);
    return carried->scene ? CS_OK : cs_fail(error, CS_ERR_MEMORY, "out of memory for a scene");
}

static void take_members(struct cs_carried *carried) {
    const struct cs_json *root = carried->root;
    const struct cs_json *fast = cs_json_find_kind(root, "fast_render", CS_JSON_BOOL);
    const struct cs_json *module = cs_json_find(root, "module");
    const double restarts = cs_carried_number(root, "restarted_every");
    carried->version = cs_carried_text(cs_json_find(root, "versions"), "clothsim");
    carried->scene_file = cs_carried_text(root, "scene_file");
    carried->scene_hash = cs_carried_text(root, "scene_hash");
    carried->method = cs_carried_text(root, "method");
    carried->renderer = cs_carried_text(root, "renderer");
    carried->renderer_name = cs_carried_text(root, "renderer_name");
    carried->module = cs_carried_text(module, "file");
    carried->module_hash = cs_carried_text(module, "hash");
    carried->library = cs_carried_text(module, "library");
    carried->restarts = restarts >= 1 && restarts < 1e9 ? (uint32_t)restarts : 0;
    carried->fast = fast && cs_json_is_true(fast);
}

static enum cs_status parse(struct cs_carried *carried, size_t length, struct cs_error *error) {
    struct cs_json_fault fault;
    uint32_t line, column;
    const enum cs_status status = cs_json_parse(carried->text, length, &carried->root, &fault);
    if (status == CS_ERR_MEMORY)
        return cs_fail(error, status, "out of memory for \"%s\"", carried->name);
    if (status) {
        cs_json_locate(carried->text, fault.offset, &line, &column);
        return cs_fail(error, CS_ERR_FILE, "%s:%u:%u: %s", carried->name, line, column,
                       fault.message);
    }
    take_members(carried);
    return take_scene(carried, error);
}

enum cs_status cs_carried_read(struct cs_carried *carried, const char *file,
                               struct cs_error *error) {
    size_t length;
    *carried = (struct cs_carried){.name = file};
    return cs_file_read(file, CS_JSON_BYTES_MAX, &carried->text, &length, error)
               ? error->status
               : parse(carried, length, error);
}

enum cs_status cs_carried_read_text(struct cs_carried *carried, const char *name,
                                    const char *text, struct cs_error *error) {
    *carried = (struct cs_carried){.name = name, .text = strdup(text)};
    if (!carried->text)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    return parse(carried, strlen(text), error);
}

void cs_carried_finish(struct cs_carried *carried) {
    cs_json_destroy(carried->root);
    free(carried->scene);
    free(carried->text);
    *carried = (struct cs_carried){0};
}

enum cs_status cs_carried_ask(struct cs_carried *carried, const char *folder,
                              struct cs_session_settings *settings, struct cs_error *error) {
    const char *slash = strrchr(carried->scene_file, '/');
    const char *base = folder && slash ? slash + 1 : carried->scene_file;
    if (snprintf(carried->path, sizeof carried->path, "%s%s%s", folder ? folder : "",
                 folder ? "/" : "", base) >= (int)sizeof carried->path)
        return cs_fail(error, CS_ERR_USAGE, "the path of the scene is too long");
    carried->folder = folder;
    settings->scene = carried->path;
    settings->text = carried->scene;
    settings->resolved = true;
    /* a module file is code: it is run where the user names it, and never by a result */
    if (!settings->n_plugins && strchr(carried->module, '/'))
        return cs_fail(error, CS_ERR_USAGE,
                       "%s: its method came from the module %.300s: give that with --plugin",
                       carried->name, carried->module);
    return CS_OK;
}

void cs_carried_tell_other(const char *what, const char *then, const char *now,
                           struct cs_text *out) {
    if (strcmp(then, now) != 0)
        cs_text_add(out, "%s was %s, is %s\n", what, *then ? then : "none",
                    *now ? now : "none");
}

static void tell_module(const struct cs_carried *carried, struct cs_session *session,
                        struct cs_text *out) {
    struct cs_origin_module module;
    cs_origin_find_module(session, &module);
    cs_carried_tell_other("the library", carried->library, module.library, out);
    if (strcmp(carried->module_hash, module.hash) != 0)
        cs_text_add(out, "the module %s is another build\n", carried->module);
}

/* A file of the scene's folder is looked for where that is now. */
static const char *change_of(const struct cs_carried *carried, const char *path,
                             const char *then) {
    const char *slash = strrchr(carried->scene_file, '/');
    const char *from = slash ? carried->scene_file : ".";
    const size_t length = slash ? (size_t)(slash - from) : 1;
    char now[CS_HASH_DIGITS], moved[4096];
    uint64_t bytes;
    struct cs_error unread = {0};
    const bool beside = !strncmp(path, from, length) && path[length] == '/';
    snprintf(moved, sizeof moved, "%s%s", carried->folder && beside ? carried->folder : "",
             carried->folder && beside ? path + length : path);
    if (cs_hash_file(moved, &bytes, now, &unread))
        return "is not there";
    return strcmp(then, now) != 0 ? "has changed" : NULL;
}

/* The scene's own file is not read again: what it held is carried. */
void cs_carried_tell_files(const struct cs_carried *carried, struct cs_text *out) {
    const struct cs_json *files = cs_json_find(carried->root, "files");
    const struct cs_json *file = files ? cs_json_first(files) : NULL;
    for (; file; file = cs_json_next(file)) {
        const char *path = cs_carried_text(file, "path");
        const char *change = change_of(carried, path, cs_carried_text(file, "hash"));
        const bool scene = !strcmp(path, carried->scene_file);
        if (change)
            cs_text_add(out, "%s %s%s\n", path, change,
                        scene ? "; the scene that the result carries was run" : "");
    }
}

enum cs_status cs_carried_tell(const struct cs_carried *carried, struct cs_session *session,
                               struct cs_text *out, struct cs_error *error) {
    char hash[CS_HASH_DIGITS];
    const char *fault = cs_carried_text(carried->root, "arithmetic");
    if (cs_scene_hash(&session->scene, &session->method.table, session->method.options, hash,
                      error))
        return error->status;
    cs_carried_tell_other("the version of clothsim", carried->version, CS_VERSION, out);
    tell_module(carried, session, out);
    cs_carried_tell_files(carried, out);
    if (*carried->scene_hash && strcmp(hash, carried->scene_hash) != 0)
        cs_text_add(out, "the scene means something else (its hash was %s, is %s)\n",
                    carried->scene_hash, hash);
    if (*fault)
        cs_text_add(out, "it was made where arithmetic is another: %s\n", fault);
    return out->failed ? cs_fail(error, CS_ERR_MEMORY, "out of memory for notes") : CS_OK;
}
