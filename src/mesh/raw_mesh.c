/* Frees a mesh of a file, lists its sides, and puts its faults into words. */
#include "mesh/raw_mesh.h"

#include <math.h>
#include <stdlib.h>

void cs_raw_mesh_finish(struct cs_raw_mesh *raw) {
    free(raw->positions);
    free(raw->uv);
    free(raw->triangles);
    free(raw->sources);
    *raw = (struct cs_raw_mesh){0};
}

static int by_numbers(const uint32_t *a, const uint32_t *b, size_t n) {
    for (size_t k = 0; k < n; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int by_place(const void *left, const void *right) {
    const struct cs_raw_side *a = left, *b = right;
    int order = by_numbers(a->place, b->place, 2);
    order = order ? order : by_numbers(a->vertex, b->vertex, 2);
    order = order ? order : by_numbers(&a->triangle, &b->triangle, 1);
    return order ? order : by_numbers(&a->k, &b->k, 1);
}

void cs_raw_sides_list(const struct cs_raw_mesh *raw, const uint32_t *places,
                       struct cs_raw_side *sides) {
    struct cs_raw_side *side = sides;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        for (uint32_t k = 0; k < 3; k++, side++) {
            const uint32_t a = raw->triangles[t].corners[k].vertex,
                           b = raw->triangles[t].corners[(k + 1) % 3].vertex;
            const uint32_t p = places ? places[a] : a, q = places ? places[b] : b;
            const bool falls = p != q ? p > q : a > b;
            *side = (struct cs_raw_side){{falls ? q : p, falls ? p : q},
                                         {falls ? b : a, falls ? a : b},
                                         t,
                                         k,
                                         falls,
                                         false,
                                         0};
        }
    qsort(sides, 3 * (size_t)raw->n_triangles, sizeof *sides, by_place);
}

uint32_t cs_raw_side_run(const struct cs_raw_side *sides, uint32_t n, bool by_vertex) {
    uint32_t run = 1;
    while (run < n && !by_numbers(sides->place, sides[run].place, 2) &&
           (!by_vertex || !by_numbers(sides->vertex, sides[run].vertex, 2)))
        run++;
    return run;
}

void cs_mesh_fault_count(uint32_t *n, uint32_t *first, uint32_t line) {
    *first = *n ? *first : line;
    ++*n;
}

/* Adds "3 faces without area (line 7 first) removed". */
static void add_fault(uint32_t n, uint32_t line, const char *one, const char *several,
                      const char *done, struct cs_text *out) {
    if (!n)
        return;
    cs_text_add(out, "%s%u %s", out->length ? ", " : "", n, n == 1 ? one : several);
    if (line)
        cs_text_add(out, n == 1 ? " (line %u)" : " (the first in line %u)", line);
    cs_text_add(out, " %s", done);
}

void cs_mesh_mends_print(const struct cs_mesh_mends *mends, struct cs_text *out) {
    add_fault(mends->crossed, mends->crossed_line,
              "polygon that crosses itself or has over 1024 corners",
              "polygons that cross themselves or have over 1024 corners", "cut as a fan", out);
    add_fault(mends->flat, mends->flat_line, "face without area", "faces without area",
              "removed", out);
    add_fault(mends->twice, mends->twice_line, "face given twice", "faces given twice",
              "removed", out);
    add_fault(mends->turned, mends->turned_line, "face against its neighbours",
              "faces against their neighbours", "turned", out);
    add_fault(mends->cut, mends->cut_line, "edge of three triangles or more",
              "edges of three triangles or more", "cut", out);
    add_fault(mends->welded, 0, "doubled vertex", "doubled vertices", "welded", out);
    add_fault(mends->loose, 0, "vertex in no face", "vertices in no face", "removed", out);
}

/* Finds vertices in one place by a hash table of cubes four distances wide. The first vertices
 * of all places are more than the distance apart, so that a cube holds few of them. */

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
