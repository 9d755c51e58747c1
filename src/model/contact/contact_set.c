/* Contacts in chunks, and their gathering by particles. */
#include "model/contact/contact_set.h"

#include "base/pool.h"
#include "base/vec3.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Matrix of contacts: diagonal blocks, products with vectors, and bounds.
 *
 * A contact has the matrix A = (w w^T) x B by its n <= 4 points, and its product is evaluated
 * without forming A: (A p)_k = w_k B (sum w_j p_j).
 *
 * The solver applies the diagonal blocks A_kk itself, and cs_contact_set_multiply leaves them
 * out of each row. Products are computed contact by contact, stored, and then gathered by
 * particles in a second pass: no two threads write the same number. */

/* Factor by which the block of point k grows, so that the blocks bound the matrix of the
 * contact: sum |w_j| / |w_k| (proof: find_growth of pair_lanes.c). */
static double growth_of(const struct cs_contact_entry *pair,
                        const struct cs_contact_matrix_part *part, uint32_t k) {
    double sum = 0;
    for (uint32_t j = 0; j < pair->n; j++)
        sum += fabs(part->weights[j]);
    return part->weights[k] != 0 ? sum / fabs(part->weights[k]) : 1;
}

/* index of a contact in its chunk */
static size_t number_of(const struct cs_contact_set *set, const struct cs_contact_vertex *end) {
    return (size_t)(end->pair - set->chunks[end->chunk].pairs);
}

/* Each particle sums the blocks of its own vertices, in the order of its list. */
void cs_contact_set_add_blocks(const struct cs_contact_set *set, size_t begin, size_t end,
                               double *blocks) {
    const size_t n = set->n_particles;
    for (size_t i = begin; i < end && set->n; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++) {
            const struct cs_contact_vertex *at = set->particle_vertices + e;
            const struct cs_contact_matrix_part *part =
                set->chunks[at->chunk].parts + number_of(set, at);
            const double w = part->weights[at->vertex];
            const double factor =
                set->diagonal_bound ? growth_of(at->pair, part, at->vertex) : 1;
            const double rub = factor * w * w;
            for (size_t c = 0; c < 6; c++)
                blocks[c * n + i] += rub * part->block[c];
        }
}

/* --- the matrix times a vector --- */

/* One product: y += (A - diagonal) p. */
struct product {
    const struct cs_contact_set *set;
    const double *p;
    double *y;
};

/* Stores the product of one contact without its diagonal: w_k B (sum w_j p_j - w_k p_k). */
static void multiply_contact(const struct cs_contact_entry *pair,
                             struct cs_contact_matrix_part *part, double p[4][3]) {
    double all[3] = {0};
    for (uint32_t k = 0; k < pair->n; k++)
        for (int c = 0; c < 3; c++)
            all[c] += part->weights[k] * p[k][c];
    for (uint32_t k = 0; k < pair->n; k++) {
        double others[3];
        for (int c = 0; c < 3; c++)
            others[c] = part->weights[k] * (all[c] - part->weights[k] * p[k][c]);
        cs_sym3_multiply(part->block, others, part->product[k]);
    }
}

/* Products of all contacts of a chunk; points of colliders have p = 0. */
static void multiply_chunk(void *arg, uint32_t number) {
    const struct product *product = arg;
    const struct cs_contact_set *set = product->set;
    const struct cs_contact_chunk *chunk = set->chunks + number;
    const size_t n = set->n_particles;
    for (size_t l = 0; l < chunk->n; l++) {
        const struct cs_contact_entry *pair = chunk->pairs + l;
        double p[4][3];
        for (uint32_t k = 0; k < pair->n; k++)
            for (size_t c = 0; c < 3; c++)
                p[k][c] = cs_contact_set_has(set, pair->particles[k])
                              ? product->p[c * n + pair->particles[k]]
                              : 0;
        multiply_contact(pair, chunk->parts + l, p);
    }
}

/* Gathers the products of the particles [begin, end). */
static void add_products(void *arg, size_t begin, size_t end) {
    const struct product *product = arg;
    const struct cs_contact_set *set = product->set;
    const size_t n = set->n_particles;
    for (size_t i = begin; i < end; i++)
        for (uint32_t e = set->starts[i]; e < set->starts[i + 1]; e++) {
            const struct cs_contact_vertex *at = set->particle_vertices + e;
            const struct cs_contact_matrix_part *part =
                set->chunks[at->chunk].parts + number_of(set, at);
            for (size_t c = 0; c < 3; c++)
                product->y[c * n + i] += part->product[at->vertex][c];
        }
}

/* First all contacts, then all particles: the second pass reads what the first has stored. */
void cs_contact_set_multiply(const struct cs_contact_set *set, const double *p, double *y) {
    struct product product = {set, p, y};
    if (!set->n)
        return;
    cs_pool_run(set->n_chunks, multiply_chunk, &product);
    cs_vector_parallel_for(set->n_particles, add_products, &product);
}

void cs_contact_set_add_bound(const struct cs_contact_set *set, double *stiffness,
                              double *damping) {
    for (uint32_t l = 0; l < set->n_chunks; l++)
        for (size_t p = 0; p < set->chunks[l].n; p++) {
            const struct cs_contact_entry *pair = set->chunks[l].pairs + p;
            const struct cs_contact_matrix_part *part = set->chunks[l].parts + p;
            for (uint32_t k = 0; k < pair->n; k++) {
                if (!cs_contact_set_has(set, pair->particles[k]))
                    continue;
                stiffness[pair->particles[k]] += part->block[k];
                damping[pair->particles[k]] += part->weights[k];
            }
        }
}

/* Frees the arrays that grow; the arena calls it. */
static void finish_contacts(void *object) {
    struct cs_contact_set *set = object;
    for (uint32_t l = 0; l < set->n_chunks; l++)
        free(set->chunks[l].pairs), free(set->chunks[l].parts);
    free(set->vertices);
    free(set->particle_vertices);
}

enum cs_status cs_contact_set_init(struct cs_contact_set *set, uint32_t n_particles,
                                   uint32_t n_chunks, struct cs_arena *arena,
                                   struct cs_error *error) {
    *set = (struct cs_contact_set){.n_chunks = n_chunks, .n_particles = n_particles};
    set->chunks = cs_arena_alloc_array(arena, n_chunks, sizeof *set->chunks, error);
    CS_ARENA_ARRAY(arena, set->starts, n_particles + (size_t)2, error);
    if (!error->status)
        cs_arena_adopt(arena, finish_contacts, set, error);
    return error->status;
}

void cs_contact_chunk_clear(struct cs_contact_chunk *chunk) {
    chunk->n = 0;
    chunk->energy = 0;
    chunk->failed = false;
}

/* Capacity grows in steps (cs_arena_realloc); entries that were appended before are kept. */
struct cs_contact_entry *cs_contact_chunk_next(struct cs_contact_chunk *chunk) {
    const bool there = CS_ARENA_REALLOC(chunk->pairs, chunk->capacity, chunk->n + 1);
    chunk->failed = chunk->failed || !there;
    return there ? chunk->pairs + chunk->n++ : NULL;
}

struct cs_contact_matrix_part *cs_contact_chunk_part(struct cs_contact_chunk *chunk) {
    const bool there = CS_ARENA_REALLOC(chunk->parts, chunk->parts_capacity, chunk->n);
    chunk->failed = chunk->failed || !there;
    return there ? chunk->parts + chunk->n - 1 : NULL;
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

/* Counting sort by particle. Counts go two places on: filling then moves every start[i + 1]
 * from the begin of list i to its end, which is where the format wants it. */
void cs_contact_set_gather(struct cs_contact_set *set) {
    if (!CS_ARENA_REALLOC(set->particle_vertices, set->particle_vertices_capacity,
                          4 * set->n) ||
        !CS_ARENA_REALLOC(set->vertices, set->vertices_capacity, 4 * set->n)) {
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
