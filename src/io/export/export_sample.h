/* export_sample.h - what is exported of a run, and how its moments are numbered. */
#ifndef CS_EXPORT_EXPORT_SAMPLE_H
#define CS_EXPORT_EXPORT_SAMPLE_H

#include <stdint.h>

struct cs_export_settings {
    const char *folder;        /* exists; borrowed */
    uint32_t formats, values;  /* sets of bits (export.h); no format: nothing is taken */
    uint32_t frame_interval;   /* frames from one sample to the next */
    uint32_t n_samples_before; /* samples that are there, of a run that goes on */
};

struct cs_export_sample {
    uint32_t number; /* from 0, the start, without gaps */
    uint32_t frame;  /* of the run */
    double t;        /* s */
};

#endif
