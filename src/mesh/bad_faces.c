/* Removes faces without area and faces given twice, and turns the others alike. Of the former
 * each round treats what has no part in an earlier change of the round; a division may leave
 * another flat face, so that rounds are bounded. */
#include "mesh/raw_mesh.h"

#include <stdlib.h>
#include <string.h>

enum { ROUNDS_MAX = 8 };
/* Part of the longest side below which two vertices of a flat face are one. */
#define SAME 1e-6

struct work {
    struct cs_raw_mesh *raw;
    bool *is_flat, *is_changed; /* (n_triangles) */
    uint32_t *starts, *around; /* triangles of each vertex: (n_vertices + 1), (3 n_triangles) */
    uint32_t *becomes;         /* (n_vertices) the vertex in its stead */
};

static double squared_side(const struct cs_raw_mesh *raw, const struct cs_raw_triangle *t,
                           int k) {
    const double *a = raw->positions[t->corners[k].vertex],
                 *b = raw->positions[t->corners[(k + 1) % 3].vertex];
    double squared = 0;
    for (int c = 0; c < 3; c++)
        squared += (b[c] - a[c]) * (b[c] - a[c]);
    return squared;
}

/* Lists the triangles of each vertex by counting sort. */
static void list_around(struct work *work) {
    const struct cs_raw_mesh *raw = work->raw;
    memset(work->starts, 0, ((size_t)raw->n_vertices + 2) * sizeof *work->starts);
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        for (int k = 0; k < 3; k++)
            work->starts[raw->triangles[t].corners[k].vertex + 2]++;
    for (uint32_t i = 2; i < raw->n_vertices + 2; i++)
        work->starts[i] += work->starts[i - 1];
    /* entry i + 1 is the next free place of vertex i until all are listed, then its end */
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        for (int k = 0; k < 3; k++)
            work->around[work->starts[raw->triangles[t].corners[k].vertex + 1]++] = t;
}

/* The corner of triangle t from which its side goes from vertex a to b; -1: it has none. */
static int side_of(const struct cs_raw_mesh *raw, uint32_t t, uint32_t a, uint32_t b) {
    const struct cs_raw_corner *c = raw->triangles[t].corners;
    for (int k = 0; k < 3; k++)
        if (c[k].vertex == a && c[(k + 1) % 3].vertex == b)
            return k;
    return -1;
}

/* Divides the neighbour across side k of flat triangle t at the third vertex. Returns false if
 * there is no neighbour that is as it was. */
static bool divide(struct work *work, uint32_t t, int k) {
    struct cs_raw_triangle *flat = work->raw->triangles + t;
    const struct cs_raw_corner middle = flat->corners[(k + 2) % 3];
    const uint32_t a = flat->corners[(k + 1) % 3].vertex, b = flat->corners[k].vertex;
    for (uint32_t i = work->starts[a]; i < work->starts[a + 1]; i++) {
        const uint32_t other = work->around[i];
        const int side = side_of(work->raw, other, a, b);
        if (side < 0 || work->is_flat[other] || work->is_changed[other])
            continue;
        struct cs_raw_triangle *whole = work->raw->triangles + other;
        *flat = *whole;
        whole->corners[(side + 1) % 3] = middle;
        flat->corners[side] = middle;
        work->is_changed[other] = work->is_changed[t] = true;
        work->is_flat[t] = false;
        return true;
    }
    return false;
}

/* Treats one flat triangle; returns true if something has changed. */
static bool treat(struct work *work, uint32_t t) {
    const struct cs_raw_triangle *flat = work->raw->triangles + t;
    double squared[3];
    int longest = 0, shortest = 0;
    for (int k = 0; k < 3; k++) {
        squared[k] = squared_side(work->raw, flat, k);
        longest = squared[k] > squared[longest] ? k : longest;
        shortest = squared[k] < squared[shortest] ? k : shortest;
    }
    const uint32_t a = cs_root_of(work->becomes, flat->corners[shortest].vertex),
                   b = cs_root_of(work->becomes, flat->corners[(shortest + 1) % 3].vertex);
    if (squared[shortest] > SAME * SAME * squared[longest])
        return divide(work, t, longest);
    work->becomes[a > b ? a : b] = a < b ? a : b;
    return a != b;
}

/* Marks flat triangles; returns their number. */
static uint32_t mark(struct work *work) {
    const struct cs_raw_mesh *raw = work->raw;
    uint32_t n = 0;
    for (uint32_t t = 0; t < raw->n_triangles; t++) {
        const struct cs_raw_corner *c = raw->triangles[t].corners;
        work->is_changed[t] = false;
        work->is_flat[t] =
            !cs_triangle_has_area(raw->positions[c[0].vertex], raw->positions[c[1].vertex],
                                  raw->positions[c[2].vertex]);
        n += work->is_flat[t];
    }
    return n;
}

/* One round; returns true if something has changed. */
static bool treat_all(struct work *work) {
    struct cs_raw_mesh *raw = work->raw;
    bool changed = false;
    list_around(work);
    for (uint32_t i = 0; i < raw->n_vertices; i++)
        work->becomes[i] = i;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        changed = (work->is_flat[t] && treat(work, t)) || changed;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t *vertex = &raw->triangles[t].corners[k].vertex;
            *vertex = cs_root_of(work->becomes, *vertex);
        }
    return changed;
}

/* Leaves out the triangles that `leaves` marks. */
static void leave_out(struct cs_raw_mesh *raw, const bool *leaves) {
    uint32_t n = 0;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        if (!leaves[t])
            raw->triangles[n++] = raw->triangles[t];
    raw->n_triangles = n;
}

/* Counts flat faces, removes them round by round, and leaves out what stays flat. */
static void remove_all(struct work *work, struct cs_mesh_mends *mends) {
    struct cs_raw_mesh *raw = work->raw;
    if (!mark(work))
        return;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        if (work->is_flat[t])
            cs_mesh_fault_count(&mends->flat, &mends->flat_line, raw->triangles[t].line);
    for (int round = 0; round < ROUNDS_MAX && treat_all(work) && mark(work);)
        round++;
    leave_out(raw, work->is_flat);
}

enum cs_status cs_flat_faces_remove(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                    struct cs_error *error) {
    const size_t n = raw->n_vertices, triangles = raw->n_triangles;
    struct cs_arena arena = {0};
    struct work work = {.raw = raw};
    CS_ARENA_ARRAY(&arena, work.is_flat, triangles, error);
    CS_ARENA_ARRAY(&arena, work.is_changed, triangles, error);
    CS_ARENA_ARRAY(&arena, work.starts, n + 2, error);
    CS_ARENA_ARRAY(&arena, work.around, 3 * triangles, error);
    CS_ARENA_ARRAY(&arena, work.becomes, n, error);
    if (!error->status)
        remove_all(&work, mends);
    cs_arena_finish(&arena);
    return error->status;
}

/* --- repeated faces --- */

/* The vertices of a triangle in ascending order, and the triangle; `odd`: a swap of two of them
 * leads from its corners to that order. */
struct key {
    uint32_t vertex[3], triangle;
    bool odd;
};

static int by_key(const void *left, const void *right) {
    const struct key *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->vertex[k] != b->vertex[k])
            return a->vertex[k] < b->vertex[k] ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static struct key key_of(const struct cs_raw_mesh *raw, uint32_t t) {
    const struct cs_raw_corner *corners = raw->triangles[t].corners;
    const uint32_t a = corners[0].vertex, b = corners[1].vertex, c = corners[2].vertex;
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    const uint32_t least = c < low ? c : low, most = c > high ? c : high;
    /* the third number is what the others leave; each inverted pair is a swap */
    return (struct key){
        {least, a ^ b ^ c ^ least ^ most, most}, t, (a > b) != ((b > c) != (a > c))};
}

/* Returns true if an edge has faces of the same vertices alone, as the border of a sheet whose
 * two sides are both there. Walls between solids end at other faces. */
static bool has_two_sides(const struct cs_raw_mesh *raw, const uint32_t *firsts,
                          struct cs_raw_side *sides) {
    const uint32_t n = 3 * raw->n_triangles;
    cs_raw_sides_list(raw, NULL, sides);
    for (uint32_t s = 0, run, alike; s < n; s += run) {
        run = cs_raw_side_run(sides + s, n - s, true);
        for (alike = 1;
             alike < run && firsts[sides[s + alike].triangle] == firsts[sides[s].triangle];)
            alike++;
        if (run > 1 && alike == run)
            return true;
    }
    return false;
}

/* Marks faces with the vertices of an earlier one: those of its direction; of the opposite one
 * if they are the other side of a sheet, as all are where no face stands alone. */
static void mark_repeated(const struct cs_raw_mesh *raw, struct key *keys, uint32_t *firsts,
                          struct cs_raw_side *sides, bool *leaves) {
    const uint32_t n = raw->n_triangles;
    uint32_t alone = 0;
    for (uint32_t t = 0; t < n; t++)
        keys[t] = key_of(raw, t);
    /* faces of the same vertices become neighbours, the earliest of them first */
    qsort(keys, n, sizeof *keys, by_key);
    for (uint32_t k = 0, run; k < n; k += run, alone += run == 1)
        for (run = 0;
             k + run < n && !memcmp(keys[k].vertex, keys[k + run].vertex, sizeof keys->vertex);
             run++)
            firsts[keys[k + run].triangle] = keys[k].triangle;
    const bool two_sided = n > alone && (!alone || has_two_sides(raw, firsts, sides));
    bool seen[2] = {false, false};
    for (uint32_t k = 0; k < n; k++) {
        const bool odd = keys[k].odd, is_first = firsts[keys[k].triangle] == keys[k].triangle;
        seen[!odd] = seen[!odd] && !is_first;
        leaves[keys[k].triangle] = !is_first && (seen[odd] || two_sided);
        seen[odd] = true;
    }
}

enum cs_status cs_repeated_faces_remove(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                        struct cs_error *error) {
    struct cs_arena arena = {0};
    struct key *keys;
    struct cs_raw_side *sides;
    uint32_t *firsts;
    bool *leaves;
    CS_ARENA_ARRAY(&arena, keys, raw->n_triangles, error);
    CS_ARENA_ARRAY(&arena, firsts, raw->n_triangles, error);
    CS_ARENA_ARRAY(&arena, sides, 3 * (size_t)raw->n_triangles, error);
    CS_ARENA_ARRAY(&arena, leaves, raw->n_triangles, error);
    if (!error->status) {
        mark_repeated(raw, keys, firsts, sides, leaves);
        /* in the order of the file, whose first fault is told */
        for (uint32_t t = 0; t < raw->n_triangles; t++)
            if (leaves[t])
                cs_mesh_fault_count(&mends->twice, &mends->twice_line, raw->triangles[t].line);
        leave_out(raw, leaves);
    }
    cs_arena_finish(&arena);
    return error->status;
}

/* --- orientation --- */

/* Pieces as a union-find structure; `turned`: against the parent, and of a root false. */
struct pieces {
    struct cs_raw_side *sides;
    uint32_t *parents, *counts; /* counts (2 n): of a root, triangles like it, and turned */
    bool *turned, *one_sided;
};

/* The root of a triangle; *turned: the triangle against it. Shortens the path to one step. */
static uint32_t piece_of(struct pieces *of, uint32_t t, bool *turned) {
    uint32_t root = t;
    bool whole = false;
    for (; of->parents[root] != root; root = of->parents[root])
        whole = whole != of->turned[root];
    *turned = whole;
    while (of->parents[t] != t) {
        const uint32_t next = of->parents[t];
        const bool rest = whole != of->turned[t];
        of->parents[t] = root;
        of->turned[t] = whole;
        whole = rest;
        t = next;
    }
    return root;
}

/* Joins the pieces of two neighbours; `turned`: they have opposite orientations. */
static void join_pieces(struct pieces *of, uint32_t a, uint32_t b, bool turned) {
    bool turned_a, turned_b;
    a = piece_of(of, a, &turned_a);
    b = piece_of(of, b, &turned_b);
    const bool between = (turned_a != turned_b) != turned;
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    of->one_sided[low] = of->one_sided[low] || of->one_sided[high] || (a == b && between);
    of->parents[high] = low;
    of->turned[high] = a != b && between;
}

/* Lists the sides, and joins neighbours over edges of two triangles. */
static void find_pieces(const struct cs_raw_mesh *raw, struct pieces *of) {
    const uint32_t n = 3 * raw->n_triangles;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        of->parents[t] = t;
    cs_raw_sides_list(raw, NULL, of->sides);
    for (uint32_t s = 0, run; s < n; s += run) {
        const struct cs_raw_side *side = of->sides + s;
        run = cs_raw_side_run(side, n - s, true);
        if (run == 2)
            join_pieces(of, side[0].triangle, side[1].triangle, side[0].falls == side[1].falls);
    }
}

/* Turns the fewer triangles of each piece. */
static void turn_faces(struct cs_raw_mesh *raw, struct pieces *of,
                       struct cs_mesh_mends *mends) {
    bool turned;
    for (uint32_t t = 0; t < raw->n_triangles; t++) {
        const uint32_t root = piece_of(of, t, &turned);
        of->counts[2 * (size_t)root + turned]++;
    }
    for (uint32_t t = 0; t < raw->n_triangles; t++) {
        const uint32_t root = piece_of(of, t, &turned);
        const uint32_t *counts = of->counts + 2 * (size_t)root;
        if (of->one_sided[root] || turned == (counts[1] > counts[0]))
            continue;
        struct cs_raw_corner *corners = raw->triangles[t].corners, second = corners[1];
        corners[1] = corners[2];
        corners[2] = second;
        cs_mesh_fault_count(&mends->turned, &mends->turned_line, raw->triangles[t].line);
    }
}

enum cs_status cs_faces_turn_alike(struct cs_raw_mesh *raw, struct cs_mesh_mends *mends,
                                   struct cs_error *error) {
    const size_t n = raw->n_triangles;
    struct cs_arena arena = {0};
    struct pieces pieces;
    CS_ARENA_ARRAY(&arena, pieces.sides, 3 * n, error);
    CS_ARENA_ARRAY(&arena, pieces.parents, n, error);
    CS_ARENA_ARRAY(&arena, pieces.counts, 2 * n, error);
    CS_ARENA_ARRAY(&arena, pieces.turned, n, error);
    CS_ARENA_ARRAY(&arena, pieces.one_sided, n, error);
    if (!error->status) {
        find_pieces(raw, &pieces);
        turn_faces(raw, &pieces, mends);
    }
    cs_arena_finish(&arena);
    return error->status;
}
