/* golden_states.h - states of a run that are kept beside its hash, to say where and by how much
 * another run differs.
 *
 * A file golden/state/NAME.npy.gz holds three arrays of NumPy, one after the other: the frames
 * that are kept, (k) uint32; the positions at them, (k,n,3) float32, in m; and of every frame
 * the first 64 bits of its state hash, (m) uint64. numpy.load reads them by three calls. */
#ifndef CS_GOLDEN_STATES_H
#define CS_GOLDEN_STATES_H

#include "session/session.h"

/* States of a row that is added, and at most. */
enum { CS_GOLDEN_STATES = 4, CS_GOLDEN_STATES_MAX = 1000 };

/* Zeroed: none. */
struct cs_golden_states {
    uint32_t n;        /* particles */
    uint32_t n_kept;   /* frames whose positions are kept */
    uint32_t n_frames; /* frames that the run has reached */
    uint32_t *frames;  /* (n_kept) ascending, owned */
    float *x;          /* (n_kept,n,3) in m, owned */
    uint64_t *hashes;  /* (n_frames) owned */
};

/* Takes memory for a run of that many frames: its positions are kept at the frames of `like`,
 * or with NULL at `kept` of them, evenly, the last among them. CS_ERR_MEMORY. */
enum cs_status cs_golden_states_init(struct cs_golden_states *states, uint32_t n,
                                     uint32_t frames, uint32_t kept,
                                     const struct cs_golden_states *like,
                                     struct cs_error *error);
/* Adds the state of the run, which is at the end of a frame. */
void cs_golden_states_add(struct cs_golden_states *states, const struct cs_run *run);
/* Safe on zeroed ones. */
void cs_golden_states_finish(struct cs_golden_states *states);

/* Path of a file: FOLDER/state/NAME.npy.gz. */
void cs_golden_states_path(const char *folder, const char *name, char path[1024]);
/* Read and write a file. One that is damaged, or larger than `frames` frames can be, is
 * CS_ERR_FILE, and *states is empty. */
enum cs_status cs_golden_states_read(struct cs_golden_states *states, const char *path,
                                     uint32_t frames, struct cs_error *error);
enum cs_status cs_golden_states_write(const struct cs_golden_states *states, const char *path,
                                      struct cs_error *error);

/* The particle that is farthest off at a frame, and how many are off. */
struct cs_golden_offset {
    uint32_t frame, particle, count;
    double distance; /* m; infinite where one of both is not finite */
};

/* Differences of two runs. */
struct cs_golden_where {
    uint32_t n;          /* particles; 0: the runs have no equal number of them */
    uint32_t first_hash; /* the first frame of another hash; 0: none */
    struct cs_golden_offset first, last; /* kept frames beyond the tolerance; frame 0: none */
};

/* Compares frames that both have. tolerance: m; 0: every bit of a float counts. */
struct cs_golden_where cs_golden_states_compare(const struct cs_golden_states *found,
                                                const struct cs_golden_states *expected,
                                                double tolerance);

/* Adds "frame 12 first, particle 141, 0.00032 m". by_bits: frames are told by their hashes. */
void cs_golden_where_print(const struct cs_golden_where *where, bool by_bits,
                           struct cs_text *out);

#endif
