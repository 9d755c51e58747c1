/* contact_keys.h - keys of contact with colliders and between bodies. */
#ifndef CS_CONTACT_KEYS_H
#define CS_CONTACT_KEYS_H

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
enum cs_pairs_among { CS_PAIRS_NAMED, CS_PAIRS_ALL };
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

enum cs_contact_law { CS_CONTACT_PROJECT, CS_CONTACT_FORCE };
/* Contact between particles and all colliders. */
struct cs_contact_keys {
    int32_t law; /* enum cs_contact_law */
    /* not in the tables: the scene names no law (cs_plan_choose_contact_law) */
    bool law_is_default;
    bool damping_is_default; /* nor a damping: cs_session_build sets it */
    int32_t start;    /* enum cs_contact_start_policy, of what starts inside or within range */
    double untangle;  /* s, in which particles that start inside are moved out; NAN: refused */
    double stiffness; /* N/m per particle, by force; NAN: from what may come (approach.h) */
    double damping;   /* s, times the stiffness of the contact: N s/m */
    double restitution; /* (1) speed after an impact over that before; NAN: not asked */
    /* not in the tables, set by cs_session_build: the factor alpha of the loss, and kg, M */
    double loss, mass;
    double friction_speed; /* m/s at which friction is 0.7 of its limit */
    int32_t friction_law;  /* enum cs_friction_law */
    double sample_stretch; /* (1) of edges, up to which contact samples leave no gap */
};

#endif
