/* Finds vertices in one place by a hash table of cubes four distances wide. The first vertices
 * of all places are more than the distance apart, so that a cube holds few of them. */
#include "mesh/raw_mesh.h"

#include <math.h>
#include <stdlib.h>

/* Digits of a double: from where on a cube has no number of its own. */
#define ROUNDING 1e-12

struct grid {
    const double (*x)[3];
    double distance;
    uint32_t *heads, *next; /* first vertices of a hash, and those behind them, plus 1 */
    uint32_t mask;
};

static int64_t cube_of(double x, double width) {
    return (int64_t)floor(x / width);
}

/* Multipliers as of Teschner et al. 2003, in 64 bits. */
static uint32_t hash_of(const struct grid *grid, const int64_t cube[3]) {
    uint64_t h = (uint64_t)cube[0] * 73856093u ^ (uint64_t)cube[1] * 19349663u ^
                 (uint64_t)cube[2] * 83492791u;
    h *= 0x9e3779b97f4a7c15u;
    return (uint32_t)(h >> 32) & grid->mask;
}

static double squared_distance(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* The lowest first vertex near vertex i, or i. */
static uint32_t find_nearest(const struct grid *grid, uint32_t i) {
    const double width = 4 * grid->distance, *p = grid->x[i];
    uint32_t found = i;
    for (int corner = 0; corner < 8; corner++) {
        int64_t cube[3];
        for (int c = 0; c < 3; c++)
            cube[c] = cube_of(p[c] + (corner >> c & 1 ? 1 : -1) * grid->distance, width);
        for (uint32_t v = grid->heads[hash_of(grid, cube)]; v; v = grid->next[v - 1])
            if (v - 1 < found &&
                squared_distance(p, grid->x[v - 1]) <= grid->distance * grid->distance)
                found = v - 1;
    }
    return found;
}

static void insert(struct grid *grid, uint32_t i) {
    int64_t cube[3];
    for (int c = 0; c < 3; c++)
        cube[c] = cube_of(grid->x[i][c], 4 * grid->distance);
    uint32_t *head = grid->heads + hash_of(grid, cube);
    grid->next[i] = *head;
    *head = i + 1;
}

/* Length of the diagonal of the box of all positions; *far: their largest coordinate. */
static double diagonal_of(const double (*x)[3], uint32_t n, double *far) {
    double squared = 0;
    *far = 0;
    for (int c = 0; c < 3; c++) {
        double low = n ? x[0][c] : 0, high = low;
        for (uint32_t i = 0; i < n; i++) {
            low = fmin(low, x[i][c]);
            high = fmax(high, x[i][c]);
        }
        *far = fmax(*far, fmax(-low, high));
        squared += (high - low) * (high - low);
    }
    return sqrt(squared);
}

uint32_t cs_near_vertices_find(const double (*positions)[3], uint32_t n, const bool *among,
                               double fraction, uint32_t *places, struct cs_error *error) {
    double far;
    struct grid grid = {.x = positions, .distance = fraction * diagonal_of(positions, n, &far)};
    uint32_t doubled = 0;
    grid.distance = fmax(grid.distance, ROUNDING * far);
    for (grid.mask = 1; grid.mask < n && grid.mask < 1u << 24;)
        grid.mask *= 2;
    grid.heads = calloc(grid.mask--, sizeof *grid.heads);
    grid.next = calloc((size_t)n + 1, sizeof *grid.next);
    if (!grid.heads || !grid.next)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a mesh");
    for (uint32_t i = 0; !error->status && grid.distance > 0 && i < n; i++) {
        if (!among[i])
            continue;
        /* only the first of a place is entered, and found by the others */
        places[i] = find_nearest(&grid, i);
        doubled += places[i] != i;
        if (places[i] == i)
            insert(&grid, i);
    }
    free(grid.heads);
    free(grid.next);
    return doubled;
}
