/* energy_ledger.h - where the energy of a run went: what it holds, the work of each force
 * without an energy, what each correction after a step took, and as the rest what the method
 * made or lost.
 *
 * Over a step the state moves along the quintic through position, velocity and acceleration at
 * both ends, and work is the integral of force times velocity along it by Gauss's rule of three
 * points: of order 6, so that the rest is the method's error wherever that is larger. With
 * pinned particles on paths, E' = sum over all of f_n.v - sum over pinned of f.v + dU/dt, f_n
 * the forces without an energy, U the others' potential. */
#ifndef CS_ENERGY_LEDGER_H
#define CS_ENERGY_LEDGER_H

#include "model/system/system.h"

/* X(name, column): energies in J of a state. A force of terms.h adds its energy to the column
 * that its struct cs_term names, else to one of its own after these, in the order of forces. */
#define CS_LEDGER_ENERGY_LIST(X)                                                               \
    X(KINETIC, "kinetic")                                                                      \
    X(STRETCH, "stretch")                                                                      \
    X(SHEAR, "shear") X(BEND, "bend") X(GRAVITY, "gravity") X(OTHER, "other")
/* X(name, column): work in J since the start, above 0 if it comes in. Columns of forces stand
 * before PINS, or after all as those of their energies. */
#define CS_LEDGER_WORK_LIST(X)                                                                 \
    X(DAMPERS, "dampers")                                                                      \
    X(DRAG, "drag")                                                                            \
    X(WIND, "wind")                                                                            \
    X(FRICTION, "friction")                                                                    \
    X(PUSH, "events_force")                                                                    \
    X(PINS, "pins")                                                                            \
    X(VALUES, "parameters")                                                                    \
    X(INTEGRATOR, "integrator")                                                                \
    X(LIMIT, "strain_limit") X(PROJECTION, "projection") X(ABSORPTION, "absorption")           \
        X(LOSS, "velocity_loss") X(EVENTS, "events")

enum cs_ledger_energy {
#define X(name, column) CS_HOLDING_##name,
    CS_LEDGER_ENERGY_LIST(X)
#undef X
        CS_HOLDINGS
};
enum cs_ledger_work {
#define X(name, column) CS_WORK_##name,
    CS_LEDGER_WORK_LIST(X)
#undef X
        CS_WORKS
};

enum {
    CS_HOLDINGS_MAX = CS_HOLDINGS + CS_TERMS_MAX,
    CS_WORKS_MAX = CS_WORKS + CS_TERMS_MAX,
    CS_NO_COLUMN = CS_WORKS_MAX
};

/* Zeroed: none. */
struct cs_energy_ledger {
    struct cs_system *system;        /* borrowed */
    double t;                        /* s, of the state that is kept */
    double *state, *acceleration;    /* (6,n) that state, x then v; (3,n) in m/s2 */
    double *trial_state, *force, *b; /* (6,n), (3,n), (3,n) work */
    /* columns of each force in the list of terms.h; CS_NO_COLUMN: none, or it does not act */
    uint32_t holding_of[CS_TERMS_MAX], work_of[CS_TERMS_MAX];
    double energies[CS_HOLDINGS_MAX], work[CS_WORKS_MAX];
    struct cs_arena arena;
};

/* Takes its memory, and the state of the system at t. CS_ERR_MEMORY. */
enum cs_status cs_energy_ledger_open(struct cs_energy_ledger *ledger, struct cs_system *system,
                                     double t, struct cs_error *error);
/* From the state of the system at t on, with the works as they were put down before. */
void cs_energy_ledger_resume(struct cs_energy_ledger *ledger, double t);
void cs_energy_ledger_close(struct cs_energy_ledger *ledger);

/* A method's step has ended at t in (x, v): its works, and the rest. */
void cs_energy_ledger_book_step(struct cs_energy_ledger *ledger, double t, const double *x,
                                const double *v);
/* The state was changed at t: its energy is put down to `work`; of CS_WORK_PROJECTION what is
 * kinetic to CS_WORK_ABSORPTION. */
void cs_energy_ledger_book_correction(struct cs_energy_ledger *ledger, enum cs_ledger_work work,
                                      double t, const double *x, const double *v);
/* The next step begins from here; what was not put down is of CS_WORK_EVENTS. */
void cs_energy_ledger_store_state(struct cs_energy_ledger *ledger, double t, const double *x,
                                  const double *v);

/* The sum of all that is held, in J. */
double cs_energy_ledger_sum(const struct cs_energy_ledger *ledger);

/* CSV: a frame's holdings, their sum, and the works; a column of a force's own has its name,
 * with _ for spaces, and that of its work _work behind it where it has an energy too. */
void cs_energy_ledger_print_head(struct cs_text *out);
void cs_energy_ledger_print_row(const struct cs_energy_ledger *ledger, uint32_t frame,
                                struct cs_text *out);

#endif
