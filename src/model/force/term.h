/* term.h - one force: all that the program needs to know of it.
 *
 * It is a struct cs_term in a file of its own, term_NAME.c, and a line in CS_TERM_LIST of
 * terms.h. The plan, the linear solver, the bounds, the energies and the ledger walk that list
 * and know no force by name. tests/physics/test_contract.c checks each against its part bits.
 */
#ifndef CS_TERM_H
#define CS_TERM_H

#include "model/system/particle_system.h"

/* Arrays of the system that a force reads. The system allocates only those that a force asks
 * for. */
enum cs_term_use {
    CS_USE_NORMALS = 1u << 0, /* normals (3,n), fresh (cs_normals_update) */
    CS_USE_AREA = 1u << 1     /* area (n) */
};

/* Row sums for the bounds of diagnostics.h: at each particle the sum of the norms of the
 * 3x3 blocks in its row of a force's derivative, the diagonal block and those of its
 * neighbours. */
struct cs_gershgorin {
    double *stiffness; /* (n) of df/dx in N/m */
    double *damping;   /* (n) of df/dv in N s/m, behind them in memory */
};

/* Member of struct cs_energy to which a force's energy is added. */
enum cs_energy_kind { CS_ENERGY_ELASTIC, CS_ENERGY_GRAVITY, CS_ENERGY_OTHER, CS_ENERGIES };

/* A force. Calls may be NULL where a comment says so. They get arrays (3,n), and write nothing
 * but what their comment names. */
struct cs_term {
    const char *name;   /* of its line in --plan */
    uint32_t part_bits; /* set of enum cs_part, by which methods choose forces */

    /* --- does a scene have it? --- */
    /* Decides its row of the plan: built or not, and the reason; without a reason no line is
     * printed. A force that is not built is not called again. */
    struct cs_plan_row (*plan)(const struct cs_scene *scene);
    uint32_t (*uses)(const struct cs_scene *scene); /* set of enum cs_term_use; NULL: nothing */
    /* Allocates and fills the force's own arrays, after springs and state are built. NULL: it
     * has none. Returns CS_ERR_SCENE or CS_ERR_MEMORY. */
    enum cs_status (*build)(struct cs_system *system, struct cs_error *error);
    /* Called after build: returns the reason if the force turns out to have nothing to do, and
     * NULL if it acts. The reason becomes its line of the plan, and it is not called again. May
     * be NULL. */
    const char *(*reason_idle)(const struct cs_system *system);
    const char *const
        *rampable_keys; /* keys that events may change while it acts, closed by NULL */

    /* --- the force --- */
    bool is_local; /* add_force reads x and v of the block alone, and needs no prepare */
    /* Called once before the blocks of one force, or of one derivative (at->dx or at->dv is
     * given), with all threads; at->block is NULL. NULL: nothing to prepare. */
    void (*prepare)(const struct cs_system *system, const struct cs_eval *at);
    /* f += force of the chosen parts at the particles of the block. */
    void (*add_force)(const struct cs_system *system, const struct cs_eval *at, double *f);
    /* df += (df/dx) dx + (df/dv) dv at the block, exact; either direction may be NULL. NULL:
     * the force depends on time alone. */
    void (*add_jvp)(const struct cs_system *system, const struct cs_eval *at, double *df);

    /* --- its energy: with a bit of CS_PART_WITH_ENERGY --- */
    /* J; at least 0 in every state, but for CS_ENERGY_GRAVITY: the blow-up check holds the sum
     * against what the scene can have. A potential such as -G m / r needs a shift. */
    double (*energy)(const struct cs_system *system, const struct cs_eval *at);
    enum cs_energy_kind energy_kind;

    /* --- its columns in the energy ledger (sim/energy_ledger.h) --- */
    /* Columns of its energy, and of the work of its parts without energy: names of a list
     * there, which forces may share. NULL: a column of its own name. */
    const char *energy_column, *work_column;

    /* --- its part of the solver's matrix: one of three, with a bit of CS_PART_LINEARISED ---
     */
    /* A number times the identity at each particle: diagonal (n) += its part of cd df/dv + ck
     * df/dx, at the particles [begin, end). */
    void (*add_scalar)(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *diagonal);
    /* A symmetric 3x3 block at each particle: blocks (6,n) likewise, entries as cs_sym3_row of
     * base/vec3.h has them. With matrix->psd no block may have a negative eigenvalue. Needs
     * add_approach too. */
    void (*add_blocks)(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks);
    /* For a force with entries between arbitrary particles, beside its diagonal blocks. Finds
     * them at the matrix's state, before add_blocks, with all threads. kept: they are stored
     * for products until the next call with kept. Else only add_blocks follows; with
     * matrix->bound its blocks must then be an upper bound of the force's whole part. The
     * solver's preconditioner knows the blocks alone, and self-contact. Either both calls are
     * NULL or none. */
    void (*prepare_matrix)(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept);
    /* y += the stored entries times p, without the diagonal blocks. */
    void (*add_matrix_product)(const struct cs_system *system, const double *p, double *y);
    /* Set if add_blocks is, for methods that are linear in a step. y (3,n) += ck df/dx, just as
     * the matrix kept last has it, times the velocities of the matrix's state relative to the
     * surfaces that the force comes from: those of obstacles that move. With all threads. */
    void (*add_approach)(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y);
    /* For the springs alone, whose factors the solver knows. If at->dfdx_blocks and
     * at->dfdv_blocks are given, add_force adds diagonal blocks of df/dx and df/dv too, and f
     * may be NULL; this call, after all blocks of particles, adds the remaining ones. */
    void (*add_diagonal)(const struct cs_system *system, const struct cs_eval *at);

    /* --- friction of contact, for methods that lag it (lagged_friction.h) --- */
    /* Number of chunks of its contacts; the same for the whole run. NULL: no friction. */
    uint32_t (*friction_chunks)(const struct cs_system *system);
    /* Stores the friction of all contacts at (t, x) by cs_lagged_friction_store, in the chunks
     * from `first` on. Set if friction_chunks is. With all threads. */
    void (*store_friction)(const struct cs_system *system, double t, const double *x,
                           uint32_t first);

    /* --- how strong it is --- */
    /* Adds its Gershgorin bounds that hold for the whole run, with the scene's present values.
     * NULL: it has none, or none that holds for every state. */
    void (*add_bound)(const struct cs_system *system, const struct cs_gershgorin *sums);
    /* Adds bounds at a state, instead of those above. NULL: those above hold at any. With both,
     * those above hold near rest. */
    void (*add_state_bound)(const struct cs_system *system, const struct cs_eval *at,
                            const struct cs_gershgorin *sums);
    /* Greatest force in N that it can exert on particle i in any state. NULL: its energy bounds
     * its effect, or it only dissipates. */
    double (*max_acceleration)(const struct cs_system *system, size_t i);
};

#endif
