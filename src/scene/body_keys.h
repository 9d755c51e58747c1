/* body_keys.h - keys of bodies: shape, masses, springs, pins, look; and of seams between them.
 */
#ifndef CS_BODY_KEYS_H
#define CS_BODY_KEYS_H

#include "mesh/spring_network.h"
#include "scene/check.h"
#include "scene/elastic_keys.h"
#include "scene/scene.h"

/* Plane of the cloth before `place` is applied. */
enum cs_start { CS_START_HANGING, CS_START_FLAT };

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

/* Selects pinned particles; one of: a named corner or edge, a particle index, a box, a name of
 * faces of a mesh file. */
struct cs_pin {
    struct cs_holder *to; /* of a body's pins alone; NULL: none */
    int32_t at;           /* enum cs_pin_name, -1: not given */
    int64_t index;        /* particle within the body, -1: not given */
    struct cs_box box;
    char set[CS_TEXT_MAX]; /* ""; not given */
};

/* One side of a seam: particles of a body in the order of the list; of one entry ascending. */
struct cs_seam_side {
    int64_t body;             /* -1: not given, refused */
    struct cs_list particles; /* struct cs_pin, at least one */
};

/* The other side: as many particles, or three with weights, which are one point of a triangle;
 * or vertices of a collider's mesh, or the nearest points of a collider. */
struct cs_seam_to {
    struct cs_seam_side side; /* body -1, maybe no particles: a collider */
    int64_t collider;         /* -1: a body */
    double weights[3];        /* their sum is 1; first component NAN: stitched one to one */
};

/* Stitches of one kind; a collider carries what is sewn to it, and they have no stiffness. */
struct cs_seam {
    struct cs_seam_side side;
    struct cs_seam_to to;
    double stiffness;       /* N/m of each stitch */
    double damping;         /* N s/m of each stitch */
    double length;          /* m, rest length */
    double breaking_length; /* m, of a stitch; NAN: it never breaks */
    double breaking_force;  /* N, of its spring; NAN: likewise */
    double closing_time;    /* s, in which particles are led to a collider */
};

struct cs_mesh_source;
struct cs_shape_clusters;
/* A body that is drawn to its shape (Mueller et al. 2005) instead of held by springs. */
struct cs_shape_matching {
    bool present;
    double alpha;      /* fraction of the way to the goals per step; 1: rigid */
    double beta;       /* fraction of the linear deformation in the goals */
    double alpha_step; /* s, length of that step; 0: alpha holds for a step of any length */
    int64_t clusters;  /* parts that each keep their shape */
    double overlap;    /* of neighbouring parts, as a fraction of a part's longest side */
    bool springs;      /* the body's springs act too */
    /* not in the tables: made by the reader, owned by the scene's arena */
    const struct cs_shape_clusters *parts;
};

/* Mass of a body's particles; exactly one is not NAN. */
struct cs_mass {
    double particle;      /* kg each */
    double areal_density; /* kg/m2, times each particle's area */
    double total;         /* kg, divided equally */
    double degree;        /* kg per spring at the particle */
};
enum cs_damping_model { CS_DAMPING_RELATIVE, CS_DAMPING_AXIAL };
enum cs_stiffness_unit { CS_STIFFNESS_N_PER_M, CS_STIFFNESS_N };

/* Springs of a body. A stiffness in N is divided by the rest length of the spring. */
struct cs_spring_law {
    double stretch, shear,
        bend;               /* N/m, or N (divided by the rest length); 0: no such springs */
    double damping;         /* N s/m per spring */
    int32_t damping_model;  /* enum cs_damping_model */
    int32_t stiffness_unit; /* enum cs_stiffness_unit */
};

/* linear RGB: the default colour of cloth, which means white behind a texture */
#define CS_CLOTH_RED                                                                           \
    { 0.60, 0.06, 0.07 }

enum cs_shading { CS_SHADING_SMOOTH, CS_SHADING_FLAT };

/* The colour of faces of a mesh's file that have a name. */
struct cs_face_colour {
    char set[CS_TEXT_MAX]; /* group, object or material */
    double colour[3];      /* linear RGB, times the material's */
};

/* Blinn-Phong coefficients (shade.c); colours are linear RGB in 0..1. */
struct cs_material {
    double colour[3];
    double back_colour[3]; /* of the other side; first component NAN: as the front */
    double ambient, diffuse, specular, shininess;
    int32_t shading;           /* enum cs_shading */
    char texture[CS_TEXT_MAX]; /* PNG beside the scene file; "" = none */
    double texture_repeat[2];  /* repetitions over the cloth */
    struct cs_list faces;      /* struct cs_face_colour; the first that has the face counts */
};

/* A deformable body: its shape, masses, springs, pins, contact and look. */
struct cs_body {
    struct cs_cloth cloth;       /* either this or the mesh */
    struct cs_mesh_source *mesh; /* mesh_keys.h; NULL: none */
    /* of the mesh, not in the tables: made by the reader, owned by the scene's arena; constant
     */
    const struct cs_trimesh *geometry;
    struct cs_spring_network network;
    struct cs_shape_matching shape_matching;
    struct cs_mass mass;
    struct cs_spring_law springs;
    struct cs_elastic elastic; /* instead of springs */
    struct cs_list pins;       /* struct cs_pin */
    bool self_contact;         /* contact with itself; needs contact.law force */
    double thickness;    /* m, range of its contact with bodies; 0: a fraction of its edges */
    double friction;     /* Coulomb coefficient of self-contact */
    double strain_limit; /* max length of a stretch spring / rest length; NAN: none */
    int64_t strain_limit_sweeps;     /* passes over the springs per step */
    double pressure, outer_pressure; /* Pa: inside over outside; outside, NAN: a pump */
    struct cs_material material;
};

/* Returns true if the body has no springs: it is drawn to its shape instead, or elastic. */
static inline bool cs_scene_springs_left_out(const struct cs_body *body) {
    return body->elastic.present ||
           (body->shape_matching.present && !body->shape_matching.springs);
}

/* Returns the first body that is drawn to its shape; bodies.n if there is none. */
static inline uint32_t cs_scene_first_matched(const struct cs_scene *scene) {
    uint32_t b = 0;
    while (b < scene->bodies.n && !cs_scene_bodies(scene)[b].shape_matching.present)
        b++;
    return b;
}

/* Returns the first body that is elastic; bodies.n if there is none. */
static inline uint32_t cs_scene_first_elastic(const struct cs_scene *scene) {
    uint32_t b = 0;
    while (b < scene->bodies.n && !cs_scene_bodies(scene)[b].elastic.present)
        b++;
    return b;
}

#endif
