/* energy_ledger.c - keeps the energy balance of a run, step by step; the equations are in
 * energy_ledger.h.
 *
 * A step costs two evaluations of all forces, three of contact between surfaces, and three of
 * the forces in each column of work. With events the work of pins takes three more
 * evaluations, and the drift of values measures all energies six times. */
#include "sim/energy_ledger.h"

#include "base/vector.h"
#include "model/event/events.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"

#include <math.h>
#include <string.h>

enum { POINTS = 3 };
/* Gauss's rule of three points on 0..1: nodes 1/2 -+ sqrt(3/5)/2 and 1/2, weights 5/18, 8/18,
 * 5/18. Exact for degree 5. */
static const double points[POINTS] = {0.11270166537925831, 0.5, 0.88729833462074169};
static const double weights[POINTS] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/* Squared distance of the accelerations from the cubic's, over the squares of those, beyond
 * which a step does not resolve them. A step of backward Euler along a resolved motion has 0.9.
 */
#define UNRESOLVED 4

static const char *const holdings[] = {
#define X(name, column) column,
    CS_LEDGER_ENERGY_LIST(X)};
static const char *const works[] = {CS_LEDGER_WORK_LIST(X)};
#undef X

/* Columns of energies or of works: those of a list, then one per force that has none there. */
struct columns {
    const char *const *names;
    uint32_t n;     /* columns of the list */
    uint32_t parts; /* a force with one of these bits has a column */
    bool work;      /* works, not energies */
};
/* Springs are left out of the first: their energies have columns by kind, see measure. */
static const struct columns energies = {holdings, CS_HOLDINGS,
                                        CS_PART_WITH_ENERGY & ~CS_PART_SPRINGS, false};
static const struct columns work_done = {works, CS_WORKS, CS_PART_WITHOUT_ENERGY, true};

/* The column of force k of cs_terms: the one of the list that it names (or that has its
 * name), else its own after the list. CS_NO_COLUMN if it has no part of this table. */
static uint32_t column_of(const struct columns *columns, uint32_t k) {
    const struct cs_term *term = cs_terms[k];
    const char *name = columns->work ? term->work_column : term->energy_column;
    if (!(term->part_bits & columns->parts))
        return CS_NO_COLUMN;
    for (uint32_t c = 0; c < columns->n; c++)
        if (!strcmp(columns->names[c], name ? name : term->name))
            return c;
    return columns->n + k;
}

/* Doubles in an array (3,n). */
static size_t length_of(const struct cs_energy_ledger *ledger) {
    return 3 * (size_t)ledger->system->view.n;
}

/* Sets the values that ramps change to those at t; without events there are none. */
static void move_values(const struct cs_energy_ledger *ledger, double t) {
    if (ledger->system->events)
        cs_events_move_values(ledger->system, t);
}

/* holds = the energies of (x, v) at t, by column. Contact and other forces with an energy add
 * to the column that ledger->holding_of gives them. */
static void measure_energy(const struct cs_energy_ledger *ledger, double t, const double *x,
                           const double *v, double holds[CS_HOLDINGS_MAX]) {
    const struct cs_system *system = ledger->system;
    const struct cs_eval at = {.t = t, .x = x, .v = v, .parts = CS_PART_ALL};
    const uint32_t n = system->view.n;
    memset(holds, 0, CS_HOLDINGS_MAX * sizeof *holds);
    holds[CS_HOLDING_KINETIC] = cs_measure_kinetic(system, v);
    holds[CS_HOLDING_STRETCH] = cs_springs_energy(&system->springs, n, x, CS_PART_STRETCH);
    holds[CS_HOLDING_SHEAR] = cs_springs_energy(&system->springs, n, x, CS_PART_SHEAR);
    holds[CS_HOLDING_BEND] = cs_springs_energy(&system->springs, n, x, CS_PART_BEND);
    for (uint32_t k = 0; k < cs_n_terms; k++)
        if (ledger->holding_of[k] != CS_NO_COLUMN)
            holds[ledger->holding_of[k]] += cs_terms[k]->energy(system, &at);
}

static double sum_of(const double holds[CS_HOLDINGS_MAX]) {
    double sum = 0;
    for (int k = 0; k < CS_HOLDINGS_MAX; k++)
        sum += holds[k];
    return sum;
}

double cs_energy_ledger_sum(const struct cs_energy_ledger *ledger) {
    return sum_of(ledger->energies);
}

/* a (3,n) = M^-1 f in m/s2, 0 for pinned particles. */
static void find_acceleration(const struct cs_energy_ledger *ledger, double t, const double *x,
                              const double *v, double *a) {
    const size_t n = ledger->system->view.n;
    cs_diagnostics_force(ledger->system, t, x, v, CS_PART_ALL, a);
    for (size_t k = 0; k < 3 * n; k++)
        a[k] *= ledger->system->inv_mass[k % n];
}

enum cs_status cs_energy_ledger_open(struct cs_energy_ledger *ledger, struct cs_system *system,
                                     double t, struct cs_error *error) {
    const size_t n3 = 3 * (size_t)system->view.n;
    *ledger = (struct cs_energy_ledger){.system = system};
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        const bool built = system->plan.forces[k].built;
        ledger->holding_of[k] = built ? column_of(&energies, k) : CS_NO_COLUMN;
        ledger->work_of[k] = built ? column_of(&work_done, k) : CS_NO_COLUMN;
    }
    double **const arrays[] = {&ledger->state, &ledger->trial_state, &ledger->acceleration,
                               &ledger->force, &ledger->b};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        CS_ARENA_ARRAY(&ledger->arena, *arrays[k], k < 2 ? 2 * n3 : n3, error);
    if (error->status)
        return error->status;
    cs_energy_ledger_resume(ledger, t);
    return CS_OK;
}

void cs_energy_ledger_resume(struct cs_energy_ledger *ledger, double t) {
    // store_state books the difference to the energies of before, which is no work
    const double *x = ledger->system->state;
    double work[CS_WORKS_MAX];
    memcpy(work, ledger->work, sizeof work);
    cs_energy_ledger_store_state(ledger, t, x, x + length_of(ledger));
    memcpy(ledger->work, work, sizeof work);
}

void cs_energy_ledger_close(struct cs_energy_ledger *ledger) {
    cs_arena_finish(&ledger->arena);
    *ledger = (struct cs_energy_ledger){0};
}

/* The quintic Hermite basis at the fraction s of the step: factors of x0, h v0, h^2 a0, h^2
 * a1, h v1, x1 in position, and in `slope` their derivatives by s. Each polynomial has value,
 * first and second derivative 1 in its own condition and 0 in the five others. */
static void find_factors(double s, double place[6], double slope[6]) {
    const double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
    const double places[6] = {1 - 10 * s3 + 15 * s4 - 6 * s5,  s - 6 * s3 + 8 * s4 - 3 * s5,
                              (s2 - 3 * s3 + 3 * s4 - s5) / 2, (s3 - 2 * s4 + s5) / 2,
                              -4 * s3 + 7 * s4 - 3 * s5,       10 * s3 - 15 * s4 + 6 * s5};
    const double slopes[6] = {-30 * s2 + 60 * s3 - 30 * s4,
                              1 - 18 * s2 + 32 * s3 - 15 * s4,
                              (2 * s - 9 * s2 + 12 * s3 - 5 * s4) / 2,
                              (3 * s2 - 8 * s3 + 5 * s4) / 2,
                              -12 * s2 + 28 * s3 - 15 * s4,
                              30 * s2 - 60 * s3 + 30 * s4};
    memcpy(place, places, sizeof places);
    memcpy(slope, slopes, sizeof slopes);
}

/* A step of length h in s from ledger->state to (x, v), where the acceleration is ledger->b. */
struct step {
    double h;
    const double *x, *v;
};

/* Replaces the accelerations of particles whose step does not resolve them by those of the
 * cubic through positions and velocities, per particle: h a0 = 6 dx/h - 4 v0 - 2 v1,  h a1 = -6
 * dx/h + 2 v0 + 4 v1 Along a resolved motion both pairs agree to O(h^2). An implicit step, or a
 * correction that moved a particle before it, leaves accelerations of stiff springs that the
 * particle never followed. A quintic through them swings far out of the step, and dampers along
 * it do work that no one did: on scenes/sphere_rest.json 1296 J, of the 6 J there are. */
static void limit_accelerations(struct cs_energy_ledger *ledger, const struct step *step) {
    const size_t n3 = length_of(ledger), n = n3 / 3;
    for (size_t i = 0; i < n; i++) {
        double cubic[6], off = 0, size = 0;
        for (size_t c = 0; c < 3; c++) {
            const size_t k = c * n + i;
            const double mean = (step->x[k] - ledger->state[k]) / step->h;
            const double v0 = ledger->state[n3 + k], v1 = step->v[k];
            cubic[c] = (6 * mean - 4 * v0 - 2 * v1) / step->h;
            cubic[3 + c] = (-6 * mean + 2 * v0 + 4 * v1) / step->h;
            const double a = ledger->acceleration[k] - cubic[c],
                         b = ledger->b[k] - cubic[3 + c];
            off += a * a + b * b;
            size += cubic[c] * cubic[c] + cubic[3 + c] * cubic[3 + c];
        }
        if (off <= UNRESOLVED * size)
            continue;
        for (size_t c = 0; c < 3; c++) {
            ledger->acceleration[c * n + i] = cubic[c];
            ledger->b[c * n + i] = cubic[3 + c];
        }
    }
}

/* trial_state = position and velocity of the quintic at the fraction s of the step. */
static void quintic_at(const struct cs_energy_ledger *ledger, const struct step *step,
                       double s) {
    const size_t n3 = length_of(ledger);
    const double h = step->h;
    double p[6], d[6];
    find_factors(s, p, d);
    for (size_t k = 0; k < n3; k++) {
        const double from = ledger->state[k], way = step->x[k] - from;
        const double v0 = ledger->state[n3 + k], v1 = step->v[k];
        const double a0 = h * ledger->acceleration[k], a1 = h * ledger->b[k];
        // p[0] + p[5] = 1: as a difference to x0, large coordinates do not cancel
        ledger->trial_state[k] =
            from + p[5] * way + h * (p[1] * v0 + p[4] * v1 + p[2] * a0 + p[3] * a1);
        ledger->trial_state[n3 + k] =
            d[5] * way / h + d[1] * v0 + d[4] * v1 + d[2] * a0 + d[3] * a1;
    }
}

/* dU/dt in W at fixed positions, from values that ramps change and colliders on paths: a
 * central difference over a hundredth of the step to either side. Kinetic energy is left out.
 * Restores the values at t. */
static double find_drift(const struct cs_energy_ledger *ledger, double t, double h) {
    const size_t n3 = length_of(ledger);
    const double away = h / 100, *x = ledger->trial_state, *v = x + n3;
    double ends[2];
    for (int k = 0; k < 2; k++) {
        double holds[CS_HOLDINGS_MAX];
        const double at = k ? t + away : t - away;
        move_values(ledger, at);
        measure_energy(ledger, at, x, v, holds);
        holds[CS_HOLDING_KINETIC] = 0;
        ends[k] = sum_of(holds);
    }
    move_values(ledger, t);
    return (ends[1] - ends[0]) / (2 * away);
}

/* Power in W that moving pins bring in: -sum over pinned particles of f.v. */
static double find_pins(const struct cs_energy_ledger *ledger, double t) {
    const struct cs_system *system = ledger->system;
    const size_t n = system->view.n, n3 = 3 * n;
    double power = 0;
    cs_diagnostics_force(system, t, ledger->trial_state, ledger->trial_state + n3, CS_PART_ALL,
                         ledger->force);
    for (uint32_t p = 0; p < system->n_pinned; p++)
        for (size_t k = system->pinned[p]; k < n3; k += n)
            power -= ledger->force[k] * ledger->trial_state[n3 + k];
    return power;
}

/* Leaves in the copy `some` of the system only the forces whose work goes to a column. */
static void choose_forces(const struct cs_energy_ledger *ledger, uint32_t column,
                          struct cs_system *some) {
    some->n_terms = 0;
    for (uint32_t k = 0; k < cs_n_terms; k++)
        if (ledger->work_of[k] == column)
            some->terms[some->n_terms++] = cs_terms[k];
}

/* Adds the work of the forces without an energy at one node of the quadrature, and the angular
 * impulse of those between surfaces. time: its weight times h, in s. */
static void add_forces(struct cs_energy_ledger *ledger, double t, double time) {
    struct cs_system some = *ledger->system;
    const size_t n3 = length_of(ledger);
    const double *x = ledger->trial_state, *v = x + n3;
    for (uint32_t c = 0; c < CS_WORKS_MAX; c++) {
        choose_forces(ledger, c, &some);
        if (!some.n_terms)
            continue;
        cs_diagnostics_force(&some, t, x, v, CS_PART_WITHOUT_ENERGY, ledger->force);
        ledger->work[c] += time * cs_vector_dot_in_order(n3, ledger->force, v);
    }
    if (!some.pairs)
        return;
    some.n_terms = 1, some.terms[0] = &cs_term_pairs;
    cs_diagnostics_force(&some, t, x, v, CS_PART_WITHOUT_ENERGY, ledger->force);
    cs_diagnostics_add_moment(&some, NULL, time, x, ledger->force, ledger->couple);
}

/* Adds all works at one node of the quadrature, at time t and with weight `time` in s. Pins
 * and values can do work only with events or key frames. */
static void add_works(struct cs_energy_ledger *ledger, double t, double time, double h) {
    double *x = ledger->trial_state;
    move_values(ledger, t);
    cs_events_apply_arcs(ledger->system, t, x, x + length_of(ledger));
    add_forces(ledger, t, time);
    if (!ledger->system->events && !ledger->system->motions)
        return;
    ledger->work[CS_WORK_PINS] += time * find_pins(ledger, t);
    ledger->work[CS_WORK_VALUES] += time * find_drift(ledger, t, h);
}

/* Sum in J of the works that a step can do: all columns before INTEGRATOR, and the own
 * columns of forces. */
static double sum_forces(const struct cs_energy_ledger *ledger) {
    double sum = 0;
    for (int k = 0; k < CS_WORKS_MAX; k++)
        sum += k < CS_WORK_INTEGRATOR || k >= CS_WORKS ? ledger->work[k] : 0;
    return sum;
}

void cs_energy_ledger_book_step(struct cs_energy_ledger *ledger, double t, const double *x,
                                const double *v) {
    // remainder = change of E - works of this step
    const struct step step = {.h = t - ledger->t, .x = x, .v = v};
    const double before = cs_energy_ledger_sum(ledger), worked = sum_forces(ledger);
    find_acceleration(ledger, t, x, v, ledger->b);
    limit_accelerations(ledger, &step);
    ledger->work[CS_WORK_PINS] +=
        cs_events_turning_work(ledger->system, ledger->state + length_of(ledger), v);
    for (int k = 0; k < POINTS; k++) {
        quintic_at(ledger, &step, points[k]);
        add_works(ledger, ledger->t + points[k] * step.h, weights[k] * step.h, step.h);
    }
    move_values(ledger, t);
    measure_energy(ledger, t, x, v, ledger->energies);
    ledger->work[CS_WORK_INTEGRATOR] +=
        cs_energy_ledger_sum(ledger) - before - (sum_forces(ledger) - worked);
}

void cs_energy_ledger_book_correction(struct cs_energy_ledger *ledger, enum cs_ledger_work work,
                                      double t, const double *x, const double *v) {
    const double before = cs_energy_ledger_sum(ledger);
    const double moving = ledger->energies[CS_HOLDING_KINETIC];
    measure_energy(ledger, t, x, v, ledger->energies);
    double made = cs_energy_ledger_sum(ledger) - before;
    if (work == CS_WORK_PROJECTION) {
        const double kinetic = ledger->energies[CS_HOLDING_KINETIC] - moving;
        ledger->work[CS_WORK_ABSORPTION] += kinetic;
        made -= kinetic;
    }
    ledger->work[work] += made;
}

void cs_energy_ledger_store_state(struct cs_energy_ledger *ledger, double t, const double *x,
                                  const double *v) {
    const size_t n3 = length_of(ledger);
    cs_energy_ledger_book_correction(ledger, CS_WORK_EVENTS, t, x, v);
    memcpy(ledger->state, x, n3 * sizeof *x);
    memcpy(ledger->state + n3, v, n3 * sizeof *v);
    ledger->t = t;
    find_acceleration(ledger, t, x, v, ledger->acceleration);
}

/* Adds a field of the CSV: empty where the value is not finite. */
static void add_number(struct cs_text *out, double value) {
    cs_text_add(out, ",");
    if (isfinite(value))
        cs_text_add_real(out, value);
}

/* Adds one field of the CSV: the value, or with value NULL the name for the head, _ for
 * spaces. */
static void add_column(struct cs_text *out, const char *name, const double *value) {
    if (value) {
        add_number(out, *value);
        return;
    }
    cs_text_add(out, ",");
    for (; *name; name++)
        cs_text_add(out, "%c", *name == ' ' ? '_' : *name);
}

/* Adds all columns of a table; values NULL: their names. The order is that of the list, then
 * of the forces, as column_of numbers them. */
static void add_columns(const struct columns *columns, const double *values,
                        struct cs_text *out) {
    for (uint32_t c = 0; c < columns->n; c++)
        add_column(out, columns->names[c], values ? values + c : NULL);
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        const uint32_t c = column_of(columns, k);
        if (c < columns->n || c == CS_NO_COLUMN)
            continue;
        add_column(out, cs_terms[k]->name, values ? values + c : NULL);
        if (!values && columns->work && column_of(&energies, k) != CS_NO_COLUMN)
            cs_text_add(out, "_work");
    }
}

void cs_energy_ledger_print_head(struct cs_text *out) {
    cs_text_add(out, "frame,t");
    add_columns(&energies, NULL, out);
    cs_text_add(out, ",sum");
    add_columns(&work_done, NULL, out);
    cs_text_add(out, ",angular_x,angular_y,angular_z,couple_x,couple_y,couple_z\n");
}

void cs_energy_ledger_print_row(const struct cs_energy_ledger *ledger, uint32_t frame,
                                struct cs_text *out) {
    cs_text_add(out, "%u", frame);
    add_number(out, ledger->t);
    add_columns(&energies, ledger->energies, out);
    add_number(out, cs_energy_ledger_sum(ledger));
    add_columns(&work_done, ledger->work, out);
    double angular[3] = {0};
    cs_diagnostics_add_moment(ledger->system, ledger->system->mass, 1, ledger->state,
                              ledger->state + length_of(ledger), angular);
    for (int k = 0; k < 6; k++)
        add_number(out, k < 3 ? angular[k] : ledger->couple[k - 3]);
    cs_text_add(out, "\n");
}
