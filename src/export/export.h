/* export.h - a run as files that other programs open: OBJ, PC2, VTP with PVD, NPZ.
 *
 * Samples are numbered from 0, the start, without gaps. Bodies and visible colliders have
 * separate files; colliders that never move have one sample. */
#ifndef CS_EXPORT_H
#define CS_EXPORT_H

#include "export/writer.h"

/* The formats, in the order of their bits. */
extern const struct cs_export_writer *const cs_export_writers[CS_N_EXPORT_FORMATS];

/* Returns the bits of the formats that can hold more than positions. */
uint32_t cs_export_with_values(void);

/* Values that may be exported besides positions and velocities; a set of bits. */
enum cs_export_value { CS_EXPORT_FORCE = 1u << 0, CS_EXPORT_STRAIN = 1u << 1 };

/* Names of the bits, ended by NULL. */
extern const char *const cs_export_format_names[];
extern const char *const cs_export_value_names[];

/* An open export; zeroed: closed. Must stay at its address while open. */
struct cs_export {
    const struct cs_system *system; /* borrowed */
    struct cs_export_mesh bodies, colliders;
    struct cs_export_source source;
    void *states[CS_N_EXPORT_FORMATS]; /* of the formats, in the arena; NULL: not requested */
    double *values,
        *scratch;          /* (n), (3,n); NULL unless force, strain or stitches are exported */
    uint32_t n_samples;    /* written, with those of the run before it was continued */
    struct cs_arena arena; /* owns the arrays */
};

/* Allocates memory and opens the files that grow. The system must outlive it. The caller closes
 * the export also after a failure. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_export_open(struct cs_export *export,
                              const struct cs_export_settings *settings,
                              const struct cs_system *system, struct cs_error *error);

/* Exports a frame of a run at time t in s with x, v (3,n), if its number is a multiple of the
 * interval. On failure the files hold the samples before. CS_ERR_FILE. */
enum cs_status cs_export_write_sample(struct cs_export *export, uint32_t frame, double t,
                                      const double *x, const double *v, struct cs_error *error);

/* Flushes to the disk, before a checkpoint, what a run that continues from it takes up again.
 */
enum cs_status cs_export_sync(const struct cs_export *export, struct cs_error *error);

/* Completes the files at the end of a run, however it ended; goes_on: it may be continued. */
enum cs_status cs_export_finish(struct cs_export *export, bool goes_on, struct cs_error *error);

/* Closes all files and frees the memory; safe on a zeroed one. */
void cs_export_close(struct cs_export *export);

#endif
