/* Contacts in chunks, and their gathering by particles. */
#include "model/contact/contact_set.h"

#include "base/pool.h"

#include <stdlib.h>
#include <string.h>

/* Frees the arrays that grow; the arena calls it. */
static void finish(void *object) {
    struct cs_contact_set *set = object;
    for (uint32_t l = 0; l < set->n_chunks; l++)
        free(set->chunks[l].pairs), free(set->chunks[l].parts), free(set->chunks[l].hessians);
    free(set->vertices);
    free(set->particle_vertices);
}

enum cs_status cs_contact_set_init(struct cs_contact_set *set, uint32_t n_particles,
                                   uint32_t n_chunks, struct cs_arena *arena,
                                   struct cs_error *error) {
    *set = (struct cs_contact_set){.n_chunks = n_chunks, .n_particles = n_particles};
    set->chunks = cs_arena_alloc_array(arena, n_chunks, sizeof *set->chunks, error);
    set->starts =
        cs_arena_alloc_array(arena, n_particles + (size_t)2, sizeof *set->starts, error);
    if (!error->status)
        cs_arena_adopt(arena, finish, set, error);
    return error->status;
}

void cs_contact_chunk_clear(struct cs_contact_chunk *chunk) {
    chunk->n = 0;
    chunk->energy = 0;
    chunk->failed = false;
}

/* Capacity grows in steps (cs_arena_realloc); entries that were appended before are kept. */
struct cs_contact_entry *cs_contact_chunk_next(struct cs_contact_chunk *chunk) {
    struct cs_contact_entry *pairs =
        cs_arena_realloc(chunk->pairs, &chunk->capacity, chunk->n + 1, sizeof *pairs);
    chunk->failed = chunk->failed || !pairs;
    chunk->pairs = pairs ? pairs : chunk->pairs;
    return pairs ? pairs + chunk->n++ : NULL;
}

struct cs_contact_matrix_part *cs_contact_chunk_part(struct cs_contact_chunk *chunk) {
    struct cs_contact_matrix_part *parts =
        cs_arena_realloc(chunk->parts, &chunk->parts_capacity, chunk->n, sizeof *parts);
    chunk->failed = chunk->failed || !parts;
    chunk->parts = parts ? parts : chunk->parts;
    return parts ? parts + chunk->n - 1 : NULL;
}

/* --- by particles --- */

void cs_contact_set_count(struct cs_contact_set *set) {
    set->n = 0;
    for (uint32_t l = 0; l < set->n_chunks; l++) {
        set->chunks[l].pair_offset = set->n;
        set->n += set->chunks[l].n;
        set->failed = set->failed || set->chunks[l].failed;
    }
    // Later passes must not read contacts that were never appended.
    if (set->failed)
        set->n = 0;
}

/* Copies the points of a chunk's contacts into one dense array, which the serial passes
 * count_ends and put_ends then read without gaps. */
static void copy_corners(void *arg, uint32_t number) {
    const struct cs_contact_set *set = arg;
    const struct cs_contact_chunk *chunk = set->chunks + number;
    uint32_t *corners = set->vertices + 4 * chunk->pair_offset;
    for (size_t p = 0; p < chunk->n; p++)
        for (uint32_t k = 0; k < 4; k++)
            corners[4 * p + k] =
                k < chunk->pairs[p].n ? chunk->pairs[p].particles[k] : UINT32_MAX;
}

/* Counts the vertices of each particle, serially over the dense copy. */
static void count_ends(struct cs_contact_set *set) {
    for (size_t e = 0; e < 4 * set->n; e++)
        if (cs_contact_set_has(set, set->vertices[e]))
            set->starts[set->vertices[e] + 1]++;
}

/* Fills the lists in the order of chunks, contacts and vertices, which is the order of sums. */
static void put_ends(struct cs_contact_set *set) {
    for (uint32_t l = 0; l < set->n_chunks; l++) {
        const struct cs_contact_chunk *chunk = set->chunks + l;
        const uint32_t *corners = set->vertices + 4 * chunk->pair_offset;
        for (size_t e = 0; e < 4 * chunk->n; e++)
            if (cs_contact_set_has(set, corners[e]))
                set->particle_vertices[set->starts[corners[e] + 1]++] =
                    (struct cs_contact_vertex){chunk->pairs + e / 4, (uint32_t)(e % 4), l};
    }
}

/* Reserves the lists; returns false if out of memory. */
static bool take_ends(struct cs_contact_set *set) {
    struct cs_contact_vertex *ends = cs_arena_realloc(
        set->particle_vertices, &set->particle_vertices_capacity, 4 * set->n, sizeof *ends);
    set->particle_vertices = ends ? ends : set->particle_vertices;
    uint32_t *corners =
        cs_arena_realloc(set->vertices, &set->vertices_capacity, 4 * set->n, sizeof *corners);
    set->vertices = corners ? corners : set->vertices;
    return ends && corners;
}

/* Counting sort by particle. Counts go two places on: filling then moves every start[i + 1]
 * from the begin of list i to its end, which is where the format wants it. */
void cs_contact_set_gather(struct cs_contact_set *set) {
    if (set->n && !take_ends(set)) {
        set->failed = true;
        set->n = 0;
    }
    if (!set->n)
        return;
    cs_pool_run(set->n_chunks, copy_corners, set);
    memset(set->starts, 0, (set->n_particles + (size_t)2) * sizeof *set->starts);
    set->starts++;
    count_ends(set);
    for (uint32_t i = 0; i < set->n_particles; i++)
        set->starts[i + 1] += set->starts[i];
    set->starts--;
    put_ends(set);
}

/* Sums in the order of chunks, so that the bits do not depend on threads. */
double cs_contact_set_energy(const struct cs_contact_set *set) {
    double sum = 0;
    for (uint32_t l = 0; l < set->n_chunks; l++)
        sum += set->chunks[l].energy;
    return sum;
}

/* Each particle sums its own list; blocks of particles may run in different threads. */
void cs_contact_set_add(const struct cs_contact_set *set, size_t begin, size_t end, double *f) {
    const size_t n = set->n_particles;
    for (size_t i = begin; i < end && set->n; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++)
            for (size_t c = 0; c < 3; c++)
                f[c * n + i] += set->particle_vertices[e]
                                    .pair->vectors[set->particle_vertices[e].vertex][c];
}
