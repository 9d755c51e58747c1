/* trimesh.h - triangle mesh of a body: its vertices become particles, its edges springs. */
#ifndef CS_TRIMESH_H
#define CS_TRIMESH_H

#include "base/arena.h"
#include "base/hash.h"

/* Generated meshes; each fits a cube of side 1 about the origin. */
enum cs_mesh_shape {
    CS_MESH_BOX,
    CS_MESH_SPHERE,
    CS_MESH_TORUS,
    CS_MESH_LIMBS, /* a rounded body with head, ears, arms and legs */
    CS_MESH_SHAPES
};
/* Largest `detail`: parts of an edge, of the tube's circle, or of the height. */
enum { CS_MESH_DETAIL_MAX = 256 };

/* Kinds of names of faces: `g`, `o` and `usemtl`. */
enum cs_label_kind { CS_LABEL_GROUP, CS_LABEL_OBJECT, CS_LABEL_MATERIAL, CS_LABEL_KINDS };

/* A name of faces: of a group several names, separated by blanks. */
struct cs_mesh_label {
    const char *names;
    enum cs_label_kind kind;
};

/* An indexed mesh and its topology; the arrays belong to the arena of its maker. Positions,
 * triangles and uv are set first; cs_trimesh_finish derives the rest from them. */

struct cs_trimesh {
    uint32_t n, n_triangles, n_edges, n_hinges, n_network_springs;
    double *positions;   /* (3,n) m, positions before the placement */
    uint32_t *triangles; /* (n_triangles, 3), counter-clockwise from outside */
    float *uv;           /* (n_triangles, 3, 2) texture coordinates of corners; NULL: none */

    /* made by cs_trimesh_finish */
    uint32_t *edges;  /* (n_edges, 2), first < second, sorted */
    uint32_t *hinges; /* (n_hinges, 2) vertices opposite an edge, sorted; no pair is an edge */
    uint32_t *vertex_triangles, /* (3 n_triangles) triangles of vertex 0, of vertex 1, ... */
        *vertex_triangles_end;  /* (n) end of each vertex's part of it */
    double *area;               /* (n) m2, a third of each triangle at the vertex */
    double edge;                /* m, mean length of an edge */
    uint32_t n_open;            /* edges of one triangle only; 0: the mesh is closed */

    /* of a file; NULL or 0: a shape, or nothing of the kind */
    const struct cs_mesh_label *labels;
    uint32_t (*triangle_labels)[CS_LABEL_KINDS]; /* (n_triangles) numbers from 1; 0: none */
    uint32_t n_labels;
    uint32_t n_file;       /* vertices in the file */
    uint32_t *file_vertex; /* (n) vertex of the file; NULL: the same */
    uint32_t pieces;       /* that edges and vertices hold together; 0: not counted */
    const char *mends;     /* what was mended: "3 doubled vertices welded"; "": nothing */
    char faces_hash[CS_HASH_DIGITS]; /* of the faces before mending; empty: of no file */

    uint32_t *network_springs; /* (n_network_springs, 2) inner springs (spring_network.h) */
    char file_hash[CS_HASH_DIGITS]; /* of the bytes of its file; empty: a shape */
    size_t bytes; /* of this struct and its arrays, set by the reader of the scene */
};

/* Allocates positions, triangles and, if asked for, uv, zeroed. Fails with CS_ERR_MEMORY. */
enum cs_status cs_trimesh_init(struct cs_trimesh *mesh, uint32_t n, uint32_t n_triangles,
                               bool uv, struct cs_arena *arena, struct cs_error *error);

/* Checks the mesh and derives its topology. Fails with CS_ERR_FILE for: a corner that does not
 * exist, a triangle without area, a vertex in no triangle, an edge of three triangles or more,
 * neighbours of opposite orientation. Afterwards the mesh is an oriented manifold with boundary
 * along its edges. name is the beginning of messages; lines (n_triangles), or NULL, holds the
 * line of the file of each triangle. Also fails with CS_ERR_MEMORY. */
enum cs_status cs_trimesh_finish(struct cs_trimesh *mesh, const char *name,
                                 const uint32_t *lines, struct cs_arena *arena,
                                 struct cs_error *error);

/* Makes positions and triangles of a shape; the caller finishes the mesh. CS_ERR_MEMORY. */
enum cs_status cs_trimesh_make(struct cs_trimesh *mesh, enum cs_mesh_shape shape,
                               uint32_t detail, struct cs_arena *arena, struct cs_error *error);
/* Makes CS_MESH_LIMBS: surface nets of a sum of blobs (trimesh_metaballs.c). */
enum cs_status cs_trimesh_make_metaballs(struct cs_trimesh *mesh, uint32_t detail,
                                         struct cs_arena *arena, struct cs_error *error);

/* Returns true if a name of the labels of a triangle, numbers from 1, is this one. */
bool cs_mesh_has_label(const struct cs_mesh_label *labels,
                       const uint32_t numbers[CS_LABEL_KINDS], const char *name);

/* Returns true if a triangle has an area above 0: twice the area is compared with 1e-9 of the
 * longest side squared, a ratio of height to length, which does not depend on the unit. NaN has
 * none. */
bool cs_triangle_has_area(const double a[3], const double b[3], const double c[3]);

/* Normal of triangle t at positions x (3,n) of n particles, of which the mesh's begin at
 * `first`. Its length is twice the area. Written component by component: as loops over the axes
 * it is vectorised badly, at several times the cost. */
static inline void cs_trimesh_normal(const struct cs_trimesh *mesh, uint32_t t, const double *x,
                                     size_t n, uint32_t first, double normal[3]) {
    const uint32_t *corner = mesh->triangles + 3 * (size_t)t;
    const double *p = x + first + corner[0], *q = x + first + corner[1],
                 *r = x + first + corner[2];
    const double ax = q[0] - p[0], ay = q[n] - p[n], az = q[2 * n] - p[2 * n];
    const double bx = r[0] - p[0], by = r[n] - p[n], bz = r[2 * n] - p[2 * n];
    normal[0] = ay * bz - az * by;
    normal[1] = az * bx - ax * bz;
    normal[2] = ax * by - ay * bx;
}

/* Squared distance of two vertices, in m2. */
static inline double cs_trimesh_squared_distance(const struct cs_trimesh *mesh, uint32_t a,
                                                 uint32_t b) {
    double sum = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = mesh->positions[c * mesh->n + b] - mesh->positions[c * mesh->n + a];
        sum += d * d;
    }
    return sum;
}

/* Index in vertex_triangles of the first triangle of vertex i. */
static inline uint32_t cs_trimesh_around_begin(const struct cs_trimesh *mesh, uint32_t i) {
    return i ? mesh->vertex_triangles_end[i - 1] : 0;
}

#endif
