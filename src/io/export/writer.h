/* writer.h - interface of export formats: a table of calls, each format in a file of its own.
 *
 * A new format needs: its line in CS_EXPORT_LIST and its declaration below, NAME.c with
 * cs_export_NAME, and that file in meson.build.
 */
#ifndef CS_EXPORT_WRITER_H
#define CS_EXPORT_WRITER_H

#include "io/export/export_mesh.h"

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
    const struct cs_export_mesh *skins[2]; /* bodies, colliders */
    struct cs_export_settings settings;
    double fps;
};

/* A format. Calls may be NULL if there is nothing to do; they fail with CS_ERR_FILE or
 * CS_ERR_MEMORY. */
struct cs_export_writer {
    bool holds_values;        /* beside positions */
    const char *ending;       /* of the files BODIES_00012.ENDING of samples; NULL: none */
    const char *cache_ending; /* of the files BODIES.ENDING; NULL: none */
    const char *files[2];     /* others; NULL: none */
    size_t size;              /* bytes of its state, which begins zeroed and closed */

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
static inline bool cs_export_mesh_has_sample(const struct cs_export_mesh *skin,
                                             const struct cs_export_sample *sample) {
    return skin->n > 0 && (skin->is_moving || sample->number == 0);
}

#endif
