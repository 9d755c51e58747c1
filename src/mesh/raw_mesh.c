/* Frees a mesh of a file, and puts its faults into words. */
#include "mesh/raw_mesh.h"

#include <stdlib.h>

void cs_raw_mesh_finish(struct cs_raw_mesh *raw) {
    free(raw->positions);
    free(raw->uv);
    free(raw->triangles);
    free(raw->sources);
    *raw = (struct cs_raw_mesh){0};
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
    add_fault(mends->crossed, mends->crossed_line, "polygon that crosses itself",
              "polygons that cross themselves", "cut as a fan", out);
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
