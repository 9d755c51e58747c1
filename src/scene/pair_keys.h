/* pair_keys.h - keys of a scene about contact between bodies. */
#ifndef CS_PAIR_KEYS_H
#define CS_PAIR_KEYS_H

#include <clothsim/option.h>

/* Two bodies in contact. */
struct cs_body_pair_keys {
    int64_t bodies[2];
    double friction; /* Coulomb coefficient */
};
/* Pairs in contact: those of the list, or all. */
enum cs_pairs_among { CS_PAIRS_LISTED, CS_PAIRS_ALL };
struct cs_body_pairs_keys {
    int32_t among;       /* enum cs_pairs_among */
    double friction;     /* of pairs that are not in the list */
    struct cs_list list; /* struct cs_body_pair_keys */
};

#endif
