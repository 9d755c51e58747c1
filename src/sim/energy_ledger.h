/* energy_ledger.h - energy balance of a run: stored energies, work of non-conservative
 * forces, energy changed by post-step corrections, and, as the remainder, the integrator's
 * own error.
 *
 * Balance. E = T + U with the kinetic energy T and the potential U of the forces in
 * CS_PART_WITH_ENERGY; f_n are the forces without an energy, f is the sum of all. Free
 * particles have m a = f. Pinned ones have a prescribed, piecewise constant velocity, and
 * their T does not change within a segment:
 *   T' = sum over free of f.v,   U' = -sum over all of (f - f_n).v + dU/dt
 *   E' = sum over all of f_n.v - sum over pinned of f.v + dU/dt
 * The three terms are the work of forces, of pins on paths, and of values that events change.
 *
 * Quadrature. Over a step the state follows the quintic through position, velocity and
 * acceleration at both ends. Work is the integral of force times velocity along it by Gauss's
 * rule of three points, which is exact for polynomials of degree 5. The rule has order 6: the
 * remainder is the method's error wherever that is larger. A particle whose accelerations the
 * step does not resolve follows the cubic through positions and velocities instead.
 *
 * Angular momentum. Friction acts on both surfaces where they are, a distance d apart: its two
 * forces F and -F leave the couple d n x F, which no other force takes up. The ledger
 * integrates the sum of x x f over the forces between surfaces by the same quadrature. Without
 * outer forces the angular momentum changes by that, and by the method's own error.
 *
 * Order of the calls in one commit: book_step with the state that the method left,
 * book_correction after each correction, store_state with the state that the next step starts
 * from. Every joule that E changes by is then in exactly one column of work. */
#ifndef CS_ENERGY_LEDGER_H
#define CS_ENERGY_LEDGER_H

#include "model/system/particle_system.h"

/* X(name, column): energies in J of a state. A force of terms.h adds its energy to the column
 * that its struct cs_term names, else to its own column after these, in the order of forces. */
#define CS_LEDGER_ENERGY_LIST(X)                                                               \
    X(KINETIC, "kinetic")                                                                      \
    X(STRETCH, "stretch")                                                                      \
    X(SHEAR, "shear") X(BEND, "bend") X(GRAVITY, "gravity") X(OTHER, "other")
/* X(name, column): work in J since the start, positive if it adds energy to the system.
 *
 * DAMPERS to PUSH are forces without an energy. PINS is the work of grabbed and other moving
 * pinned particles, VALUES the change of U at fixed positions. INTEGRATOR is the remainder of
 * each step. LIMIT to LOSS are post-step corrections: strain limit, the potential and the
 * kinetic part of contact projection, and the velocity loss. EVENTS is any other change of
 * the state: events, grabbed paths, an observer.
 *
 * Columns of forces stand before PINS. A force's own column follows the list, in the order of
 * forces. */
#define CS_LEDGER_WORK_LIST(X)                                                                 \
    X(DAMPERS, "dampers")                                                                      \
    X(DRAG, "drag")                                                                            \
    X(WIND, "wind")                                                                            \
    X(FRICTION, "friction")                                                                    \
    X(PUSH, "events_force")                                                                    \
    X(PINS, "pins")                                                                            \
    X(VALUES, "parameters")                                                                    \
    X(INTEGRATOR, "integrator")                                                                \
    X(LIMIT, "strain_limit")                                                                   \
    X(PROJECTION, "projection")                                                                \
    X(ABSORPTION, "absorption") X(LOSS, "velocity_loss") X(EVENTS, "events")

/* Rows of cs_energy_ledger.energies. */
enum cs_ledger_energy {
#define X(name, column) CS_HOLDING_##name,
    CS_LEDGER_ENERGY_LIST(X)
#undef X
        CS_HOLDINGS
};
/* Rows of cs_energy_ledger.work. */
enum cs_ledger_work {
#define X(name, column) CS_WORK_##name,
    CS_LEDGER_WORK_LIST(X)
#undef X
        CS_WORKS
};

/* Capacities: the lists above and one own column per force. Row k of the forces has its own
 * column at CS_HOLDINGS + k or CS_WORKS + k; columns that no force uses stay 0. */
enum {
    CS_HOLDINGS_MAX = CS_HOLDINGS + CS_TERMS_MAX,
    CS_WORKS_MAX = CS_WORKS + CS_TERMS_MAX,
    CS_NO_COLUMN = CS_WORKS_MAX
};

/* The ledger of one run. Zeroed: none. */
struct cs_energy_ledger {
    struct cs_system *system; /* borrowed */
    /* The start of the running step. */
    double t;             /* s */
    double *state;        /* (6,n): x in m, then v in m/s */
    double *acceleration; /* (3,n) in m/s2, 0 for pinned particles */
    /* Scratch. */
    double *trial_state; /* (6,n): the quintic at a point of the step */
    double *force;       /* (3,n) in N */
    double *b;           /* (3,n) in m/s2: acceleration at the end of the step */
    /* Columns of each force in the list of terms.h; CS_NO_COLUMN: none, or it does not act. */
    uint32_t holding_of[CS_TERMS_MAX], work_of[CS_TERMS_MAX];
    double energies[CS_HOLDINGS_MAX]; /* J, of the state that was booked last */
    double work[CS_WORKS_MAX];        /* J since the start */
    double couple[3];      /* N m s since the start: the angular impulse of friction and damping
                              between surfaces */
    struct cs_arena arena; /* owns the arrays */
};

/* Allocates the arrays and stores the state of the system at t; all works are 0. On failure
 * (CS_ERR_MEMORY) call close. */
enum cs_status cs_energy_ledger_open(struct cs_energy_ledger *ledger, struct cs_system *system,
                                     double t, struct cs_error *error);
/* Continues from the state of the system at t, and keeps the works booked so far: after a
 * checkpoint. */
void cs_energy_ledger_resume(struct cs_energy_ledger *ledger, double t);
/* Releases the arrays and zeroes the ledger. */
void cs_energy_ledger_close(struct cs_energy_ledger *ledger);

/* Books a step of the method that ended at t in (x, v), both (3,n): the works along the
 * quintic, and the remainder as CS_WORK_INTEGRATOR. */
void cs_energy_ledger_book_step(struct cs_energy_ledger *ledger, double t, const double *x,
                                const double *v);
/* Books a change of the state at t: the energy that it added goes to `work`. For
 * CS_WORK_PROJECTION the kinetic part goes to CS_WORK_ABSORPTION instead. */
void cs_energy_ledger_book_correction(struct cs_energy_ledger *ledger, enum cs_ledger_work work,
                                      double t, const double *x, const double *v);
/* Stores (x, v) at t as the start of the next step. A change that nobody booked goes to
 * CS_WORK_EVENTS. */
void cs_energy_ledger_store_state(struct cs_energy_ledger *ledger, double t, const double *x,
                                  const double *v);

/* The sum of all stored energies, in J. */
double cs_energy_ledger_sum(const struct cs_energy_ledger *ledger);

/* CSV: frame and time, the stored energies in J, their sum, the works in J, the angular
 * momentum about the origin in kg m2/s, and what the couple of friction has added to it. A
 * force's own column has its name, with _ for spaces. A force with both an energy and a work
 * has the suffix _work on the second. */
void cs_energy_ledger_print_head(struct cs_text *out);
void cs_energy_ledger_print_row(const struct cs_energy_ledger *ledger, uint32_t frame,
                                struct cs_text *out);

#endif
