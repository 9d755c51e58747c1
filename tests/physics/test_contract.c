/* Every force of the list keeps what its bits and calls promise, whatever it is.
 *
 * The list is walked: a new force is tested here without a word more, if its number is a key of
 * `forces` that it names in its `ramps`; else the scene of contract_fixture.h must make it act.
 * Each force is put into a system alone, on a cloth that is pulled, sheared and perturbed.
 * Central differences with a step of 1e-6: truncation is near 1e-11 and rounding near 1e-9 of
 * the largest entry. */
#include "contract_fixture.h"
#include "scene/event_key.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STEP 1e-6

TEST(bits_and_calls_agree) {
    uint32_t own_bits = 0;
    // the wind's: of all pressures of air
    const uint32_t shared = CS_PART_WIND | CS_PART_POTENTIAL | CS_PART_DISSIPATIVE |
                            CS_PART_EXTERNAL | CS_PART_ELASTIC | CS_PART_ELASTIC_DAMPING;
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        const struct cs_term *term = cs_terms[k];
        cs_term_assert(term);
        ck_assert_msg(term->part_bits && !(term->part_bits & own_bits & ~shared),
                      "%s: its bit is another's", term->name);
        own_bits |= term->part_bits & ~shared;
        for (uint32_t j = 0; j < k; j++)
            ck_assert_str_ne(term->name, cs_terms[j]->name);
    }
}

/* A force with one of its calls gone, or half a pair of calls more, is told at once. */
TEST(a_half_made_force_aborts) {
    static const size_t calls[] = {offsetof(struct cs_term, plan),
                                   offsetof(struct cs_term, add_force),
                                   offsetof(struct cs_term, energy),
                                   offsetof(struct cs_term, add_scalar),
                                   offsetof(struct cs_term, add_blocks),
                                   offsetof(struct cs_term, add_approach),
                                   offsetof(struct cs_term, prepare_matrix),
                                   offsetof(struct cs_term, add_matrix_product),
                                   offsetof(struct cs_term, friction_chunks),
                                   offsetof(struct cs_term, store_friction),
                                   offsetof(struct cs_term, add_diagonal)};
    for (uint32_t k = 0; k < cs_n_terms; k++)
        for (size_t c = 0; c < LENGTH(calls); c++) {
            struct cs_term term = *cs_terms[k];
            void (*call)(void);
            memcpy(&call, (const char *)&term + calls[c], sizeof call);
            // one that is called by nothing here
            call = call ? NULL : (void (*)(void))abort;
            memcpy((char *)&term + calls[c], &call, sizeof call);
            UNIT_ASSERT_ABORTS(cs_term_assert(&term));
        }
}

TEST(every_force_acts_here) {
    struct fixture cloth;
    open(&cloth);
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        uint32_t t = 0;
        while (t < cloth.system->n_terms && cloth.system->terms[t] != cs_terms[k])
            t++;
        ck_assert_msg(t < cloth.system->n_terms,
                      "%s does not act in the scene of contract_fixture.h", cs_terms[k]->name);
    }
    fixture_close(&cloth);
}

TEST(events_can_change_the_keys) {
    struct fixture cloth;
    open(&cloth);
    for (uint32_t k = 0; k < cs_n_terms; k++)
        for (const char *const *key = cs_terms[k]->rampable_keys; key && *key; key++) {
            char path[96];
            struct cs_event_key found;
            struct cs_error error = {0};
            // what stands in a list is the first there that has it
            const size_t list = !strncmp(*key, "bodies.", 7)       ? 6
                                : !strncmp(*key, "colliders.", 10) ? 9
                                                                   : 0;
            const bool vector = !strcmp(*key, "forces.gravity") || strstr(*key, "velocity");
            for (int i = 0; i < (list == 6 ? 4 : 1) && (i == 0 || error.status); i++) {
                if (list)
                    snprintf(path, sizeof path, "%.*s[%d]%s", (int)list, *key, i, *key + list);
                else
                    snprintf(path, sizeof path, "%s%s", *key, vector ? "[1]" : "");
                error = (struct cs_error){0};
                cs_event_key_find(cloth.session.scene, path, &found, &error);
            }
            ck_assert_msg(!error.status, "%s: %s", cs_terms[k]->name, error.message);
        }
    fixture_close(&cloth);
}

/* (f(x + e dx, v + e dv) - f(x - e dx, v - e dv)) / 2 e */
static void difference(const struct fixture *cloth, uint32_t parts, const double *dx,
                       const double *dv, double slope[VALUES]) {
    double x[VALUES], v[VALUES], forward[VALUES];
    for (int sign = 1; sign >= -1; sign -= 2) {
        for (size_t i = 0; i < VALUES; i++) {
            x[i] = cloth->x[i] + sign * STEP * dx[i];
            v[i] = cloth->v[i] + sign * STEP * dv[i];
        }
        force(cloth, (struct cs_eval){.x = x, .v = v, .parts = parts},
              sign > 0 ? forward : slope);
    }
    for (size_t i = 0; i < VALUES; i++)
        slope[i] = (forward[i] - slope[i]) / (2 * STEP);
}

static double largest(const double *a) {
    double found = 0;
    for (size_t i = 0; i < VALUES; i++)
        found = fmax(found, fabs(a[i]));
    return found;
}

/* one bit of one force, all columns of df/dx and df/dv */
static void check_jvp(const struct fixture *cloth, const char *name, uint32_t part) {
    double zero[VALUES] = {0}, unit[VALUES] = {0}, slope[VALUES], df[VALUES];
    double size = 0, error = 0;
    for (size_t column = 0; column < 2 * VALUES; column++) {
        const bool place = column < VALUES;
        if (cloth->system->inv_mass[column % N] <= 0)
            continue; // a pinned particle does not move
        unit[column % VALUES] = 1;
        difference(cloth, part, place ? unit : zero, place ? zero : unit, slope);
        struct cs_eval at = STATE_OF(cloth, part);
        *(place ? &at.dx : &at.dv) = unit;
        cs_normals_update(cloth->system, cloth->x);
        cs_terms_jvp(cloth->system, &at, df);
        unit[column % VALUES] = 0;
        size = fmax(size, largest(slope));
        for (size_t i = 0; i < VALUES; i++)
            error = fmax(error, fabs(df[i] - slope[i]));
    }
    ck_assert_msg(!(part & CS_PART_LINEARISED) || size > 1e-3,
                  "%s, part %x: the largest derivative is only %g", name, part, size);
    ck_assert_msg(error <= 1e-7 * size + 1e-9, "%s, part %x: off by %g of %g", name, part,
                  error, size);
}

TEST(jvp_is_the_derivative) {
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        struct fixture cloth;
        open(&cloth);
        leave_alone(&cloth, cs_terms[k]);
        for (uint32_t part = 1; part && part <= cs_terms[k]->part_bits; part *= 2)
            if (part & cs_terms[k]->part_bits)
                check_jvp(&cloth, cs_terms[k]->name, part);
        fixture_close(&cloth);
    }
}

/* The blow-up check adds energies up: only gravity's may be below 0. */
static bool keeps_sign(const struct cs_term *term, double energy) {
    return energy >= 0 || term->energy_kind == CS_ENERGY_GRAVITY;
}

TEST(an_energy_below_zero_is_found) {
    const struct cs_term potential = {.energy_kind = CS_ENERGY_OTHER};
    ck_assert(keeps_sign(&potential, 0) && !keeps_sign(&potential, -1e-9) &&
              !keeps_sign(&potential, (double)NAN) && keeps_sign(&cs_term_gravity, -1));
}

/* without the force that an energy has, the energy is level: f = -dE/dx of those bits */
TEST(force_is_the_slope_of_its_energy) {
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        struct fixture cloth;
        double f[VALUES];
        open(&cloth);
        leave_alone(&cloth, cs_terms[k]);
        const struct cs_eval at = STATE_OF(&cloth, CS_PART_WITH_ENERGY);
        force(&cloth, at, f);
        for (size_t i = 0; i < VALUES && cs_terms[k]->energy; i++) {
            const double place = cloth.x[i];
            if (cloth.system->inv_mass[i % N] <= 0)
                continue;
            cloth.x[i] = place + STEP;
            const double above = cs_terms[k]->energy(cloth.system, &at);
            cloth.x[i] = place - STEP;
            const double below = cs_terms[k]->energy(cloth.system, &at);
            cloth.x[i] = place;
            ck_assert_msg(keeps_sign(cs_terms[k], above) && keeps_sign(cs_terms[k], below),
                          "%s: its energy is %g J and %g J, expected 0 or more",
                          cs_terms[k]->name, above, below);
            ck_assert_msg(fabs(f[i] - (below - above) / (2 * STEP)) < 1e-7, "%s",
                          cs_terms[k]->name);
        }
        fixture_close(&cloth);
    }
}

/* Derivatives of damping by places are left out, so that the share is symmetric: at rest they
 * are 0. The same of the particles' own blocks, by which it must agree with the diagonal. */
TEST(share_of_the_matrix_is_that_of_jvp) {
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        struct fixture cloth;
        double p[VALUES], found[VALUES], dk[VALUES], dd[VALUES], kxx[6 * N], dvv[6 * N];
        open(&cloth);
        leave_alone(&cloth, cs_terms[k]);
        memset(cloth.v, 0, VALUES * sizeof *cloth.v);
        struct cs_eval at = STATE_OF(&cloth, CS_PART_LINEARISED);
        cs_normals_update(cloth.system, cloth.x);
        cs_terms_diagonal(cloth.system, &at, kxx, dvv);
        for (size_t i = 0; i < VALUES; i++)
            p[i] = cloth.system->inv_mass[i % N] > 0 ? sin(0.9 * (double)i) : 0;
        share_of(&cloth, (struct cs_matrix){.cd = -0.02, .ck = -4e-4}, p, found);
        at.dx = p;
        cs_terms_jvp(cloth.system, &at, dk);
        at.dx = NULL, at.dv = p;
        cs_terms_jvp(cloth.system, &at, dd);
        for (size_t i = 0; i < VALUES; i++)
            ck_assert_msg(fabs(found[i] + 0.02 * dd[i] + 4e-4 * dk[i]) < 1e-12, "%s",
                          cs_terms[k]->name);
        for (size_t i = 0; i < VALUES; i++) {
            static const int at_row[3] = {0, 3, 5};
            double unit[VALUES] = {0};
            if (cloth.system->inv_mass[i % N] <= 0)
                continue;
            unit[i] = 1;
            at.dx = unit, at.dv = unit;
            cs_terms_jvp(cloth.system, &at, dk);
            const size_t own = at_row[i / N] * (size_t)N + i % N;
            ck_assert_msg(fabs(kxx[own] + dvv[own] - dk[i]) < 1e-9, "%s: own blocks",
                          cs_terms[k]->name);
        }
        fixture_close(&cloth);
    }
}

/* p.A p >= 0 where the matrix is asked to be so, in any state */
TEST(share_is_positive_on_demand) {
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        struct fixture cloth;
        open(&cloth);
        leave_alone(&cloth, cs_terms[k]);
        for (int state = 0; state < 8; state++) {
            double p[VALUES], found[VALUES], curvature = 0;
            cs_perturb_smooth(cloth.system, 0.05 * state, state);
            for (size_t i = 0; i < VALUES; i++)
                p[i] = cloth.system->inv_mass[i % N] > 0 ? sin((1.3 + state) * (double)i) : 0;
            share_of(&cloth, (struct cs_matrix){.cd = -0.02, .ck = -4e-4, .psd = true}, p,
                     found);
            for (size_t i = 0; i < VALUES; i++)
                curvature += p[i] * found[i];
            ck_assert_msg(curvature > -1e-12, "%s: p.A p = %g", cs_terms[k]->name, curvature);
        }
        fixture_close(&cloth);
    }
}

/* largest eigenvalue in size of M^-1 df/dx or M^-1 df/dv, by power iteration */
static double largest_value(const struct fixture *cloth, bool velocity) {
    double p[VALUES], df[VALUES], value = 0;
    for (size_t i = 0; i < VALUES; i++)
        p[i] = sin(1.3 * (double)i + (double)(i % 5));
    for (int k = 0; k < 200; k++) {
        struct cs_eval at = STATE_OF(cloth, CS_PART_LINEARISED);
        double norm = 0;
        *(velocity ? &at.dv : &at.dx) = p;
        cs_terms_jvp(cloth->system, &at, df);
        for (size_t i = 0; i < VALUES; i++) {
            df[i] *= cloth->system->inv_mass[i % N];
            norm += df[i] * df[i];
        }
        value = sqrt(norm);
        for (size_t i = 0; i < VALUES && value > 0; i++)
            p[i] = df[i] / value;
    }
    return value;
}

TEST(bounds_are_above_the_truth) {
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        struct fixture cloth;
        double work[2 * N], omega, delta;
        open(&cloth);
        leave_alone(&cloth, cs_terms[k]);
        memset(cloth.v, 0, VALUES * sizeof *cloth.v);
        const struct cs_eval at = STATE_OF(&cloth, CS_PART_ALL);
        cs_spectral_bounds_at(cloth.system, &at, work, &omega, &delta);
        cs_normals_update(cloth.system, cloth.x);
        const double square = largest_value(&cloth, false), rate = largest_value(&cloth, true);
        ck_assert_msg(square <= 1.000001 * omega * omega, "%s: omega^2 %g, bound %g",
                      cs_terms[k]->name, square, omega * omega);
        ck_assert_msg(rate <= 1.000001 * 2 * delta, "%s: rate %g, bound %g", cs_terms[k]->name,
                      rate, 2 * delta);
        fixture_close(&cloth);
    }
}

TEST(no_force_is_above_its_greatest) {
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        struct fixture cloth;
        double f[VALUES];
        open(&cloth);
        leave_alone(&cloth, cs_terms[k]);
        for (int state = 0; state < 8 && cs_terms[k]->max_acceleration; state++) {
            cs_perturb_smooth(cloth.system, 0.05 * state, state);
            // what is against the velocity takes energy, however strong it is
            struct cs_eval at = STATE_OF(&cloth, CS_PART_ALL & ~CS_PART_DISSIPATIVE);
            at.t = 0.3 * state;
            force(&cloth, at, f);
            for (size_t i = 0; i < N; i++) {
                const double size =
                    sqrt(f[i] * f[i] + f[N + i] * f[N + i] + f[2 * N + i] * f[2 * N + i]);
                ck_assert_msg(size <= 1.000001 * cs_terms[k]->max_acceleration(cloth.system, i),
                              "%s: %g N", cs_terms[k]->name, size);
            }
        }
        fixture_close(&cloth);
    }
}
