/* Draws the inner springs of a soft body (soft-body thesis, sec. 6.3). Vertices are taken in
 * order and all numbers come from one generator, so a seed always gives the same network. */
#include "mesh/spring_network.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* The constants are those of SplitMix64: a Weyl sequence, then two rounds of mixing. */
uint64_t cs_rng_next(struct cs_rng *rng) {
    uint64_t z = rng->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Set of joined pairs of vertices: a hash table with open addressing. A key is the lower vertex
 * in the high 32 bits and the upper in the low; 0 is empty, since the pair (0, 0) cannot occur.
 * The number of slots is a power of two above twice the number of pairs. */
struct pairs {
    uint64_t *slots;
    uint64_t mask;
};

/* The slot of a pair, or the empty one where it belongs. Linear probing. */
static uint64_t *find_pair(const struct pairs *pairs, uint32_t a, uint32_t b) {
    const uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    struct cs_rng mix = {key};
    uint64_t at = cs_rng_next(&mix) & pairs->mask;
    while (pairs->slots[at] && pairs->slots[at] != key)
        at = (at + 1) & pairs->mask;
    return pairs->slots + at;
}

/* Adds a pair to the set. */
static void join(const struct pairs *pairs, uint32_t a, uint32_t b) {
    *find_pair(pairs, a, b) = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* State of one cs_spring_network_make. */
struct work {
    const struct cs_spring_network *network;
    struct cs_trimesh *mesh;
    struct pairs pairs;
    struct cs_rng rng;
    double *normals; /* (n, 3) unit */
};

/* Unit normals of vertices: the sum of their triangles' normals, weighted by area. */
static void fill_normals(struct work *work) {
    const struct cs_trimesh *mesh = work->mesh;
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double normal[3];
        cs_trimesh_normal(mesh, t, mesh->positions, mesh->n, 0, normal);
        for (size_t k = 0; k < 3; k++)
            for (size_t c = 0; c < 3; c++)
                work->normals[3 * (size_t)mesh->triangles[3 * (size_t)t + k] + c] += normal[c];
    }
    for (size_t i = 0; i < mesh->n; i++) {
        double *m = work->normals + 3 * i;
        const double inverse = 1 / sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + DBL_MIN);
        for (int c = 0; c < 3; c++)
            m[c] *= inverse;
    }
}

/* Returns true if vertex j may become a partner of i. */
static bool is_candidate(const struct work *work, uint32_t i, uint32_t j) {
    const double *m = work->normals + 3 * (size_t)i, *o = work->normals + 3 * (size_t)j;
    if (i == j || *find_pair(&work->pairs, i, j))
        return false;
    return work->network->placement == CS_PLACEMENT_RANDOM ||
           m[0] * o[0] + m[1] * o[1] + m[2] * o[2] <= -0.5;
}

/* A partner for vertex i, or i itself if no draw finds a candidate. */
static uint32_t draw_partner(struct work *work, uint32_t i) {
    const struct cs_spring_network *network = work->network;
    const int64_t wanted = network->placement == CS_PLACEMENT_NEAREST ? network->candidates : 1;
    uint32_t best = i;
    double nearest = HUGE_VAL;
    int64_t found = 0;
    for (int64_t t = 0; t < network->tries && found < wanted; t++) {
        /* scales 32 random bits to 0..n-1 without a division */
        const uint64_t drawn = cs_rng_next(&work->rng) >> 32;
        const uint32_t j = (uint32_t)(drawn * work->mesh->n >> 32);
        if (!is_candidate(work, i, j))
            continue;
        found++;
        const double squared = cs_trimesh_squared_distance(work->mesh, i, j);
        if (squared < nearest) {
            nearest = squared;
            best = j;
        }
    }
    return best;
}

/* Draws all springs; edges of the surface count as joined from the start. */
static void place(struct work *work) {
    struct cs_trimesh *mesh = work->mesh;
    fill_normals(work);
    for (uint32_t e = 0; e < mesh->n_edges; e++)
        join(&work->pairs, mesh->edges[2 * (size_t)e], mesh->edges[2 * (size_t)e + 1]);
    for (uint32_t i = 0; i < mesh->n; i++)
        for (int64_t s = 0; s < work->network->springs; s++) {
            const uint32_t j = draw_partner(work, i);
            if (j == i)
                continue;
            join(&work->pairs, i, j);
            mesh->network_springs[2 * (size_t)mesh->n_network_springs] = i;
            mesh->network_springs[2 * (size_t)mesh->n_network_springs + 1] = j;
            mesh->n_network_springs++;
        }
}

enum cs_status cs_spring_network_make(const struct cs_spring_network *network,
                                      struct cs_trimesh *mesh, struct cs_arena *arena,
                                      struct cs_error *error) {
    const uint64_t most = (uint64_t)mesh->n * (uint64_t)network->springs;
    struct work work = {.network = network, .mesh = mesh, .rng = {(uint64_t)network->seed}};
    for (work.pairs.mask = 1; work.pairs.mask < 2 * (most + mesh->n_edges);)
        work.pairs.mask = 2 * work.pairs.mask + 1;
    /* where addresses are short, a mask can be longer */
    if (work.pairs.mask < SIZE_MAX / sizeof *work.pairs.slots)
        work.pairs.slots = calloc((size_t)work.pairs.mask + 1, sizeof *work.pairs.slots);
    work.normals = calloc(mesh->n, 3 * sizeof *work.normals);
    mesh->n_network_springs = 0;
    if (work.pairs.slots)
        mesh->network_springs =
            cs_arena_alloc_array(arena, (size_t)most, 2 * sizeof *mesh->network_springs, error);
    if (!work.pairs.slots || !work.normals)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a network of %llu springs",
                (unsigned long long)most);
    if (!error->status)
        place(&work);
    free(work.pairs.slots);
    free(work.normals);
    return error->status;
}
