/* Frees a mesh of a file, lists its sides, and puts its faults into words. */
#include "mesh/raw_mesh.h"

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
