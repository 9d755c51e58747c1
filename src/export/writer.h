/* writer.h - interface of export formats: a table of calls, each format in a file of its own.
 *
 * A new format needs: its line in CS_EXPORT_LIST and its declaration below, NAME.c with
 * cs_export_NAME, and that file in meson.build.
 */
#ifndef CS_EXPORT_WRITER_H
#define CS_EXPORT_WRITER_H

#include "base/arena.h"
#include "base/file.h"
#include "base/status.h"
#include "session/export_mesh.h"

#include <stdio.h>

/* Paths of exported files. */

enum { CS_EXPORT_PATH = 4096 }; /* bytes of a path with its end */

/* Refuses a path that snprintf has cut off; length: its result. CS_ERR_FILE. */
static inline enum cs_status cs_export_check(int length, const char *folder,
                                             struct cs_error *error) {
    return length >= CS_EXPORT_PATH
               ? cs_fail(error, CS_ERR_FILE,
                         "cannot use the folder \"%.60s...\": the path is too long", folder)
               : CS_OK;
}

/* Writes the path FOLDER/NAME. */
static inline enum cs_status cs_export_name(char path[CS_EXPORT_PATH], const char *folder,
                                            const char *name, struct cs_error *error) {
    return cs_export_check(snprintf(path, CS_EXPORT_PATH, "%s/%s", folder, name), folder,
                           error);
}

/* Writes the path FOLDER/NAME_00012.ENDING of a sample. */
static inline enum cs_status cs_export_number(char path[CS_EXPORT_PATH], const char *folder,
                                              const char *name, uint32_t number,
                                              const char *ending, struct cs_error *error) {
    return cs_export_check(
        snprintf(path, CS_EXPORT_PATH, "%s/%s_%05u.%s", folder, name, number, ending), folder,
        error);
}

/* X(BIT, name): the formats. */
#define CS_EXPORT_LIST(X) X(OBJ, obj) X(PC2, pc2) X(VTP, vtp) X(NPZ, npz)

/* Number of a format in tables. */
enum cs_export_index {
#define X(BIT, name) CS_EXPORT_INDEX_##BIT,
    CS_EXPORT_LIST(X)
#undef X
        CS_N_EXPORT_FORMATS
};

/* Bit of a format in sets. */
enum cs_export_format {
#define X(BIT, name) CS_EXPORT_##BIT = 1u << CS_EXPORT_INDEX_##BIT,
    CS_EXPORT_LIST(X)
#undef X
};

/* Selection of what a run exports, and where. */
struct cs_export_settings {
    const char *folder;        /* exists; borrowed */
    uint32_t formats, values;  /* sets of bits; no format: nothing is exported */
    uint32_t frame_interval;   /* frames from one sample to the next */
    uint32_t n_samples_before; /* samples that the files of a continued run already have */
};

/* Number and time of a sample. */
struct cs_export_sample {
    uint32_t number; /* from 0, the start, without gaps */
    uint32_t frame;  /* of the run */
    double t;        /* s */
};

/* Data that all formats read; it must stay at its address while they are open. */
struct cs_export_source {
    const struct cs_export_mesh *meshes[2]; /* bodies, colliders */
    struct cs_export_settings settings;
    double fps;
};

/* A format. Calls but `add` may be NULL if there is nothing to do; they fail with CS_ERR_FILE
 * or CS_ERR_MEMORY. */
struct cs_export_writer {
    bool holds_values;        /* beside positions */
    const char *ending;       /* of the files BODIES_00012.ENDING of samples; NULL: none */
    const char *cache_ending; /* of the files BODIES.ENDING; NULL: none */
    const char *files[2];     /* others; NULL: none */
    size_t size;              /* bytes of its state, which begins zeroed and closed; 0: none */

    /* Allocates what it needs, and opens files that grow. */
    enum cs_status (*open)(void *state, const struct cs_export_source *source,
                           struct cs_arena *arena, struct cs_error *error);
    /* Adds a sample. On failure the files hold those before. */
    enum cs_status (*add)(void *state, const struct cs_export_source *source,
                          const struct cs_export_sample *sample, struct cs_error *error);
    /* Flushes to the disk, before a checkpoint, what a continued run takes up again. Numbered
     * files and lists of samples are left out, because they are written again. */
    enum cs_status (*sync)(const void *state, struct cs_error *error);
    /* Completes files at the end of a run; goes_on: it may be continued. */
    enum cs_status (*finish)(void *state, const struct cs_export_source *source, bool goes_on,
                             struct cs_error *error);
    void (*close)(void *state);
};

/* declared one by one: a line in the list alone does not compile */
extern const struct cs_export_writer cs_export_obj, cs_export_pc2, cs_export_vtp, cs_export_npz;

/* Returns true if a mesh has a value at a sample: one that never moves has the first alone. */
static inline bool cs_export_mesh_has_sample(const struct cs_export_mesh *mesh,
                                             const struct cs_export_sample *sample) {
    return mesh->n > 0 && (mesh->is_moving || sample->number == 0);
}

/* A file that grows sample by sample and is valid after each. It has its final
 * path from the start; its header or its list tells readers how much of it counts. */

/* An open file; zeroed: closed. */
struct cs_append_file {
    int file;        /* descriptor + 1, so that 0 means closed */
    uint64_t length; /* bytes written completely */
    char path[CS_EXPORT_PATH];
};

/* Opens a new file; or, if kept > 0, an existing one, cut off after `kept` bytes: samples after
 * the checkpoint of a continued run are dropped. All calls fail with CS_ERR_FILE; this one also
 * if the existing file is shorter. Does not follow a symbolic link. */
enum cs_status cs_append_file_open(struct cs_append_file *append, const char *path,
                                   uint64_t kept, struct cs_error *error);

/* Writes n bytes at offset `at`, at most the length. On failure the file is as long as
 * before. */
enum cs_status cs_append_file_write(struct cs_append_file *append, uint64_t at,
                                    const void *bytes, size_t n, struct cs_error *error);

/* Reads n bytes at offset `at`; fewer are a failure. */
enum cs_status cs_append_file_read(const struct cs_append_file *append, uint64_t at,
                                   void *bytes, size_t n, struct cs_error *error);

/* Returns when the disk has what was written. Does nothing if closed. */
enum cs_status cs_append_file_sync(const struct cs_append_file *append, struct cs_error *error);

/* Closes the file; safe on a closed one. */
void cs_append_file_close(struct cs_append_file *append);

/* Uncompressed ZIP archives of any size, written in one pass. */

enum { CS_ZIP_MEMBERS_MAX = 24 };

/* An entry of the central directory, kept until the archive is finished. */
struct cs_zip_member {
    char name[40];
    uint64_t offset, bytes; /* of its local header in the file; length of its data */
    uint32_t crc;           /* CRC-32 of the data so far */
};

/* An archive that is being written; all but `file` zeroed at the start. */
struct cs_zip {
    FILE *file;      /* borrowed, seekable; failures to write are found when it is finished */
    uint64_t offset; /* bytes written */
    int seek_error;  /* errno of a failed seek, which ferror does not show; 0: none */
    unsigned n;
    struct cs_zip_member members[CS_ZIP_MEMBERS_MAX];
};

/* Begins a member of exactly `bytes` bytes, which cs_zip_put then writes. The name is copied.
 */
void cs_zip_begin(struct cs_zip *zip, const char *name, uint64_t bytes);

/* Appends n bytes to the member. */
void cs_zip_put(struct cs_zip *zip, const void *bytes, size_t n);

/* Ends the member, whose bytes are all written: completes its header. */
void cs_zip_end(struct cs_zip *zip);

/* Writes the central directory; the caller finishes the file, or abandons it after a
 * seek_error. */
void cs_zip_finish(struct cs_zip *zip);

#endif
