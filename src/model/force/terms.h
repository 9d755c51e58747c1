/* terms.h - the forces: what each is, said once, and their sum.
 *
 * A force is a struct cs_term in a file of its own, term_NAME.c, and a line in CS_TERM_LIST.
 * The term says all that the program asks of a force; the plan, the linear solver, the bounds,
 * the energies and the watch walk the list and know none by name. A unit test holds each term
 * to what its bits promise.
 */
#ifndef CS_TERMS_H
#define CS_TERMS_H

#include "model/system/system.h"

/* X(name of the struct behind cs_term_) in the order in which forces are summed. A test may
 * define CS_TERM_LIST_MORE where it compiles terms.c, to plant forces of its own. */
#ifndef CS_TERM_LIST_MORE
#define CS_TERM_LIST_MORE(X)
#endif
#define CS_TERM_LIST(X) X(springs) X(gravity) X(drag) X(wind) X(push) CS_TERM_LIST_MORE(X)

/* Arrays of the system that a force reads, and so asks for. */
enum cs_term_use {
    CS_USE_NORMALS = 1u << 0, /* normals (3,n), fresh (cs_normals_update) */
    CS_USE_AREA = 1u << 1     /* area (n) */
};

/* For bounds.h, at each particle: the sum of the norms of the 3x3 blocks in its row of a force's
 * derivative, its own block and those of its neighbours (Gershgorin). */
struct cs_row_sums {
    double *stiffness, *damping; /* (n) of df/dx in N/m and of df/dv in N s/m */
};

/* Where an energy is counted. */
enum cs_energy_kind { CS_ENERGY_ELASTIC, CS_ENERGY_GRAVITY, CS_ENERGY_OTHER, CS_ENERGIES };

/* Calls may be NULL where it says so; they get arrays (3,n) and write nothing else. */
struct cs_term {
    const char *name; /* of its line in --plan */
    uint32_t parts;   /* enum cs_part: by them methods choose */

    /* --- whether a scene has it --- */
    /* Its line of the plan: whether it is built, bytes of arrays of its own, why or why not;
     * without `why` no line is printed. A force that is not built is not called again. */
    struct cs_plan_row (*plan)(const struct cs_scene *scene);
    uint32_t (*uses)(const struct cs_scene *scene); /* set of enum cs_term_use; NULL: nothing */
    const char *const *ramps; /* keys that events may change while it acts, closed by NULL */

    /* --- the force --- */
    /* Before the blocks of one force, or of one product (at->dx or at->dv is given), by all
     * threads; at->block is NULL. NULL: nothing to prepare. */
    void (*prepare)(const struct cs_system *system, const struct cs_eval *at);
    /* f += force of the chosen parts at the particles of the block. */
    void (*add_force)(const struct cs_system *system, const struct cs_eval *at, double *f);
    /* df += (df/dx) dx + (df/dv) dv there, exact; either direction may be NULL. NULL: the force
     * depends on time alone. */
    void (*add_jvp)(const struct cs_system *system, const struct cs_eval *at, double *df);

    /* --- its energy: with a bit of CS_PART_WITH_ENERGY --- */
    double (*energy)(const struct cs_system *system, const struct cs_eval *at); /* J */
    enum cs_energy_kind energy_kind;

    /* --- its share of the solver's matrix: with a bit of CS_PART_LINEARISED, one of three ---
     */
    /* A number times the identity at each particle: diagonal (n) += those of the particles
     * [begin, end), cd df/dv + ck df/dx. */
    void (*add_scalar)(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *diagonal);
    /* A symmetric 3x3 block at each particle: blocks (6,n) += those, likewise. With matrix->psd
     * none may have a negative eigenvalue. */
    void (*add_blocks)(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks);
    /* Between particles: the springs alone, whose factors the solver knows; here it adds the
     * particles' diagonal blocks of df/dx and df/dv, (6,n). */
    void (*add_diagonal)(const struct cs_system *system, const double *x, double *kxx,
                         double *dvv);

    /* --- how strong it is --- */
    /* Adds bounds on its row sums that hold for the whole run, with the values that the scene
     * has now. NULL: none, or none that holds for every state. */
    void (*add_bound)(const struct cs_system *system, const struct cs_row_sums *sums);
    /* Bounds at a state, instead of those above. NULL: they hold at any. */
    void (*add_bound_at)(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_row_sums *sums);
    /* Greatest force in N that it can exert on particle i whatever the state is. NULL: energy
     * that is there bounds what it can do, or it only takes energy away. */
    double (*strongest)(const struct cs_system *system, size_t i);
};

#define X(name) extern const struct cs_term cs_term_##name;
CS_TERM_LIST(X)
#undef X

/* The list; at most CS_TERMS_MOST, as many as a plan has rows for. */
extern const struct cs_term *const cs_terms[];
extern const uint32_t cs_n_terms;

/* f (3,n) = sum of the chosen parts, 0 on pinned particles; by all threads. What they use of
 * CS_USE_NORMALS must be fresh. */
void cs_terms_force(const struct cs_system *system, const struct cs_eval *at, double *f);
/* df (3,n), 0 on pinned particles. Fresh normals as above. */
void cs_terms_jvp(const struct cs_system *system, const struct cs_eval *at, double *df);
/* The particles' own blocks kxx, dvv (6,n) of CS_PART_LINEARISED: xx, xy, xz, yy, yz, zz. */
void cs_terms_diagonal(const struct cs_system *system, const struct cs_eval *at, double *kxx,
                       double *dvv);

/* Adds the shares of all terms that have none between particles, at particles [begin, end):
 * numbers to diagonal (n), blocks to blocks (6,n), which is not used without
 * cs_terms_have_blocks. */
void cs_terms_add_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                         size_t begin, size_t end, double *diagonal, double *blocks);
bool cs_terms_have_blocks(const struct cs_system *system);

/* true if the chosen parts need the particle normals in this scene */
bool cs_terms_need_normals(const struct cs_system *system, uint32_t parts);

/* What the forces of a scene use together, by a plan whose rows of forces are made. */
uint32_t cs_terms_use(const struct cs_scene *scene, const struct cs_plan *plan);

#endif
