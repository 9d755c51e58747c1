/* export.h - a run as files that other programs open: OBJ, PC2, VTP with PVD, NPZ.
 *
 * Samples are numbered from 0, the start, without gaps. Bodies and visible colliders have files
 * of their own; colliders that never move have one sample. */
#ifndef CS_EXPORT_H
#define CS_EXPORT_H

#include "io/export/writer.h"

/* The formats, in the order of their bits. */
extern const struct cs_export_writer *const cs_export_writers[CS_N_EXPORT_FORMATS];

/* The bits of those that have room for more than positions. */
uint32_t cs_export_with_values(void);

/* beside positions and velocities; of those */
enum cs_export_value { CS_EXPORT_FORCE = 1u << 0, CS_EXPORT_STRAIN = 1u << 1 };

/* names of the bits, closed by NULL */
extern const char *const cs_export_format_names[];
extern const char *const cs_export_value_names[];

/* Zeroed: closed. Must stay where it is while open. */
struct cs_export {
    const struct cs_system *system; /* borrowed */
    struct cs_export_mesh bodies, colliders;
    struct cs_export_source source;
    void *states[CS_N_EXPORT_FORMATS]; /* the arena's; NULL: not asked for */
    double *values, *scratch; /* (n), (3,n); NULL unless force or strain are asked for */
    uint32_t n_samples;
    struct cs_arena arena; /* owns the arrays */
};

/* Takes the memory and opens what grows. The system must outlive it. On failure close is still
 * to be called. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_export_open(struct cs_export *export,
                              const struct cs_export_settings *settings,
                              const struct cs_system *system, struct cs_error *error);

/* Writes a frame of a run, at t and with x, v (3,n), if it is one that is exported. On failure
 * the files hold the samples before. CS_ERR_FILE. */
enum cs_status cs_export_write_sample(struct cs_export *export, uint32_t frame, double t,
                                      const double *x, const double *v, struct cs_error *error);

/* Before a checkpoint: the disk has what a run that goes on from here takes up again. */
enum cs_status cs_export_sync(const struct cs_export *export, struct cs_error *error);

/* At the end of a run, however it ended. goes_on: it may be continued. */
enum cs_status cs_export_finish(struct cs_export *export, bool goes_on, struct cs_error *error);

void cs_export_close(struct cs_export *export);

#endif
