/* Ten sheets, each turned by 90/11 degrees, and a ball that falls on them (after Li, Kaufman
 * and Jiang 2021): they come to rest but for the creep of the friction law, which has a closed
 * form. All three seconds with the argument all. */
#include "fixture.h"

#include "model/contact/ccd/crossings.h"
#include "model/force/terms.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHEETS = 10, GRID = 9, SHEET = GRID * GRID };

static const double friction = 0.1, friction_speed = 0.01;
static void write_pile(char *text, size_t capacity) {
    size_t n = (size_t)snprintf(text, capacity, "{\"bodies\": [");
    for (int k = 0; k < SHEETS; k++)
        n += (size_t)snprintf(
            text + n, capacity - n,
            "{\"cloth\": {\"grid\": [%d, %d], \"size\": [0.4, 0.4], \"start\": \"flat\", "
            "\"place\": {\"translate\": [0, %g, 0], \"rotate\": [0, %.17g, 0, 1]}}, "
            "\"thickness\": 0.02, \"mass\": {\"areal_density\": 0.3}, \"springs\": "
            "{\"stretch\": 60, \"shear\": 20, \"bend\": 1, \"damping\": 0.1}}, ",
            GRID, GRID, 0.018 * (k + 1), tan(k * acos(-1) / 44));
    snprintf(text + n, capacity - n,
             "{\"mesh\": {\"shape\": \"sphere\", \"detail\": 4, \"scale\": [0.24, 0.24, 0.24], "
             "\"place\": {\"translate\": [0, 0.4, 0]}}, \"mass\": {\"total\": 0.3}, "
             "\"springs\": {\"stretch\": 400, \"damping\": 0.1}, \"thickness\": 0.02}], "
             "\"forces\": {\"drag\": 2e-3}, "
             "\"pairs\": {\"among\": \"all\", \"friction\": %g}, \"colliders\": [{\"floor\": "
             "{\"height\": 0}, \"friction\": 0.3, \"thickness\": 0.02}], \"contact\": "
             "{\"law\": \"force\", \"stiffness\": 200, \"damping\": 0.004, "
             "\"friction_speed\": %g}}",
             friction, friction_speed);
}

/* A sheet seen from above. */
struct seen {
    double centre[2], velocity[2]; /* m, m/s along x and z */
    double rate;                   /* rad/s about y */
    double inertia;                /* m2, of its particles about the centre */
};

static struct seen look(const struct fixture *pile, size_t sheet) {
    const double *along[2] = {pile->x + SHEET * sheet, pile->x + 2 * pile->n + SHEET * sheet};
    struct seen seen = {0};
    for (size_t i = 0; i < SHEET; i++)
        for (size_t c = 0; c < 2; c++) {
            seen.centre[c] += along[c][i] / SHEET;
            seen.velocity[c] += along[c][3 * pile->n + i] / SHEET;
        }
    for (size_t i = 0; i < SHEET; i++) {
        const double r[2] = {along[0][i] - seen.centre[0], along[1][i] - seen.centre[1]};
        const double *v = along[0] + 3 * pile->n + i;
        seen.inertia += r[0] * r[0] + r[1] * r[1];
        seen.rate += r[1] * v[0] - r[0] * v[2 * pile->n];
    }
    seen.rate /= seen.inertia;
    return seen;
}

/* f (3,n): on a sheet and the one below it by each other alone, without friction */
static void press(const struct fixture *pile, size_t upper, double *f) {
    const size_t n = pile->n;
    struct cs_system alone = *pile->system;
    double *x = calloc(3 * n, sizeof *x);
    ck_assert_ptr_nonnull(x);
    memcpy(x, pile->x, 3 * n * sizeof *x);
    for (size_t i = 0; i < n; i++)
        if (i / SHEET != upper && i / SHEET + 1 != upper)
            x[n + i] += 10 + 2 * (double)(i / SHEET);
    alone.terms[0] = &cs_term_pairs;
    alone.n_terms = 1;
    cs_terms_force(&alone, &(struct cs_eval){.x = x, .v = pile->v, .parts = CS_PART_POTENTIAL},
                   f);
    free(x);
}

/* rad/s at which friction lets a sheet turn on the one below it: far below what it can hold it
 * is a damper of mu N/ev at each particle, so that the moment of the other forces, T = mu/ev
 * sum N r2 times the rate. */
static double creep_of(const struct fixture *pile, size_t upper) {
    const size_t n = pile->n;
    const struct seen seen = look(pile, upper);
    double *f = calloc(3 * n, sizeof *f), moment = 0, hold = 0;
    ck_assert_ptr_nonnull(f);
    press(pile, upper, f);
    for (size_t i = SHEET * upper; i < SHEET * (upper + 1); i++) {
        const double r[2] = {pile->x[i] - seen.centre[0], pile->x[2 * n + i] - seen.centre[1]};
        moment += r[1] * f[i] - r[0] * f[2 * n + i];
        hold += friction / friction_speed * f[n + i] * (r[0] * r[0] + r[1] * r[1]);
    }
    free(f);
    return moment / hold;
}

/* (m/s)2, sum over the particles of a sheet, beside a turn at that rate about its centre */
static double beside(const struct fixture *pile, size_t sheet, double rate) {
    const size_t n = pile->n;
    const struct seen seen = look(pile, sheet);
    double squared = 0;
    for (size_t i = SHEET * sheet; i < SHEET * (sheet + 1); i++) {
        const double v[3] = {pile->v[i] - rate * (pile->x[2 * n + i] - seen.centre[1]),
                             pile->v[n + i],
                             pile->v[2 * n + i] + rate * (pile->x[i] - seen.centre[0])};
        for (int c = 0; c < 3; c++)
            squared += v[c] * v[c];
    }
    return squared;
}

/* A sheet of the pile is pushed around by the others with less than a hundredth of what it
 * carries, and gives way as friction says: each turns on the one below it at the rate of the
 * closed form, to a hundredth of the friction speed at the rim. Ten rates in a row make the sum
 * to which the middle ones turn; beside that the rms speed is below a tenth of friction speed.
 */
static void check_rest(const struct fixture *pile) {
    const double rim = 0.2;
    double rate = 0, squared = beside(pile, 0, 0), drift = 0;
    for (size_t k = 1; k < SHEETS; k++) {
        const struct seen upper = look(pile, k), lower = look(pile, k - 1);
        const double creep = creep_of(pile, k), slip = upper.rate - lower.rate;
        ck_assert_msg(fabs(slip - creep) * rim < 0.01 * friction_speed,
                      "sheet %zu on %zu turns at %.3g rad/s, creep is %.3g", k, k - 1, slip,
                      creep);
        rate += creep;
        squared += beside(pile, k, rate);
        drift = fmax(drift, hypot(upper.velocity[0], upper.velocity[1]));
    }
    const double rms = sqrt(squared / (SHEETS * SHEET));
    ck_assert_msg(rms < 0.1 * friction_speed, "rms %.3g m/s", rms);
    ck_assert_msg(drift < 0.03 * friction_speed, "drift %.3g m/s", drift);
}

TEST(ten_sheets_come_to_rest) {
    static char text[1 << 13];
    struct fixture pile;
    write_pile(text, sizeof text);
    fixture_open(&pile, "implicit-linearised:dt=1e-3", "%s", text);
    fixture_start(&pile);
    for (uint32_t frame = 0; frame < (suite_all ? 180 : 1); frame++) {
        fixture_frames(&pile, 1);
        ck_assert_uint_eq(cs_crossings_count(pile.system, pile.session.run.t, pile.x).n, 0);
    }
    if (suite_all)
        check_rest(&pile);
    fixture_close(&pile);
}
