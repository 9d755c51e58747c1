/* Reads a scene file: JSON text, overrides, tables, integrator, meshes, then the checks.
 *
 * Overrides change the tree, not the structs, so their values pass the same checks as the
 * file's. Meshes are read before the checks, which need their numbers of particles. */
#include "scene/file/scene_read.h"

#include "base/file.h"
#include "scene/contact_keys.h"
#include "scene/file/json_context.h"
#include "scene/picture_keys.h"
#include "scene/scene.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Standard input as a scene file. */

/* Name of standard input in place of a scene file, and its title in messages. */
#define CS_STDIN_INPUT_NAME  "-"
#define CS_STDIN_INPUT_TITLE "standard input"

/* the contents, read once per process */
static struct {
    char *text;
    size_t bytes;
    bool read;
} input;

/* Reads pieces to the end, and only then marks the input as read. */
static enum cs_status read_all(size_t max, struct cs_error *error) {
    enum { PIECE = 1 << 16 };
    while (!feof(stdin)) {
        char *longer = realloc(input.text, input.bytes + PIECE);
        if (!longer)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for " CS_STDIN_INPUT_TITLE);
        input.text = longer;
        errno = 0;
        input.bytes += fread(input.text + input.bytes, 1, PIECE, stdin);
        if (ferror(stdin))
            return cs_fail(error, CS_ERR_FILE, "cannot read " CS_STDIN_INPUT_TITLE ": %s",
                           strerror(errno));
        if (input.bytes > max)
            return cs_fail(error, CS_ERR_FILE,
                           "cannot read " CS_STDIN_INPUT_TITLE ": expected at most %zu bytes",
                           max);
    }
    input.read = true;
    return CS_OK;
}

/* Reads all of standard input, at most max bytes. It is read once and stored until the program
 * ends, because studies open their scene more than once; *text is borrowed. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
static enum cs_status stdin_input_read(size_t max, const char **text, size_t *bytes,
                                       struct cs_error *error) {
    if (!input.read && read_all(max, error))
        return error->status;
    *text = input.text;
    *bytes = input.bytes;
    return CS_OK;
}

#define INTEGRATOR "integrator"

/* Copies text and path into the scene; the folder is the path's, or "." without one. */
static enum cs_status store_source(struct cs_scene *scene, const char *path, const char *text,
                                   size_t bytes, struct cs_error *error) {
    char *copy = cs_arena_alloc(&scene->arena, bytes + 1, error);
    char *folder = copy ? cs_arena_copy_text(&scene->arena, path, error) : NULL;
    scene->path = folder ? cs_arena_copy_text(&scene->arena, path, error) : NULL;
    if (!scene->path)
        return error->status;
    memcpy(copy, text, bytes);
    scene->text = copy;
    scene->text_bytes = bytes;

    char *slash = strrchr(folder, '/');
    if (slash)
        slash[slash == folder] = 0; /* the root keeps its only slash */
    scene->folder = slash ? folder : ".";
    return CS_OK;
}

/* Parses the stored text. */
static enum cs_status parse(const struct cs_scene *scene, struct cs_json **root,
                            struct cs_error *error) {
    return cs_json_parse_named(scene->path, scene->text, scene->text_bytes, root, error);
}

/* Applies the overrides to the tree, in their order. */
static enum cs_status apply_overrides(struct cs_json *root, const struct cs_override *overrides,
                                      uint32_t n, struct cs_error *error) {
    for (uint32_t i = 0; i < n; i++) {
        /* a plain name becomes an object, so that integrator.dt can be set beside it */
        struct cs_json *integrator = cs_json_find(root, INTEGRATOR);
        if (integrator && cs_json_kind_of(integrator) == CS_JSON_TEXT &&
            !cs_json_wrap(integrator, "name"))
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for --set");
        if (cs_json_override(root, &cs_scene_table, overrides[i].path, overrides[i].value,
                             error))
            return error->status;
    }
    return CS_OK;
}

/* Reads the integrator's name; the path of the context is at the name. */
static enum cs_status read_name(struct cs_json_context *context, const struct cs_json *value,
                                struct cs_scene *scene) {
    if (cs_json_kind_of(value) != CS_JSON_TEXT)
        return cs_json_context_fail_type(context, value, "a string");
    const size_t length = strlen(cs_json_text(value));
    // code is run where the user names it, and never by a scene
    if (cs_names_code(cs_json_text(value)))
        return cs_json_context_fail(context, value, false,
                                    "found \"%.60s\", expected a name: a module file is given "
                                    "with --integrator or --plugin, a program with --program",
                                    cs_json_text(value));
    if (length < 1 || length >= sizeof scene->integrator)
        return cs_json_context_fail(context, value, false,
                                    "found %zu characters, expected 1..%zu", length,
                                    sizeof scene->integrator - 1);
    memcpy(scene->integrator, cs_json_text(value), length + 1);
    return CS_OK;
}

/* "FILE:line:column: integrator.", or "--set integrator." */
static const char *copy_place(struct cs_json_context *context, const struct cs_json *value) {
    char place[512];
    size_t offset;
    uint32_t line, column;
    snprintf(place, sizeof place, "--set " INTEGRATOR ".");
    if (cs_json_position(value, context->text, false, &offset)) {
        cs_json_locate(context->text, offset, &line, &column);
        snprintf(place, sizeof place, "%s:%u:%u: " INTEGRATOR ".", context->name, line, column);
    }
    return cs_arena_copy_text(context->arena, place, context->error);
}

/* Stores an option as text: only the integrator knows its type. */
static enum cs_status read_setting(struct cs_json_context *context, const struct cs_json *value,
                                   struct cs_setting *setting) {
    struct cs_text text = {0};
    switch (cs_json_kind_of(value)) {
    case CS_JSON_NUMBER:
        /* the shortest decimal reads back as the same double */
        cs_text_add_real(&text, cs_json_number(value));
        break;
    case CS_JSON_BOOL:
        cs_text_add(&text, cs_json_is_true(value) ? "true" : "false");
        break;
    case CS_JSON_TEXT:
        cs_text_add(&text, "%s", cs_json_text(value));
        break;
    default:
        return cs_json_context_fail_type(context, value, "a number, true, false or a string");
    }
    setting->name = cs_arena_copy_text(context->arena, cs_json_key(value), context->error);
    setting->place = copy_place(context, value);
    setting->is_text = cs_json_kind_of(value) == CS_JSON_TEXT;
    setting->value = cs_arena_copy_text(context->arena, cs_text_get(&text), context->error);
    if (text.failed)
        cs_fail(context->error, CS_ERR_MEMORY, "out of memory for an integrator option");
    cs_text_finish(&text);
    return context->error->status;
}

/* Reads the members of the "integrator" object: its name, and options as text. */
static enum cs_status read_settings(struct cs_json_context *context,
                                    const struct cs_json *object, struct cs_scene *scene) {
    struct cs_list *list = &scene->integrator_settings;
    struct cs_setting *settings = cs_arena_alloc_array(context->arena, cs_json_count(object),
                                                       sizeof *settings, context->error);
    if (!settings)
        return context->error->status;
    for (const struct cs_json *m = cs_json_first(object); m; m = cs_json_next(m)) {
        const char *key = cs_json_key(m);
        if (cs_key_is_free(key))
            continue;
        const size_t outside = cs_json_context_enter(context, key);
        if (strcmp(key, "name") ? read_setting(context, m, settings + list->n++)
                                : read_name(context, m, scene))
            return context->error->status;
        cs_json_context_leave(context, outside);
    }
    list->items = list->n ? settings : NULL;
    return CS_OK;
}

/* Reads "integrator": a name, or an object; absent: the default. */
static enum cs_status read_integrator(struct cs_json_context *context,
                                      const struct cs_json *root, struct cs_scene *scene) {
    snprintf(scene->integrator, sizeof scene->integrator, "%s", CS_INTEGRATOR_DEFAULT);
    const struct cs_json *value = cs_json_find(root, INTEGRATOR);
    if (!value)
        return CS_OK;
    const size_t outside = cs_json_context_enter(context, INTEGRATOR);
    if (cs_json_kind_of(value) == CS_JSON_TEXT)
        read_name(context, value, scene);
    else if (cs_json_kind_of(value) == CS_JSON_OBJECT)
        read_settings(context, value, scene);
    else
        cs_json_context_fail_type(context, value, "an object or a string");
    cs_json_context_leave(context, outside);
    return context->error->status;
}

/* Finds out whether the scene leaves the law of contact to the method. A law that is named is
 * taken as it stands: it keeps the energy of an impact. */
static void find_contact_law(const struct cs_json *root, struct cs_scene *scene) {
    const struct cs_json *contact = cs_json_find(root, "contact");
    scene->contact->law_is_default = !contact || (cs_json_kind_of(contact) == CS_JSON_OBJECT &&
                                                  !cs_json_find(contact, "law"));
    scene->contact->damping_is_default =
        scene->contact->law_is_default && !(contact && (cs_json_find(contact, "damping") ||
                                                        cs_json_find(contact, "restitution")));
}

/* Chooses the camera where the scene says of none where it stands. */
static void choose_camera(const struct cs_json *root, struct cs_scene *scene) {
    static const char *const keys[] = {"frame", "eye", "target", "path"};
    const struct cs_json *camera = cs_json_find(root, "camera");
    bool is_placed = camera && cs_json_kind_of(camera) != CS_JSON_OBJECT;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        is_placed = is_placed || (camera && cs_json_find(camera, keys[k]));
    if (!is_placed)
        scene->camera->frame = CS_FRAME_START;
}

/* Runs cs_scene_check; a failure gets the position of the faulty value. */
static enum cs_status check(struct cs_json_context *context, const struct cs_json *root,
                            struct cs_scene *scene) {
    char path[CS_TEXT_MAX] = "";
    struct cs_error said = {0};
    const enum cs_status status = cs_scene_check(scene, path, &said);
    if (!status)
        return CS_OK;
    if (status != CS_ERR_SCENE)
        return cs_fail(context->error, status, "%s", said.message);
    context->path_length = (size_t)snprintf(context->path, sizeof context->path, "%s", path);
    return cs_json_context_fail(context, cs_json_nearest(root, path), false, "%s",
                                said.message);
}

enum cs_status cs_scene_read_text(struct cs_scene *scene, const char *path, const char *text,
                                  size_t bytes, const struct cs_override *overrides,
                                  uint32_t n_overrides, struct cs_error *error) {
    struct cs_json *root = NULL;
    struct cs_json_context context = {
        .name = path, .arena = &scene->arena, .error = error, .skipped_key = INTEGRATOR};
    enum cs_status status;
    if ((status = cs_scene_init(scene, error)) ||
        (status = store_source(scene, path, text, bytes, error)) ||
        (status = parse(scene, &root, error)))
        goto done;
    context.text = scene->text;
    /* a root that is no object is refused as such before a --set could trip over it */
    if (cs_json_kind_of(root) == CS_JSON_OBJECT &&
        (status = apply_overrides(root, overrides, n_overrides, error)))
        goto done;
    if ((status = cs_table_read(&context, root, &cs_scene_table, scene)) ||
        (status = read_integrator(&context, root, scene)) ||
        (status = cs_scene_read_meshes(&context, root, scene)))
        goto done;
    find_contact_law(root, scene);
    choose_camera(root, scene);
    status = check(&context, root, scene);
done:
    cs_json_destroy(root);
    if (status)
        cs_scene_finish(scene);
    return status;
}

enum cs_status cs_scene_refuse(const struct cs_scene *scene,
                               const struct cs_override *overrides, uint32_t n_overrides,
                               enum cs_status status, const char *message,
                               struct cs_error *error) {
    const struct cs_json *value = NULL;
    struct cs_json *root = NULL;
    struct cs_error unread = {0};
    char path[CS_TEXT_MAX];
    snprintf(path, sizeof path, "%.*s", (int)strcspn(message, ": "), message);
    if (message[strlen(path)] == ':' && !parse(scene, &root, &unread) &&
        !apply_overrides(root, overrides, n_overrides, &unread))
        value = cs_json_nearest(root, path);
    if (!value || value == root) {
        cs_fail(error, status, "%s: %s", scene->path, message);
    } else {
        struct cs_json_context context = {
            .name = scene->path, .text = scene->text, .error = error};
        cs_json_context_fail(&context, value, false, "%s", message);
    }
    cs_json_destroy(root);
    return error->status;
}

/* Reads the scene from standard input. */
static enum cs_status read_input(struct cs_scene *scene, const struct cs_override *overrides,
                                 uint32_t n_overrides, struct cs_error *error) {
    const char *text = NULL;
    size_t bytes = 0;
    if (stdin_input_read(CS_JSON_BYTES_MAX, &text, &bytes, error))
        return error->status;
    return cs_scene_read_text(scene, CS_STDIN_INPUT_TITLE, text, bytes, overrides, n_overrides,
                              error);
}

enum cs_status cs_scene_read(struct cs_scene *scene, const char *path,
                             const struct cs_override *overrides, uint32_t n_overrides,
                             struct cs_error *error) {
    char *text;
    size_t bytes;
    *scene = (struct cs_scene){0};
    if (!strcmp(path, CS_STDIN_INPUT_NAME))
        return read_input(scene, overrides, n_overrides, error);
    enum cs_status status = cs_file_read(path, CS_JSON_BYTES_MAX, &text, &bytes, error);
    if (!status)
        status = cs_scene_read_text(scene, path, text, bytes, overrides, n_overrides, error);
    free(text);
    return status;
}
