/* writer.h - what a format of exported files is: a table of calls, each format in a file of its
 * own.
 *
 * A new format: its line in CS_EXPORT_LIST and its declaration below, NAME.c with
 * cs_export_NAME, and that file in meson.build.
 */
#ifndef CS_EXPORT_WRITER_H
#define CS_EXPORT_WRITER_H

#include "io/export/export_mesh.h"

/* X(BIT, name): the formats. */
#define CS_EXPORT_LIST(X) X(OBJ, obj) X(PC2, pc2) X(VTP, vtp) X(NPZ, npz)

enum cs_export_index {
#define X(BIT, name) CS_EXPORT_INDEX_##BIT,
    CS_EXPORT_LIST(X)
#undef X
        CS_N_EXPORT_FORMATS
};

enum cs_export_format {
#define X(BIT, name) CS_EXPORT_##BIT = 1u << CS_EXPORT_INDEX_##BIT,
    CS_EXPORT_LIST(X)
#undef X
};

/* What is exported of a run. */
struct cs_export_settings {
    const char *folder;        /* exists; borrowed */
    uint32_t formats, values;  /* sets of bits; no format: nothing is taken */
    uint32_t frame_interval;   /* frames from one sample to the next */
    uint32_t n_samples_before; /* samples that are there, of a run that goes on */
};

/* How its moments are numbered. */
struct cs_export_sample {
    uint32_t number; /* from 0, the start, without gaps */
    uint32_t frame;  /* of the run */
    double t;        /* s */
};

/* What all formats are made from; it stays where it is while they are open. */
struct cs_export_source {
    const struct cs_export_mesh *skins[2]; /* bodies, colliders */
    struct cs_export_settings settings;
    double fps;
};

/* Calls may be NULL where there is nothing to do. CS_ERR_FILE, CS_ERR_MEMORY. */
struct cs_export_writer {
    bool holds_values;        /* beside positions */
    const char *ending;       /* of the files BODIES_00012.ENDING of samples; NULL: none */
    const char *cache_ending; /* of the files BODIES.ENDING; NULL: none */
    const char *files[2];     /* others; NULL: none */
    size_t size;              /* bytes of its state, which begins zeroed and closed */

    /* Takes what it needs, and opens what grows. */
    enum cs_status (*open)(void *state, const struct cs_export_source *source,
                           struct cs_arena *arena, struct cs_error *error);
    /* Adds a sample. On failure the files hold those before. */
    enum cs_status (*add)(void *state, const struct cs_export_source *source,
                          const struct cs_export_sample *sample, struct cs_error *error);
    /* Before a checkpoint: the disk has what a run that goes on takes up again. Numbered files
     * and lists of samples can be missed, or are written anew. */
    enum cs_status (*sync)(const void *state, struct cs_error *error);
    /* At the end of a run, which may go on later. */
    enum cs_status (*finish)(void *state, const struct cs_export_source *source, bool goes_on,
                             struct cs_error *error);
    void (*close)(void *state);
};

/* declared one by one: a line in the list alone does not compile */
extern const struct cs_export_writer cs_export_obj, cs_export_pc2, cs_export_vtp, cs_export_npz;

/* What never moves has a first sample alone. */
static inline bool cs_export_mesh_has_sample(const struct cs_export_mesh *skin,
                                             const struct cs_export_sample *sample) {
    return skin->n > 0 && (skin->is_moving || sample->number == 0);
}

#endif
