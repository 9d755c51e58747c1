/* Friction with the normal forces of earlier positions, and the Newton methods that use it. */
#include "methods.h"

#include "model/contact/ccd/crossings.h"
#include "model/contact/lagged_friction.h"
#include "model/force/terms.h"
#include "sim/run_host.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* All kinds of contact: layers, colliders at particles and between them, a mesh. Two colliders
 * move and one of them rotates. */
#define ALL_KINDS                                                                              \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4]}, \"mass\": {\"areal_density\": 0.4},"        \
    " \"self_contact\": true, \"thickness\": 0.199, \"friction\": 0.4,"                        \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25, \"damping\": 0.7},"         \
    " \"pins\": [\"top-left\"]}],"                                                             \
    " \"colliders\": [{\"sphere\": {\"centre\": [0.1, -0.05, -0.5], \"radius\": 0.35},"        \
    " \"thickness\": 0.3, \"friction\": 0.4}, {\"sphere\": {\"centre\": [0.1, 0.05, -0.06],"   \
    " \"radius\": 0.02}, \"thickness\": 0.12, \"friction\": 0.5}, {\"mesh\": {\"shape\": "     \
    "\"box\", \"place\": {\"translate\": [-0.1, 0.1, 0.65]}}, \"thickness\": 0.3, "            \
    "\"friction\": 0.6}],"                                                                     \
    " \"events\": [{\"at\": 0, \"move\": {\"collider\": 0, \"spin\": [0.3, 2, 0.5], \"path\":" \
    " [{\"at\": 1, \"point\": [0.2, 0, 0.1]}]}}, {\"at\": 0, \"move\": {\"collider\": 2, "     \
    "\"path\": [{\"at\": 1, \"point\": [0.3, 0.2, 0]}]}}],"                                    \
    " \"contact\": {\"law\": \"force\", \"start\": \"allow\", \"stiffness\": 50, "             \
    "\"damping\": "                                                                            \
    "0.01,"                                                                                    \
    " \"friction_speed\": 0.3}}"

enum { N = 20, VALUES = 3 * N };
#define STEP 1e-6

struct kinds {
    struct fixture cloth;
    const struct cs_host *host;
    double x[VALUES], v[VALUES];
};

static void open(struct kinds *kinds) {
    fixture_open(&kinds->cloth, "backward-euler", ALL_KINDS);
    ck_assert_uint_eq(kinds->cloth.n, N);
    fixture_start(&kinds->cloth);
    cs_perturb_smooth(kinds->cloth.system, 0.06, 2);
    kinds->host = &kinds->cloth.session.run.host->table;
    ck_assert(kinds->host->lag_friction && kinds->host->friction_potential);
    memcpy(kinds->x, kinds->cloth.x, sizeof kinds->x);
    memcpy(kinds->v, kinds->cloth.v, sizeof kinds->v);
}

static void force(const struct kinds *kinds, const double *x, double *f) {
    kinds->host->force(kinds->host->ctx, 0, x, kinds->v, CS_PART_ALL, f);
}

static double largest_difference(const double *a, const double *b) {
    double found = 0;
    for (size_t i = 0; i < VALUES; i++)
        found = fmax(found, fabs(a[i] - b[i]));
    return found;
}

/* Each of the three forces stores contacts; at the lagged positions the force is the true one,
 * and away from them it is not. */
TEST(it_is_true_friction_at_its_own_positions) {
    struct kinds kinds;
    double was[VALUES], now[VALUES], moved[VALUES];
    open(&kinds);
    const struct cs_system *system = kinds.cloth.system;
    const struct cs_contact_set *set = &system->lagged_friction->set;
    force(&kinds, kinds.x, was);
    kinds.host->lag_friction(kinds.host->ctx, 0, kinds.x);
    force(&kinds, kinds.x, now);
    ck_assert_double_lt(largest_difference(was, now), 1e-12);
    uint32_t chunk = 0;
    for (uint32_t k = 0; k < system->n_terms; k++) {
        size_t stored = 0;
        if (!system->terms[k]->friction_chunks)
            continue;
        for (uint32_t end = chunk + system->terms[k]->friction_chunks(system); chunk < end;
             chunk++)
            stored += set->chunks[chunk].n;
        ck_assert_msg(stored > 0, "%s stores nothing", system->terms[k]->name);
    }
    ck_assert_uint_eq(chunk, set->gather.n_chunks);
    for (size_t i = 0; i < VALUES; i++)
        moved[i] = kinds.x[i] * 1.01;
    force(&kinds, moved, now);
    kinds.host->lag_friction(kinds.host->ctx, 0, NULL);
    force(&kinds, moved, was);
    ck_assert_double_gt(largest_difference(was, now), 1e-3);
    force(&kinds, kinds.x, was);
    kinds.host->lag_friction(kinds.host->ctx, 0, kinds.x);
    kinds.host->lag_friction(kinds.host->ctx, 0, NULL);
    force(&kinds, kinds.x, now);
    ck_bits(was, now, VALUES, "the force after lagging");
    fixture_close(&kinds.cloth);
}

/* f = -dR/dv, and the product of the matrix is the derivative of f, by central differences. */
TEST(potential_force_and_matrix_agree) {
    struct kinds kinds;
    double f[VALUES], up[VALUES], down[VALUES], v[VALUES], a[VALUES], y[VALUES], b[6 * N];
    open(&kinds);
    struct cs_system *system = kinds.cloth.system;
    struct cs_lagged_friction *lagged = system->lagged_friction;
    const struct cs_term *term = system->terms[system->n_terms - 1];
    ck_assert_str_eq(term->name, "lagged friction");
    cs_lagged_friction_begin(lagged, 0, kinds.x);
    const struct cs_matrix matrix = {.x = kinds.x, .v = kinds.v, .cd = -1};
    for (size_t column = 0; column < VALUES; column++) {
        const double inv_mass = system->inv_mass[column % N];
        memcpy(v, kinds.v, sizeof v);
        memset(a, 0, sizeof a);
        a[column] = 1;
        v[column] += STEP;
        const double above = cs_lagged_friction_potential(lagged, v, up);
        v[column] -= 2 * STEP;
        const double below = cs_lagged_friction_potential(lagged, v, down);
        cs_lagged_friction_potential(lagged, kinds.v, f);
        if (inv_mass > 0)
            ck_assert_double_eq_tol(f[column], -(above - below) / (2 * STEP), 1e-7);
        // blocks of the diagonal, then all others
        memset(b, 0, sizeof b);
        memset(y, 0, sizeof y);
        term->prepare_matrix(system, &matrix, true);
        term->add_blocks(system, &matrix, 0, N, b);
        // another matrix between the solver's and its products
        term->prepare_matrix(system, &(struct cs_matrix){.v = up, .cd = -3}, false);
        term->add_matrix_product(system, a, y);
        static const size_t entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
        for (size_t c = 0; c < 3; c++)
            y[c * N + column % N] += b[entry[c][column / N] * N + column % N];
        for (size_t i = 0; i < VALUES && inv_mass > 0; i++)
            if (system->inv_mass[i % N] > 0)
                ck_assert_double_eq_tol(y[i], -(up[i] - down[i]) / (2 * STEP), 1e-6);
    }
    fixture_close(&kinds.cloth);
}

/* Only methods that ask and scenes with friction have it. */
TEST(it_is_there_where_it_is_used) {
    static const struct {
        const char *method, *friction;
        bool built;
    } cases[] = {{"backward-euler", "0.3", true},
                 {"backward-euler", "0", false},
                 {"implicit-linearised", "0.3", false}};
    for (size_t k = 0; k < LENGTH(cases); k++) {
        struct fixture sheet;
        fixture_open(&sheet, cases[k].method,
                     "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3]}, \"mass\": {\"total\": 1}, "
                     "\"springs\": {\"stretch\": 10}}], \"colliders\": "
                     "[{\"floor\": {\"height\": -1}, \"friction\": %s}], \"contact\": "
                     "\"force\"}",
                     cases[k].friction);
        fixture_start(&sheet);
        const struct cs_plan_row *row =
            sheet.session.run.plan.rows + CS_FEATURE_LAGGED_FRICTION;
        ck_assert(row->built == cases[k].built);
        ck_assert((row->bytes > 0) == cases[k].built);
        ck_assert(!sheet.system->lagged_friction == !cases[k].built);
        ck_assert(!sheet.session.run.host->table.lag_friction == !cases[k].built);
        fixture_close(&sheet);
    }
}

/* A session may begin again with the same system: the term of the former run is gone. */
TEST(a_second_run_has_it_once) {
    struct kinds kinds;
    struct cs_error error = {0};
    double first[VALUES], second[VALUES];
    open(&kinds);
    const uint32_t n_terms = kinds.cloth.system->n_terms;
    kinds.host->lag_friction(kinds.host->ctx, 0, kinds.x);
    force(&kinds, kinds.x, first);
    ck_assert_int_eq(cs_session_begin(&kinds.cloth.session, NULL, &error), CS_OK);
    ck_assert_uint_eq(kinds.cloth.system->n_terms, n_terms);
    kinds.host = &kinds.cloth.session.run.host->table;
    kinds.host->lag_friction(kinds.host->ctx, 0, kinds.x);
    force(&kinds, kinds.x, second);
    ck_bits(first, second, VALUES, "the force of the second run");
    fixture_close(&kinds.cloth);
}

/* A sheet that slides on a floor and is pressed to it. */
#define SLIDING                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"start\": \"flat\", \"velocity\": [0.5, 0," \
    " 0.2], \"place\": {\"translate\": [0, 0.12, 0]}}, \"mass\": {\"particle\": 0.1}, "        \
    "\"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0}}],"            \
    " \"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.2, \"friction\": 0.4}],"   \
    " \"contact\": {\"law\": \"force\", \"stiffness\": 40, \"friction_speed\": 0.5},"          \
    " \"time\": {\"fps\": 10}}"

enum { SHEET_VALUES = 6 * 16 };

/* Returns true if friction was lagged on the way. */
static bool end_state(const char *name, double h, double state[SHEET_VALUES]) {
    struct fixture sheet;
    char integrator[120];
    methods_set(integrator, name, "dt", h);
    fixture_open(&sheet, integrator, SLIDING);
    cs_perturb_smooth(sheet.system, 0.01, 0.2);
    fixture_start(&sheet);
    fixture_frames(&sheet, 3);
    memcpy(state, sheet.x, SHEET_VALUES * sizeof *state);
    const struct cs_lagged_friction *lagged = sheet.system->lagged_friction;
    const bool used = lagged && lagged->set.n > 0;
    fixture_close(&sheet);
    return used;
}

/* Two iterations do not suffice with the matrix of true friction, which leaves out how N moves,
 * so that lagged friction solves most steps. */
TEST(orders_hold_with_lagged_friction) {
    static const struct {
        const char *name;
        double order;
    } methods[] = {{"backward-euler:rtol=1e-12,iterations=2", 1},
                   {"implicit-midpoint:rtol=1e-12,iterations=2", 2},
                   {"bdf2:rtol=1e-12,iterations=2", 2},
                   {"tr-bdf2:rtol=1e-12,iterations=2", 2},
                   {"sdirk2:rtol=1e-12,iterations=2", 2},
                   {"newmark:rtol=1e-12,iterations=2", 2}};
    double reference[SHEET_VALUES], state[SHEET_VALUES], error[2];
    end_state("rk4", 2e-4, reference);
    for (size_t m = 0; m < LENGTH(methods); m++) {
        const double h = methods[m].order > 1 ? 1.0 / 640 : 1.0 / 1280;
        for (int k = 0; k < 2; k++) {
            ck_assert_msg(end_state(methods[m].name, h / (1 + k), state), "%s: never lagged",
                          methods[m].name);
            error[k] = cs_rms_difference(state, reference, SHEET_VALUES);
        }
        const double order = log2(error[0] / error[1]);
        printf("%s: %.3f (%.3g, %.3g)\n", methods[m].name, order, error[0], error[1]);
        ck_assert_msg(fabs(order - methods[m].order) < 0.1,
                      "%s: order %.3f with friction (errors %.3g, %.3g)", methods[m].name,
                      order, error[0], error[1]);
    }
}

/* Two sheets that are thrown at each other at 10 m/s: with true friction alone the iteration
 * runs in circles at 0.06 of the impulse, whatever the step. */
#define SPRINGS                                                                                \
    "\"mass\": {\"areal_density\": 0.2}, \"springs\": {\"stretch\": 200, \"shear\": 60, "      \
    "\"bend\": 0.5, \"damping\": 0.01}, \"thickness\": 0.004, \"self_contact\": true"
#define CLASH                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"size\": [0.3, 0.3], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0, 0.3, 0]}, \"velocity\": [0, -5, 0]}, " SPRINGS "},"       \
    " {\"cloth\": {\"grid\": [8, 8], \"size\": [0.3, 0.3], \"start\": \"flat\", \"place\": "   \
    "{\"translate\": [0.03, 0.25, 0.02], \"rotate\": [0, 0.3826834, 0, 0.9238795]}, "          \
    "\"velocity\": [0, 5, 0]}, " SPRINGS "}], \"pairs\": {\"among\": \"all\", \"friction\": "  \
    "0.3}, \"contact\": {\"law\": \"force\", \"stiffness\": 20000}, \"forces\": "              \
    "{\"gravity\": [0, 0, 0]}, \"crossings\": \"limit\"}"

TEST(sheets_that_clash_are_solved) {
    static const char *const methods[] = {"backward-euler", "newmark"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        struct fixture sheets;
        fixture_open(&sheets, methods[m], CLASH);
        fixture_start(&sheets);
        double p[3] = {0}, l[3] = {0};
        for (int frame = 0; frame < 3; frame++) {
            fixture_frames(&sheets, 1);
            ck_assert_uint_eq(cs_crossings_count(sheets.system, 0, sheets.x).n, 0);
        }
        fixture_momentum(&sheets, p, l);
        // contacts of the last time that friction was lagged
        ck_assert_msg(sheets.system->lagged_friction->set.n > 0, "%s", methods[m]);
        // 0.018 kg at 5 m/s each; Newton's residual is 1e-6 of the impulse
        for (int c = 0; c < 3; c++)
            ck_assert_msg(fabs(p[c]) < 1e-5, "%s: momentum %g", methods[m], p[c]);
        fixture_close(&sheets);
    }
}
