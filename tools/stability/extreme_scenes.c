/* Reads the scenes of the catalogue and what each expects of every class of methods. */
#include "stability/extreme_scenes.h"

#include "base/file.h"
#include "scene/file/json.h"
#include "session/scene_view.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_BYTES = 1 << 20 };

const char *const cs_class_names[] = {"explicit", "implicit", "adaptive", NULL};

/* Class of a method, from its traits. */
static enum cs_class class_of(const struct cs_integrator *integrator) {
    if (integrator->traits & CS_ADAPTIVE)
        return CS_CLASS_ADAPTIVE;
    return integrator->traits & CS_IMPLICIT ? CS_CLASS_IMPLICIT : CS_CLASS_EXPLICIT;
}

/* Compares whole words between "|": "bounded" must not match a part of another word. */
bool cs_extreme_expects(const char *expected, const char *word) {
    const size_t length = strlen(word);
    while (*expected) {
        const size_t next = strcspn(expected, "|");
        if (next == length && !strncmp(expected, word, length))
            return true;
        expected += next + (expected[next] == '|');
    }
    return false;
}

/* Rejects unknown outcomes: a misspelt one could never be met. */
static enum cs_status check_words(const char *expected, const char *path,
                                  struct cs_error *error) {
    static const char *const words[] = {"bounded", "finite", "blows up",
                                        "refused", "theory", "over budget"};
    const char *rest = expected;
    while (*rest) {
        const size_t next = strcspn(rest, "|");
        bool known = false;
        for (size_t k = 0; k < sizeof words / sizeof *words; k++)
            known |= next == strlen(words[k]) && !strncmp(rest, words[k], next);
        if (!known)
            return cs_fail(error, CS_ERR_SCENE,
                           "%s: x-extreme: expected one of bounded, finite, blows up, refused, "
                           "over budget, "
                           "theory, found \"%.*s\"",
                           path, (int)next, rest);
        rest += next + (rest[next] == '|');
    }
    return CS_OK;
}

/* Reads "methods": {NAME: EXPECTED, ...}, which is optional. */
static enum cs_status take_own(struct cs_extreme_scene *scene, const struct cs_json *values,
                               struct cs_error *error) {
    const uint32_t most = sizeof scene->per_method / sizeof *scene->per_method;
    const struct cs_json *methods = cs_json_find(values, "methods");
    const struct cs_json *member = methods ? cs_json_first(methods) : NULL;
    for (; member; member = cs_json_next(member)) {
        if (scene->n_per_method == most || !cs_json_key(member) ||
            cs_json_kind_of(member) != CS_JSON_TEXT)
            return cs_fail(error, CS_ERR_SCENE,
                           "%s: x-extreme.methods: expected up to %u texts by method",
                           scene->path, most);
        snprintf(scene->per_method[scene->n_per_method].method,
                 sizeof scene->per_method->method, "%s", cs_json_key(member));
        snprintf(scene->per_method[scene->n_per_method].expected,
                 sizeof scene->per_method->expected, "%s", cs_json_text(member));
        if (check_words(scene->per_method[scene->n_per_method++].expected, scene->path, error))
            return error->status;
    }
    return CS_OK;
}

const char *cs_extreme_expected(const struct cs_extreme_scene *scene,
                                const struct cs_integrator *integrator) {
    for (uint32_t k = 0; k < scene->n_per_method; k++)
        if (!strcmp(scene->per_method[k].method, integrator->name))
            return scene->per_method[k].expected;
    return scene->expected[class_of(integrator)];
}

/* Reads "x-extreme": seconds, dt, and one expectation per class. */
static enum cs_status take_values(struct cs_extreme_scene *scene, const struct cs_json *root,
                                  struct cs_error *error) {
    const struct cs_json *values = cs_json_find(root, "x-extreme");
    const struct cs_json *seconds = cs_json_find_kind(values, "seconds", CS_JSON_NUMBER);
    const struct cs_json *dt = cs_json_find(values, "dt");
    if (!seconds || !(cs_json_number(seconds) > 0) ||
        (dt && cs_json_kind_of(dt) != CS_JSON_NUMBER))
        return cs_fail(error, CS_ERR_SCENE,
                       "%s: x-extreme: expected seconds above 0, and dt a "
                       "number",
                       scene->path);
    scene->seconds = cs_json_number(seconds);
    scene->dt = dt ? cs_json_number(dt) : 0;
    /* no class may be left out: what is not expected could never fail */
    for (int c = 0; c < CS_CLASSES; c++) {
        const struct cs_json *expected =
            cs_json_find_kind(values, cs_class_names[c], CS_JSON_TEXT);
        if (!expected)
            return cs_fail(error, CS_ERR_SCENE, "%s: x-extreme.%s: expected a text",
                           scene->path, cs_class_names[c]);
        snprintf(scene->expected[c], sizeof scene->expected[c], "%s", cs_json_text(expected));
        if (check_words(scene->expected[c], scene->path, error))
            return error->status;
    }
    return take_own(scene, values, error);
}

/* Parses the file for "x-extreme" only; the session reads the scene itself later. */
static enum cs_status read_scene(struct cs_extreme_scene *scene, const char *folder,
                                 const char *file, struct cs_error *error) {
    char *text;
    size_t length;
    struct cs_json *root = NULL;
    struct cs_json_fault fault = {0};
    *scene = (struct cs_extreme_scene){0};
    snprintf(scene->path, sizeof scene->path, "%s/%s", folder, file);
    snprintf(scene->name, sizeof scene->name, "%.*s", (int)strcspn(file, "."), file);
    if (cs_file_read(scene->path, MOST_BYTES, &text, &length, error))
        return error->status;
    if (cs_json_parse(text, length, &root, &fault))
        cs_fail(error, CS_ERR_SCENE, "%s: not a valid scene", scene->path);
    else
        take_values(scene, root, error);
    cs_json_destroy(root);
    free(text);
    return error->status;
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct cs_extreme_scene *)a)->name,
                  ((const struct cs_extreme_scene *)b)->name);
}

/* True for a name with the ending .json and a stem. */
static bool is_scene(const char *name) {
    const size_t length = strlen(name);
    return length > 5 && !strcmp(name + length - 5, ".json");
}

enum cs_status cs_extreme_scenes(const char *folder, struct cs_extreme_scene **scenes,
                                 uint32_t *n, struct cs_error *error) {
    DIR *entries = opendir(folder);
    *scenes = NULL;
    *n = 0;
    if (!entries)
        return cs_fail(error, CS_ERR_FILE, "cannot read the folder \"%s\": %s", folder,
                       strerror(errno));
    for (struct dirent *entry; !error->status && (entry = readdir(entries));) {
        if (!is_scene(entry->d_name))
            continue;
        void *larger = realloc(*scenes, (*n + 1) * sizeof **scenes);
        if (!larger) {
            cs_fail(error, CS_ERR_MEMORY, "out of memory");
            break;
        }
        *scenes = larger;
        read_scene(*scenes + (*n)++, folder, entry->d_name, error);
    }
    closedir(entries);
    if (!*n && !error->status)
        cs_fail(error, CS_ERR_FILE, "no scenes in \"%s\"", folder);
    /* a folder has no order, but a report needs one */
    if (*n)
        qsort(*scenes, *n, sizeof **scenes, by_name);
    return error->status;
}
