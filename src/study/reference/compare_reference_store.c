/* Stores a reference in a file for further comparisons of the scene. */
#include "study/reference/compare_reference_state.h"

#include "base/file.h"
#include "base/hash.h"
#include "session/scene_view.h"
#include "session/session.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC "clothsim ref 1\n"

enum { FILE_BYTES_MAX = 1 << 30 };

/* Head of the file, in the byte order of the machine: on another one `one` is not 1, and the
 * file counts as missing. */
struct header {
    char magic[16];
    double one;
    uint32_t n, frames;
    double fps;
    char hash[40];                         /* of the head without it, and of the states */
    struct cs_compare_reference reference; /* pointers in it mean nothing */
};

enum cs_status cs_compare_reference_key(const struct cs_compare_reference *reference,
                                        const struct cs_recorded_run *recording,
                                        const struct cs_compare_reference_settings *settings,
                                        char *key, struct cs_error *error) {
    const struct cs_session_settings *session = &settings->run->session;
    const struct cs_scene *scene = recording->session.scene;
    const size_t values = 6 * (size_t)recording->session.system.view.n;
    const struct cs_method *method = &recording->session.method;
    char start[CS_HASH_DIGITS], of_scene[CS_HASH_DIGITS];
    struct cs_text all = {0};
    if (cs_scene_hash(scene, &method->table, method->options, of_scene, error))
        return error->status;
    // meshes are files of their own or made here: the start is as they came out
    cs_hash_doubles(recording->initial_state, values, start);
    cs_text_add(&all, "%s|", start);
    cs_text_add(&all, "%s|%zu|%u|%.17g|%.17g|", CS_VERSION, sizeof(struct header),
                settings->run->frames, scene->time.fps, settings->accuracy);
    for (int k = 0; k < CS_COMPARE_REFERENCE_RUNS; k++)
        cs_text_add(&all, "%s|", reference->methods[k]);
    // where the methods are chosen here, a module that is added changes nothing
    for (uint32_t k = 0; k < session->n_plugins && settings->methods[0]; k++)
        cs_text_add(&all, "%s|", session->plugins[k]);
    cs_text_add(&all, "%s", of_scene);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the name of a reference");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, key);
    cs_text_finish(&all);
    return error->status;
}

/* Path of the file; 16 digits of the key suffice for its name. */
static void file_path(const char *folder, const char *key, char *path, size_t size) {
    snprintf(path, size, "%s/reference-%.16s.state", folder, key);
}

/* Hash of everything in the file but the hash itself. */
static void hash_file(const struct header *header, const double *states, size_t values,
                      char hash[CS_HASH_DIGITS]) {
    char both[2 * CS_HASH_DIGITS], head[sizeof *header];
    memcpy(head, header, sizeof head);
    memset(head + offsetof(struct header, hash), 0, sizeof header->hash);
    cs_hash_bytes(head, sizeof head, both);
    cs_hash_doubles(states, values, both + CS_HASH_DIGITS);
    cs_hash_bytes(both, sizeof both, hash);
}

bool cs_compare_reference_read(struct cs_compare_reference *reference, const char *folder,
                               const char *key, const struct cs_recorded_run *recording) {
    char path[4096], *bytes, hash[CS_HASH_DIGITS];
    size_t length;
    struct cs_error missing = {0};
    struct header header;
    file_path(folder, key, path, sizeof path);
    if (cs_file_read(path, FILE_BYTES_MAX, &bytes, &length, &missing))
        return false;
    struct cs_trajectory trajectory;
    bool good = length > sizeof header && !cs_trajectory_init(&trajectory, recording, &missing);
    /* a file that does not fit or was damaged is passed over, and the reference is computed */
    if (good) {
        memcpy(&header, bytes, sizeof header);
        const size_t values = ((size_t)trajectory.frames + 1) * 6 * trajectory.n;
        good = !memcmp(header.magic, MAGIC, sizeof MAGIC) && header.one == 1 &&
               header.n == trajectory.n && header.frames == trajectory.frames &&
               length == sizeof header + values * sizeof(double);
        if (good) {
            memcpy(trajectory.states, bytes + sizeof header, values * sizeof(double));
            hash_file(&header, trajectory.states, values, hash);
            good = !memcmp(hash, header.hash, sizeof hash);
        }
        if (good) {
            *reference = header.reference;
            trajectory.n_recorded = trajectory.frames;
            reference->trajectory = trajectory;
            reference->cached = true;
        } else
            cs_trajectory_finish(&trajectory);
    }
    free(bytes);
    return good;
}

enum cs_status cs_compare_reference_write(const struct cs_compare_reference *reference,
                                          const char *folder, const char *key,
                                          struct cs_error *error) {
    const struct cs_trajectory *trajectory = &reference->trajectory;
    const size_t values = ((size_t)trajectory->frames + 1) * 6 * trajectory->n;
    struct header header;
    struct cs_file_out out = {0};
    char path[4096];
    // the gaps between members as well
    memset(&header, 0, sizeof header);
    file_path(folder, key, path, sizeof path);
    memcpy(header.magic, MAGIC, sizeof MAGIC);
    header.one = 1;
    header.n = trajectory->n;
    header.frames = trajectory->frames;
    header.reference = *reference;
    /* an address means nothing to the next run */
    header.reference.trajectory.states = NULL;
    header.reference.trajectory.free_from = NULL;
    hash_file(&header, trajectory->states, values, header.hash);
    if (!cs_folder_create(folder, error) && !cs_file_create(&out, path, error)) {
        /* failures of fwrite are seen by cs_file_finish */
        fwrite(&header, sizeof header, 1, out.file);
        fwrite(trajectory->states, sizeof(double), values, out.file);
        cs_file_finish(&out, error);
    }
    return error->status;
}
