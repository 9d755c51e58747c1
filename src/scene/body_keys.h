/* body_keys.h - keys of a scene that place grids, select particles, pins and seams between
 * bodies, and keys about friction, contact between bodies, and its start. */
#ifndef CS_BODY_KEYS_H
#define CS_BODY_KEYS_H

#include <clothsim/option.h>

/* Plane of the cloth before `place` is applied. */
enum cs_start { CS_START_HANGING, CS_START_FLAT };

/* A rigid placement x = R p + translate; R from the matrix, or from the quaternion. */
struct cs_pose {
    double translate[3]; /* m */
    double rotate[4];    /* quaternion x, y, z, w; normalised by cs_scene_check */
    double matrix[9];    /* rows of a rotation matrix; first element NAN: absent */
};

/* A rectangular grid of particles, joined by springs. */
struct cs_cloth {
    bool present;
    int64_t grid[2];   /* particles: columns, rows */
    double size[2];    /* m: along a row, from row to row */
    int32_t start;     /* enum cs_start */
    double stretch[2]; /* size at time 0 over the rest size, along a row and from row to row */
    double bump;       /* m, height of the middle over the edges at time 0 */
    struct cs_pose place;
    double velocity[3]; /* m/s, of every free particle at time 0 */
    double spin[3];     /* rad/s, about place.translate */
};

/* An axis-parallel box that selects the particles in it. */
struct cs_box {
    bool present;
    double min[3], max[3]; /* m, at the start */
};

/* Corners, then edges of a cloth, in the order of cs_pin_names. */
enum cs_pin_name {
    CS_PIN_TOP_LEFT,
    CS_PIN_TOP_RIGHT,
    CS_PIN_BOTTOM_LEFT,
    CS_PIN_BOTTOM_RIGHT,
    CS_PIN_TOP,
    CS_PIN_BOTTOM,
    CS_PIN_LEFT,
    CS_PIN_RIGHT,
    CS_PIN_EDGES
};

/* A collider that carries particles along. */
struct cs_holder {
    bool present;
    int64_t collider; /* -1: not given, refused */
};

/* Selects pinned particles; one of: a named corner or edge, a particle index, a box, a name of
 * faces of a mesh file. */
struct cs_pin {
    struct cs_holder to; /* of a body's pins alone */
    int32_t at;          /* enum cs_pin_name, -1: not given */
    int64_t index;       /* particle within the body, -1: not given */
    struct cs_box box;
    char set[CS_TEXT_MAX]; /* ""; not given */
};

/* One side of a seam: particles of a body in the order of the list; of one entry ascending. */
struct cs_seam_side {
    int64_t body;             /* -1: not given, refused */
    struct cs_list particles; /* struct cs_pin, at least one */
};

/* The other side: as many particles, or three with weights, which are one point of a triangle.
 */
struct cs_seam_to {
    struct cs_seam_side side;
    double weights[3]; /* their sum is 1; first component NAN: stitched one to one */
};

/* Stitches of one kind. */
struct cs_seam {
    struct cs_seam_side side;
    struct cs_seam_to to;
    double stiffness;       /* N/m of each stitch */
    double damping;         /* N s/m of each stitch */
    double length;          /* m, rest length */
    double breaking_length; /* m, of a stitch; NAN: it never breaks */
    double breaking_force;  /* N, of its spring; NAN: likewise */
};

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

#endif
