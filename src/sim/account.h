/* account.h - where the energy of a run went: what it holds, the work of each force without an
 * energy, what each correction after a step took, and as the rest what the method made or lost.
 *
 * Over a step the state moves along the quintic through position, velocity and acceleration at
 * both ends, and work is the integral of force times velocity along it by Gauss's rule of three
 * points: of order 6, so that the rest is the method's error wherever that is larger. With
 * pinned particles on paths, E' = sum over all of f_n.v - sum over pinned of f.v + dU/dt, f_n
 * the forces without an energy, U the others' potential. */
#ifndef CS_ACCOUNT_H
#define CS_ACCOUNT_H

#include "model/system/system.h"

/* X(name, column): energies in J of a state. A force of terms.h adds its energy to the column
 * that its struct cs_term names, else to one of its own after these, in the order of forces. */
#define CS_HOLDING_LIST(X)                                                                     \
    X(KINETIC, "kinetic")                                                                      \
    X(STRETCH, "stretch")                                                                      \
    X(SHEAR, "shear") X(BEND, "bend") X(GRAVITY, "gravity") X(OTHER, "other")
/* X(name, column): work in J since the start, above 0 if it comes in. Columns of forces stand
 * before PINS, or after all as those of their energies. */
#define CS_WORK_LIST(X)                                                                        \
    X(DAMPERS, "dampers")                                                                      \
    X(DRAG, "drag")                                                                            \
    X(WIND, "wind")                                                                            \
    X(FRICTION, "friction")                                                                    \
    X(PUSH, "push")                                                                            \
    X(PINS, "pins")                                                                            \
    X(VALUES, "values") X(INTEGRATOR, "integrator") X(LIMIT, "strain_limit")                   \
        X(PROJECTION, "projection") X(ABSORPTION, "absorption") X(LOSS, "velocity_loss")       \
            X(EVENTS, "events")

enum cs_holding {
#define X(name, column) CS_HOLDING_##name,
    CS_HOLDING_LIST(X)
#undef X
        CS_HOLDINGS
};
enum cs_work {
#define X(name, column) CS_WORK_##name,
    CS_WORK_LIST(X)
#undef X
        CS_WORKS
};

enum {
    CS_HOLDINGS_MOST = CS_HOLDINGS + CS_TERMS_MOST,
    CS_WORKS_MOST = CS_WORKS + CS_TERMS_MOST,
    CS_NO_COLUMN = CS_WORKS_MOST
};

/* Zeroed: none. */
struct cs_account {
    struct cs_system *system; /* borrowed */
    double t;                 /* s, of the state that is kept */
    double *x, *a;            /* (6,n) that state, x then v; (3,n) in m/s2 */
    double *y, *f, *b;        /* (6,n), (3,n), (3,n) work */
    /* columns of each force in the list of terms.h; CS_NO_COLUMN: none, or it does not act */
    uint32_t holding_of[CS_TERMS_MOST], work_of[CS_TERMS_MOST];
    double holds[CS_HOLDINGS_MOST], work[CS_WORKS_MOST];
    struct cs_arena arena;
};

/* Takes its memory, and the state of the system at t. CS_ERR_MEMORY. */
enum cs_status cs_account_open(struct cs_account *account, struct cs_system *system, double t,
                               struct cs_error *error);
/* From the state of the system at t on, with the works as they were put down before. */
void cs_account_go_on(struct cs_account *account, double t);
void cs_account_close(struct cs_account *account);

/* A method's step has ended at t in (x, v): its works, and the rest. */
void cs_account_step(struct cs_account *account, double t, const double *x, const double *v);
/* The state was changed at t: its energy is put down to `work`; of CS_WORK_PROJECTION what is
 * kinetic to CS_WORK_ABSORPTION. */
void cs_account_change(struct cs_account *account, enum cs_work work, double t, const double *x,
                       const double *v);
/* The next step begins from here; what was not put down is of CS_WORK_EVENTS. */
void cs_account_keep(struct cs_account *account, double t, const double *x, const double *v);

/* The sum of all that is held, in J. */
double cs_account_sum(const struct cs_account *account);

/* CSV: a frame's holdings, their sum, and the works; a column of a force's own has its name,
 * with _ for spaces, and that of its work _work behind it where it has an energy too. */
void cs_account_print_head(struct cs_text *out);
void cs_account_print_row(const struct cs_account *account, uint32_t frame,
                          struct cs_text *out);

#endif
