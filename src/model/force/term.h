/* term.h - one force: all that the program asks of it.
 *
 * It is a struct cs_term in a file of its own, term_NAME.c, and a line in CS_TERM_LIST of
 * terms.h. The plan, the linear solver, the bounds, the energies and the watch walk that list
 * and know none by name. A unit test holds each term to what its bits promise.
 */
#ifndef CS_TERM_H
#define CS_TERM_H

#include "model/system/system.h"

/* Arrays of the system that a force reads, and so asks for. */
enum cs_term_use {
    CS_USE_NORMALS = 1u << 0, /* normals (3,n), fresh (cs_normals_update) */
    CS_USE_AREA = 1u << 1     /* area (n) */
};

/* For the Gershgorin bounds of spectral_bounds.h, at each particle: the sum of the norms of the
 * 3x3 blocks in its row of a force's derivative, the diagonal block and those of its
 * neighbours. */
struct cs_gershgorin {
    double *stiffness, *damping; /* (n) of df/dx in N/m and of df/dv in N s/m */
};

/* Where an energy is counted. */
enum cs_energy_kind { CS_ENERGY_ELASTIC, CS_ENERGY_GRAVITY, CS_ENERGY_OTHER, CS_ENERGIES };

/* Calls may be NULL where it says so; they get arrays (3,n) and write nothing else. */
struct cs_term {
    const char *name;   /* of its line in --plan */
    uint32_t part_bits; /* enum cs_part: by them methods choose */

    /* --- whether a scene has it --- */
    /* Its line of the plan: whether it is built, bytes of arrays of its own, why or why not;
     * without `why` no line is printed. A force that is not built is not called again. */
    struct cs_plan_row (*plan)(const struct cs_scene *scene);
    uint32_t (*uses)(const struct cs_scene *scene); /* set of enum cs_term_use; NULL: nothing */
    /* Takes and fills arrays of its own, the springs and the state there. NULL: it has none.
     * CS_ERR_SCENE, CS_ERR_MEMORY. */
    enum cs_status (*build)(struct cs_system *system, struct cs_error *error);
    /* After build: why there is nothing to do for it after all, which is then its line of the
     * plan, and it is not called again; NULL where there is. May be NULL. */
    const char *(*reason_idle)(const struct cs_system *system);
    const char *const
        *rampable_keys; /* keys that events may change while it acts, closed by NULL */

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

    /* --- its columns in the energy ledger (sim/energy_ledger.h) --- */
    /* Of its energy, and of the work of its parts that have none: names of a list there, which
     * forces may share. NULL: its own, by its name. */
    const char *energy_column, *work_column;

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
    /* Where a force has entries between particles beside its blocks, in any pattern: found at
     * the matrix's state before add_blocks, and added to products; the solver's preconditioner
     * has the blocks alone. kept: until the next that is kept. Else add_blocks alone follows,
     * and with matrix->bound the blocks must then be above the whole share. Both or neither; by
     * all threads. */
    void (*prepare_matrix)(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept);
    /* y += those entries times p. */
    void (*add_matrix_product)(const struct cs_system *system, const double *p, double *y);
    /* Between particles: the springs alone, whose factors the solver knows. Where at->kxx and
     * at->dvv are given, its add_force adds diagonal blocks of df/dx and df/dv too, and f may
     * be NULL; here, after all blocks, it adds those that are left. */
    void (*add_diagonal)(const struct cs_system *system, const struct cs_eval *at);

    /* --- how strong it is --- */
    /* Adds its Gershgorin bounds that hold for the whole run, with the values that the scene
     * has now. NULL: none, or none that holds for every state. */
    void (*add_bound)(const struct cs_system *system, const struct cs_gershgorin *sums);
    /* Bounds at a state, instead of those above. NULL: they hold at any. */
    void (*add_state_bound)(const struct cs_system *system, const struct cs_eval *at,
                            const struct cs_gershgorin *sums);
    /* Greatest force in N that it can exert on particle i whatever the state is. NULL: energy
     * that is there bounds what it can do, or it only takes energy away. */
    double (*max_acceleration)(const struct cs_system *system, size_t i);
};

#endif
