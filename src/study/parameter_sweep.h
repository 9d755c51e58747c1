/* parameter_sweep.h - runs a scene with every combination of values and methods: the Cartesian
 * product as cells, and each run as a row of one table. */
#ifndef CS_PARAMETER_SWEEP_H
#define CS_PARAMETER_SWEEP_H

#include "base/table.h"
#include "study/session.h"

/* Settings of a parameter sweep, and its counts so far. */

enum { CS_PARAMETER_AXES_MAX = 16 };

/* One key of the scene and its values. */
struct cs_parameter_axis {
    const char *path;
    char **values; /* (n) */
    uint32_t n;
};

/* Request and counts; pointers are borrowed. */
struct cs_parameter_sweep {
    struct cs_session_settings session; /* scene, plugins; integrator is not used */
    struct cs_parameter_axis keys[CS_PARAMETER_AXES_MAX];
    uint32_t n_keys;
    const char *const *methods; /* (n_methods) "NAME:options"; 0: the scene's own */
    uint32_t n_methods;
    uint32_t frames;
    struct cs_shard shard;
    const char *folder; /* of sweep.csv */
    bool overwrite;     /* an earlier sweep.csv is written over */
    void (*progress)(void *ctx, uint32_t n_done, uint32_t total);
    void *ctx;
    uint32_t cells, n_done, n_reused; /* out: in all; there now; of those, from earlier runs */
    uint32_t n_refused;               /* out: cells of now that were refused or failed */
    struct cs_error first_refusal;    /* out: of the first of them */
};

/* Runs the cells of the shard that sweep.csv lacks. Each row is appended at once, also while
 * other processes write; when all cells are there, they are sorted. CS_ERR_USAGE if the file
 * belongs to another sweep; CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_parameter_sweep_run(struct cs_parameter_sweep *product,
                                      struct cs_error *error);

/* Merges the sweep.csv of folders, as far as they have one, into that of `out`; *n: rows. */
enum cs_status cs_parameter_sweep_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, uint32_t *n, struct cs_error *error);

#endif
