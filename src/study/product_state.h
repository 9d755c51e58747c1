/* product_state.h - what a sweep is asked for, and what it has come to. */
#ifndef CS_PRODUCT_STATE_H
#define CS_PRODUCT_STATE_H

#include "base/table.h"
#include "study/session.h"

enum { CS_PRODUCT_KEYS = 16, CS_PRODUCT_CELLS = 10000000 };

/* One key of the scene and its values. */
struct cs_product_key {
    const char *path;
    char **values; /* (n) */
    uint32_t n;
};

struct cs_product {
    struct cs_session_settings session; /* scene, plugins; integrator is not used */
    struct cs_product_key keys[CS_PRODUCT_KEYS];
    uint32_t n_keys;
    const char *const *methods; /* (n_methods) "NAME:options"; 0: the scene's own */
    uint32_t n_methods;
    uint32_t frames;
    struct cs_shard shard;
    const char *folder; /* of sweep.csv */
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
    uint32_t cells, done, taken; /* out: in all; there now; of those, from earlier runs */
    uint32_t refused;            /* out: cells of now that were refused or failed */
    struct cs_error why;         /* out: of the first of them */
};

#endif
