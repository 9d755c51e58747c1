/* parameter_sweep_state.h - settings of a parameter sweep, and its counts so far. */
#ifndef CS_PARAMETER_SWEEP_STATE_H
#define CS_PARAMETER_SWEEP_STATE_H

#include "base/table.h"
#include "study/session.h"

enum { CS_PARAMETER_AXES_MAX = 16, CS_PARAMETER_SWEEP_CELLS_MAX = 10000000 };

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
    void (*progress)(void *ctx, uint32_t n_done, uint32_t total);
    void *ctx;
    uint32_t cells, n_done, n_reused; /* out: in all; there now; of those, from earlier runs */
    uint32_t n_refused;               /* out: cells of now that were refused or failed */
    struct cs_error first_refusal;    /* out: of the first of them */
};

#endif
