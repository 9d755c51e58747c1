/* contract_fixture.h - a scene in which every force of the list acts, on cloths that are
 * pulled, sheared and perturbed, and its forces one by one. */
#ifndef CONTRACT_FIXTURE_H
#define CONTRACT_FIXTURE_H

#include "../unit/unit.h"
#include "fixture.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/solver/linear.h"
#include "planted_terms.h"

#include <stdio.h>
#include <string.h>

#define FORCES                                                                                 \
    "\"drag\": 0.3, \"drag_unit\": \"Pa s/m\","                                                \
    " \"wind\": {\"direction\": [0.3, 0.2, 1], \"strength\": 4,"                               \
    " \"velocity\": [2, -1, 3]}"
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4]}, \"mass\": {\"areal_density\": 0.4},"        \
    " \"self_contact\": true, \"thickness\": 0.199, \"friction\": 0.4,"                        \
    " \"springs\": {\"stretch\": 200, \"shear\": 75, \"bend\": 25, \"damping\": 0.7},"         \
    " \"pins\": [\"top-left\", 7]}, {\"cloth\": {\"grid\": [4, 3], \"size\": [0.6, 0.5], "     \
    "\"place\": {\"translate\": [0, 0, 4]}}, \"mass\": {\"areal_density\": 0.4}, "             \
    "\"elastic\": "                                                                            \
    "{\"membrane\": {\"young\": 60, \"poisson\": 0.3}, \"bending\": {\"stiffness\": 0.04, "    \
    "\"damping\": 0.02}, \"damping\": "                                                        \
    "0.01}, "                                                                                  \
    "\"pins\": [\"bottom-left\"]}, {\"cloth\": {\"grid\": [3, 3], \"size\": [0.4, 0.5], "      \
    "\"place\": {\"translate\": [0, 0, 6]}}, \"mass\": {\"areal_density\": 0.4}, "             \
    "\"elastic\": "                                                                            \
    "{\"membrane\": {\"warp\": 60, \"weft\": 40, \"shear\": 3, \"coupling\": 9}, "             \
    "\"bending\": {\"warp\": 0.03, \"weft\": 0.05, \"twist\": 0.01, \"coupling\": -0.02}}}, "  \
    "{\"mesh\": {\"shape\": \"box\", \"detail\": 3, \"place\": {\"translate\": [0, 0, "        \
    "8]}}, "                                                                                   \
    "\"mass\": {\"areal_density\": 0.4}, \"pressure\": 7, \"elastic\": {\"membrane\": "        \
    "{\"young\": 60}, "                                                                        \
    "\"bending\": {\"stiffness\": 0.04, \"damping\": 0.02}}}, {\"mesh\": {\"shape\": "         \
    "\"box\", \"detail\": 3, \"place\": {\"translate\": [0, 0, 12]}}, \"mass\": "              \
    "{\"areal_density\": 0.4}, \"springs\": {\"stretch\": 20, \"bend\": 0}, \"pressure\": "    \
    "5, \"outer_pressure\": 20}],"                                                             \
    " \"events\": [{\"from\": 0, \"to\": 1, \"impact\": {\"impulse\": 1, \"direction\": [1, "  \
    "2, 3]}}],"                                                                                \
    " \"colliders\": [{\"sphere\": {\"centre\": [0.1, -0.05, -0.5], \"radius\": 0.35},"        \
    " \"thickness\": 0.3, \"friction\": 0.4}, {\"capsule\": {\"from\": [-0.5, 0, 0.4], "       \
    "\"to\": "                                                                                 \
    "[0.2, 0.1, 0.4], \"radius\": 0.2}, \"thickness\": 0.3, \"friction\": 0.7}, {\"sphere\": " \
    "{\"centre\": [0.1, 0.05, -0.06], \"radius\": 0.02}, \"thickness\": 0.12, \"friction\": "  \
    "0.5}],"                                                                                   \
    " \"contact\": {\"law\": \"force\", \"stiffness\": 50, \"damping\": 0.01,"                 \
    " \"friction_speed\": 0.3}, \"seams\": [{\"body\": 0, \"particles\": [19], \"to\": {"      \
    "\"body\": 0, \"particles\": [5]}, \"stiffness\": 30, \"damping\": 0.5, \"length\": 0.9}," \
    " {\"body\": 0, \"particles\": [16], \"to\": {\"body\": 0, \"particles\": [1, 2, 8],"      \
    " \"weights\": [0.2, 0.3, 0.5]}, \"stiffness\": 40, \"damping\": 0.4}],"                   \
    " \"forces\": {" FORCES "%s}}"

enum { N = 153, VALUES = 3 * N };

#define STATE_OF(cloth, p)                                                                     \
    { .x = (cloth)->x, .v = (cloth)->v, .parts = (p) }

/* keys of `forces` that the scene does not have yet get a value */
static inline void add_keys(char *text, size_t size) {
    *text = 0;
    for (uint32_t k = 0; k < cs_n_terms; k++)
        for (const char *const *key = cs_terms[k]->rampable_keys; key && *key; key++) {
            char quoted[80];
            const char *name = strncmp(*key, "forces.", 7) ? NULL : *key + 7;
            snprintf(quoted, sizeof quoted, "\"%s\"", name ? name : "");
            if (name && !strchr(name, '.') && strcmp(name, "gravity") &&
                !strstr(FORCES, quoted))
                snprintf(text + strlen(text), size - strlen(text), ", %s: 0.7", quoted);
        }
}

/* all forces act */
static inline void open(struct fixture *cloth) {
    char keys[800];
    planted = (struct planted){.resist = 2, .trap = 300, .trap_damping = 5, .swing = 1};
    add_keys(keys, sizeof keys);
    fixture_open(cloth, "implicit-linearised", SCENE, keys);
    ck_assert_uint_eq(cloth->n, N);
    fixture_start(cloth);
    cs_perturb_smooth(cloth->system, 0.06, 2);
}

static inline void leave_alone(struct fixture *cloth, const struct cs_term *term) {
    cloth->system->terms[0] = term;
    cloth->system->n_terms = 1;
    // the solver knows springs by their factors, not by the list
    if (!term->add_diagonal)
        cloth->system->springs.n_runs = cloth->system->springs.n = 0;
}

static inline void force(const struct fixture *cloth, struct cs_eval at, double f[VALUES]) {
    cs_normals_update(cloth->system, at.x);
    cs_terms_force(cloth->system, &at, f);
}

/* A p - M p of a force's share of the matrix with cm = 1 */
static inline void share_of(const struct fixture *cloth, struct cs_matrix matrix,
                            const double *p, double *out) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_linear linear;
    matrix.x = cloth->x;
    matrix.v = cloth->v;
    matrix.cm = 1;
    ck_assert_int_eq(cs_linear_init(&linear, cloth->system, &arena, &error), CS_OK);
    cs_linear_setup(&linear, &matrix);
    cs_linear_mul(&linear, p, out);
    for (size_t i = 0; i < VALUES; i++)
        out[i] -= cloth->system->mass[i % N] * p[i];
    cs_arena_finish(&arena);
}

#endif
