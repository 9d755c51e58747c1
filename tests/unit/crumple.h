/* crumple.h - a stiff system in a state without any order, and its matrix assembled spring by
 * spring: what the linear solver is tested on. */
#ifndef CRUMPLE_H
#define CRUMPLE_H

#include "base/vector.h"
#include "model/solver/linear.h"
#include "sheet.h"

#define CRUMPLE_H_STEP (1 / 60.0)

/* a grid of r x r on 1 m and 0.2 kg; stretch k, and shear and bend as in the cloth thesis */
#define CRUMPLE_GRID                                                                           \
    "{\"cloth\": {\"grid\": [%d, %d], \"size\": [1, 1]}, \"mass\": {\"total\": 0.2},"          \
    " \"springs\": {\"stretch\": %.17g, \"shear\": %.17g, \"bend\": %.17g,"                    \
    " \"damping\": 1e-3}%s}"
#define CRUMPLE_GRID_VALUES(r, k, rest) r, r, k, (k)*22 / 75, (k)*8 / 75, rest
#define CRUMPLE_PINS                    ", \"pins\": [\"top-left\", \"top-right\"]"

struct crumple {
    struct sheet sheet;
    struct cs_arena arena;
    struct cs_linear linear;
    double *b, *u; /* (3,n): a right-hand side, and 0 */
    uint64_t iterations;
    double residual;
};

/* in -1..1 */
static inline double crumple_random(uint32_t *seed) {
    *seed = *seed * 1664525 + 1013904223;
    return (double)(*seed >> 8) / 8388608 - 1;
}

/* wrinkled, sheared and jittered by a tenth of `spacing`; b is of all wavelengths */
static inline void crumple_start(struct crumple *crumple, double spacing) {
    struct cs_error error = {0};
    struct sheet *sheet = &crumple->sheet;
    const size_t n = sheet->n;
    uint32_t seed = 1;
    crumple->arena = (struct cs_arena){0};
    cs_linear_init(&crumple->linear, &sheet->system, &crumple->arena, &error);
    crumple->b = cs_arena_alloc_array(&crumple->arena, 3 * n, sizeof(double), &error);
    crumple->u = cs_arena_alloc_array(&crumple->arena, 3 * n, sizeof(double), &error);
    UNIT_ASSERT_OK(&error);
    for (size_t i = 0; i < n; i++) {
        const double x = sheet->x[i], y = sheet->x[n + i];
        const double moved[3] = {0.05 * y, 0, 0.03 * sin(25 * x) * cos(16 * y)};
        for (size_t c = 0; c < 3; c++) {
            const double jitter = 0.1 * spacing * crumple_random(&seed);
            const double noise = crumple_random(&seed);
            if (sheet->system.inv_mass[i] == 0)
                continue;
            sheet->x[c * n + i] += moved[c] + jitter;
            crumple->b[c * n + i] =
                sheet->system.mass[i] * (sin(3 * x + (double)c) + cos(31 * y) + 0.1 * noise);
        }
    }
}

static inline void crumple_shut(struct crumple *crumple) {
    cs_arena_finish(&crumple->arena);
    sheet_close(&crumple->sheet);
}

/* backward Euler's matrix of a step of 1/60 s */
static inline bool crumple_setup(struct crumple *crumple, bool psd) {
    const double h = CRUMPLE_H_STEP;
    return cs_linear_setup(
        &crumple->linear,
        &(struct cs_matrix){
            .x = crumple->sheet.x, .cm = 1, .cd = -h, .ck = -h * h, .psd = psd});
}

/* from the start 0 */
static inline enum cs_linear_end crumple_solve(struct crumple *crumple, double rtol) {
    memset(crumple->u, 0, 3 * sizeof *crumple->u * crumple->sheet.n);
    return cs_linear_solve(&crumple->linear, crumple->b, rtol, crumple->u, &crumple->iterations,
                           &crumple->residual);
}

#define SPHERE  "{\"mesh\": {\"shape\": \"sphere\", \"detail\": %d}, \"mass\": {\"total\": 1}%s"
#define LIMBS   "{\"mesh\": {\"shape\": \"limbs\", \"detail\": 24}, \"mass\": {\"total\": 1}%s"
#define SPRINGS ", \"springs\": {\"stretch\": %.17g, \"bend\": %.17g, \"damping\": 1e-3}}"

enum { KINDS = 4 };

/* a pinned grid that halves unevenly, a strip, a closed mesh, and all kinds in one system with
 * a small body and a dense network */
static inline void open_kind(struct crumple *crumple, int kind, double k) {
    struct sheet *sheet = &crumple->sheet;
    if (kind == 0)
        sheet_open(sheet, CS_NEED_SOLVE, "{\"bodies\": [" CRUMPLE_GRID "]}",
                   CRUMPLE_GRID_VALUES(37, k, CRUMPLE_PINS));
    else if (kind == 1)
        sheet_open(sheet, CS_NEED_SOLVE,
                   "{\"bodies\": [{\"cloth\": {\"grid\": [2, 301]}, \"mass\": {\"total\": 1},"
                   " \"springs\": {\"stretch\": %.17g}, \"pins\": [5, 6, 7, 8]}]}",
                   k);
    else if (kind == 2)
        sheet_open(sheet, CS_NEED_SOLVE, "{\"bodies\": [" SPHERE SPRINGS "]}", 12, "", k,
                   k / 10);
    else
        sheet_open(sheet, CS_NEED_SOLVE,
                   "{\"bodies\": [" SPHERE SPRINGS ", " CRUMPLE_GRID ", " CRUMPLE_GRID
                   ", " LIMBS SPRINGS "], \"forces\": {\"drag\": 0.01}}",
                   12, "", k, k, CRUMPLE_GRID_VALUES(5, k, ""),
                   CRUMPLE_GRID_VALUES(30, k, ", \"pins\": [\"bottom\", 31, 450]"),
                   ", \"network\": {\"springs\": 6}", k, k);
    crumple_start(crumple, 0.02);
}

#endif
