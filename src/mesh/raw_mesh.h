/* raw_mesh.h - a mesh as a file has it, and the faults that were found in it. */
#ifndef CS_RAW_MESH_H
#define CS_RAW_MESH_H

#include "base/text.h"
#include "mesh/trimesh.h"

/* A corner of a triangle. */
struct cs_raw_corner {
    uint32_t vertex, uv; /* uv: number of its texture coordinate from 1; 0: none */
};

/* A triangle with the line of its face in the file. */
struct cs_raw_triangle {
    struct cs_raw_corner corners[3];
    uint32_t line;
    uint32_t labels[CS_LABEL_KINDS]; /* numbers from 1; 0: none */
};

/* Faults of a mesh, each with what was done; zeroed: none. `line` is that of the first. */
struct cs_mesh_mends {
    uint32_t flat, flat_line;       /* faces without area, left out or divided by a neighbour */
    uint32_t twice, twice_line;     /* faces with the vertices of an earlier one, left out */
    uint32_t turned, turned_line;   /* faces against their neighbours, turned round */
    uint32_t crossed, crossed_line; /* polygons that cross themselves, cut as fans */
    uint32_t cut, cut_line;         /* edges of three triangles or more, cut */
    uint32_t welded;                /* vertices that became one with another */
    uint32_t loose;                 /* vertices of no face, left out */
    uint32_t pieces;                /* of the mended mesh; no fault */
};

/* A mesh being read; the arrays are malloc'd. Zeroed: empty. */
struct cs_raw_mesh {
    double (*positions)[3]; /* (n_vertices) */
    double (*uv)[2];        /* (n_uv) from the bottom, as in the file */
    struct cs_raw_triangle *triangles;
    uint32_t *sources; /* (n_vertices) vertex of the file; NULL: as they are */
    uint32_t n_vertices, n_uv, n_triangles;
};

/* A directed side of a triangle. `place` are its ends as points in space, `vertex` as vertices
 * of the file; 0: the one with the lower place. */
struct cs_raw_side {
    uint32_t place[2], vertex[2], triangle, k; /* from corner k to corner k + 1 */
    bool falls;                                /* directed from end 1 to end 0 */
    bool paired;
    double angle; /* about the edge, in no unit (mesh_mend.c) */
};

/* Lists the sides of all triangles (3 n), sorted by place, then by vertices, then by triangle.
 * places: of each vertex the number of its point; NULL: its own. */
void cs_raw_sides_list(const struct cs_raw_mesh *raw, const uint32_t *places,
                       struct cs_raw_side *sides);

/* Number of the n >= 1 sides that have the place of the first, or also its vertices. */
uint32_t cs_raw_side_run(const struct cs_raw_side *sides, uint32_t n, bool by_vertex);

/* Counts a fault in *n, and keeps the line of the first. */
void cs_mesh_fault_count(uint32_t *n, uint32_t *first, uint32_t line);

void cs_raw_mesh_finish(struct cs_raw_mesh *raw);

/* Adds the faults, separated by commas; nothing if there are none. */
void cs_mesh_mends_print(const struct cs_mesh_mends *mends, struct cs_text *out);

/* --- vertices in one place --- */

/* Sets places[i] of each vertex that `among` marks to the first marked vertex within the given
 * fraction of the diagonal of the box of all n positions, of those that are the first in their
 * own place; other entries stay. Returns the number of vertices that are not the first.
 * CS_ERR_MEMORY in *error. */
uint32_t cs_near_vertices_find(const double (*positions)[3], uint32_t n, const bool *among,
                               double fraction, uint32_t *places, struct cs_error *error);

/* The set that a node is in, named by the node that stands for it; halves the path. */
static inline uint32_t cs_root_of(uint32_t *parents, uint32_t node) {
    while (parents[node] != node)
        node = parents[node] = parents[parents[node]];
    return node;
}

/* --- faces: bad_faces.c --- */

/* Removes the faces without area, and counts them. A vertex within 1e-6 of its longest side of
 * another one of the face becomes that one. Otherwise its middle vertex divides the neighbour
 * across its longest side; where there is none, the face is left out. CS_ERR_MEMORY. */
enum cs_status cs_flat_faces_remove(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                    struct cs_error *error);

/* Removes each face with the vertices of an earlier one, and counts them. The wall between two
 * solids, where each has a face of its own, is left to them. CS_ERR_MEMORY. */
enum cs_status cs_repeated_faces_remove(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                        struct cs_error *error);

/* Turns faces until neighbours over an edge of two triangles have one orientation, and counts
 * them: of each piece those that are fewer, of as many the later ones. A piece that has but one
 * side stays as it is. CS_ERR_MEMORY. */
enum cs_status cs_faces_turn_alike(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                   struct cs_error *error);

#endif
