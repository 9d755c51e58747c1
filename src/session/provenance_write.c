/* Writes provenance as JSON. */
#include "session/provenance_write.h"

#include "base/hash.h"
#include "base/json_writer.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/file/key_frames_read.h"
#include "scene/mesh_keys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

struct walk {
    const struct cs_scene *scene;
    void (*take)(void *ctx, const char *path, const char *what);
    void *ctx;
};

/* Passes on a file that the scene names, relative to its folder. */
static void add_referenced_file(const struct walk *walk, const char *file, const char *what) {
    char path[PATH_BYTES];
    if (*file &&
        snprintf(path, sizeof path, "%s/%s", walk->scene->folder, file) < (int)sizeof path)
        walk->take(walk->ctx, path, what);
}

void cs_scene_each_file(const struct cs_scene *scene,
                        void (*take)(void *ctx, const char *path, const char *what),
                        void *ctx) {
    const struct walk walk = {scene, take, ctx};
    if (strcmp(scene->path, "-") != 0)
        take(ctx, scene->path, "the scene");
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct cs_body *body = cs_scene_bodies(scene) + b;
        add_referenced_file(&walk, body->mesh ? body->mesh->file : "", "a mesh");
        add_referenced_file(&walk, body->material.texture, "a texture");
    }
    for (uint32_t c = 0; c < scene->colliders.n; c++) {
        const struct cs_mesh_source *mesh = cs_scene_colliders(scene)[c].mesh;
        char file[CS_TEXT_MAX];
        add_referenced_file(&walk, mesh ? mesh->file : "", "a mesh");
        for (uint32_t k = 0; mesh && cs_key_frames_file(&mesh->key_frames, k, file); k++)
            add_referenced_file(&walk, file, "key frames");
    }
}

struct list {
    struct cs_text *out;
    bool any;
    struct cs_error *error;
};

/* Adds path and hash of one file, if it exists. */
static void add_file(void *ctx, const char *path, const char *what) {
    struct list *list = ctx;
    char hash[CS_HASH_DIGITS];
    uint64_t bytes;
    (void)what;
    if (list->error->status || access(path, F_OK) ||
        cs_hash_file(path, &bytes, hash, list->error))
        return;
    cs_json_write(list->out, ",\n    {'path': %s, 'hash': %s}", path, hash);
    list->any = true;
}

/* True for a module of the program's own folder, which is stored by name only: the folder
 * differs between machines. */
static bool is_own(const char *file) {
    const char *folder = cs_module_folder();
    const size_t length = strlen(folder);
    return !strncmp(file, folder, length) && file[length] == '/' &&
           !strchr(file + length + 1, '/');
}

enum cs_status cs_provenance_out_find_module(struct cs_session *session,
                                             struct cs_provenance_out_module *module,
                                             struct cs_error *error) {
    const struct cs_integrator *integrator = session->method.integrator;
    const struct cs_registry_entry *found;
    *module = (struct cs_provenance_out_module){.library = ""};
    if (CS_HAS(integrator, library) && integrator->library)
        module->library = integrator->library;
    if (cs_registry_find(&session->registry, integrator->name, &found, error) ||
        cs_hash_file(found->file, NULL, module->hash, error))
        return error->status;
    snprintf(module->file, sizeof module->file, "%s",
             is_own(found->file) ? strrchr(found->file, '/') + 1 : found->file);
    return CS_OK;
}

enum cs_status cs_provenance_out_print_scene(const struct cs_scene *scene, struct cs_text *out,
                                             struct cs_error *error) {
    struct list list = {.out = out, .error = error};
    cs_json_write(out, "  'scene_file': %s,\n  'files': [", scene->path);
    cs_scene_each_file(scene, add_file, &list);
    cs_text_add(out, "%s]", list.any ? "\n  " : "");
    if (!error->status && out->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the provenance of a result");
    return error->status;
}

void cs_provenance_out_print_given(struct cs_scene *scene, struct cs_text *out) {
    struct cs_contact_keys *contact = scene->contact;
    contact->law = contact->law_is_default ? -1 : contact->law;
    contact->damping = contact->damping_is_default ? (double)NAN : contact->damping;
    cs_scene_print(scene, NULL, NULL, 2, out);
}

enum cs_status cs_provenance_out_print(struct cs_session *session, const char *hash,
                                       const char *method, struct cs_text *out,
                                       struct cs_error *error) {
    struct cs_provenance_out_module module;
    if (cs_provenance_out_print_scene(session->scene, out, error) ||
        cs_provenance_out_find_module(session, &module, error))
        return error->status;
    cs_json_write(out, ",\n  'scene_hash': %s,\n  'method': %s,\n", hash, method);
    cs_json_write(out, "  'module': {'file': %s, 'hash': %s, 'library': %s}", module.file,
                  module.hash, module.library);
    return out->failed
               ? cs_fail(error, CS_ERR_MEMORY, "out of memory for the provenance of a result")
               : CS_OK;
}

void cs_provenance_out_add_restarts(uint32_t frames, struct cs_text *out) {
    if (frames)
        cs_json_write(out, "  'restarted_every': %u,\n", frames);
}

/* Removes line breaks and indentation. Strings of JSON contain no raw line break, so all breaks
 * are between values. */
static void add_compact(const char *json, struct cs_text *out) {
    while (*json) {
        const size_t length = strcspn(json, "\n");
        cs_text_add(out, "%.*s", (int)length, json);
        json += length;
        json += strspn(json, "\n ");
    }
}

void cs_provenance_out_print_recipe(const struct cs_picture_provenance *provenance,
                                    struct cs_text *out) {
    struct cs_text whole = {0};
    cs_json_write(&whole,
                  "{'versions': {'clothsim': %s},\n'renderer': %s,\n'renderer_name': %s,\n"
                  "'fast_render': %d,\n",
                  CS_VERSION, provenance->renderer_description, provenance->renderer,
                  provenance->fast_render);
    cs_provenance_out_add_restarts(provenance->restarts, &whole);
    cs_text_add(&whole, "%s,\n\"scene\": %s}", provenance->provenance, provenance->scene);
    add_compact(cs_text_get(&whole), out);
    out->failed |= whole.failed;
    cs_text_finish(&whole);
}

/* Describes the processor, compiler and load under which a measurement was taken. */

/* Reads the model name from /proc/cpuinfo; unchanged if there is none. */
static void read_processor(char *name, size_t size) {
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "re");
    while (file && fgets(line, sizeof line, file))
        if (!strncmp(line, "model name", 10) && strchr(line, ':')) {
            snprintf(name, size, "%s", strchr(line, ':') + 2);
            name[strcspn(name, "\n")] = 0;
            break;
        }
    if (file)
        fclose(file);
}

/* Compiler and flags are those of this file's build, which are the same for the whole program.
 */
void cs_machine_detect(struct cs_machine *machine) {
    *machine = (struct cs_machine){.version = CS_VERSION,
#ifdef __clang__
                                   .compiler = "clang " __clang_version__,
#else
                                   .compiler = "gcc " __VERSION__,
#endif
#ifdef __OPTIMIZE__
                                   .flags = "optimised, -ffp-contract=off",
#else
                                   .flags = "NOT optimised, -ffp-contract=off",
#endif
                                   .processors = sysconf(_SC_NPROCESSORS_ONLN)};
    struct utsname system;
    if (!uname(&system))
        snprintf(machine->host, sizeof machine->host, "%.63s", system.nodename);
    read_processor(machine->processor, sizeof machine->processor);
    if (getloadavg(&machine->load, 1) != 1)
        machine->load = 0;
}

void cs_machine_name(char name[CS_MACHINE_NAME]) {
    struct cs_machine machine;
    cs_machine_detect(&machine);
    snprintf(name, CS_MACHINE_NAME, "%s: %s", machine.host, machine.processor);
}
