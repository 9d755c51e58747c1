/* product.h - a scene with every combination of values and methods: the Cartesian product as
 * cells, and what each run came to as a row of one table. */
#ifndef CS_PRODUCT_H
#define CS_PRODUCT_H

#include "study/session.h"
#include "study/shard.h"

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

/* Runs the cells of the shard that sweep.csv does not have. A row is kept as it comes, whoever
 * else writes there; when all cells are there, they are put in order. CS_ERR_USAGE where the
 * file is of another sweep; CS_ERR_INTERRUPT. */
enum cs_status cs_product_run(struct cs_product *product, struct cs_error *error);

/* Joins the sweep.csv of folders, where they have one, into that of out; *n: rows. */
enum cs_status cs_product_merge(const char *const *folders, uint32_t n_folders, const char *out,
                                uint32_t *n, struct cs_error *error);

#endif
