/* pair_keys.h - keys of a scene about friction, contact between bodies, and its start. */
#ifndef CS_PAIR_KEYS_H
#define CS_PAIR_KEYS_H

#include <clothsim/option.h>

/* Friction of contact by force: a function of the velocity, or with a memory
 * (model/contact/bristle_law.h). */
enum cs_friction_law { CS_FRICTION_SMOOTH, CS_FRICTION_BRISTLES };

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

/* Treatment of what starts inside a collider, or within the range of contact by force. */
enum cs_contact_start_policy {
    CS_CONTACT_START_REFUSE,
    CS_CONTACT_START_MOVE_OUT,
    CS_CONTACT_START_ALLOW
};

#endif
