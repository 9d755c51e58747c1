/* Contacts in chunks, and sums over them by particles.
 *
 * A contact has the matrix A = (w w^T) x B by its n <= 4 points, and its product is evaluated
 * without forming A: (A p)_k = w_k B (sum w_j p_j). The solver applies the diagonal blocks A_kk
 * itself, and cs_contact_set_multiply leaves them out of each row. */
#include "model/contact/contact_set.h"

#include "base/pool.h"
#include "base/vec3.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Frees the arrays that grow; the arena calls it. */
static void finish_contacts(void *object) {
    struct cs_contact_set *set = object;
    for (uint32_t l = 0; l < set->gather.n_chunks; l++)
        free(set->chunks[l].contacts);
}

enum cs_status cs_contact_set_init(struct cs_contact_set *set, uint32_t n_particles,
                                   uint32_t n_chunks, struct cs_arena *arena,
                                   struct cs_error *error) {
    *set = (struct cs_contact_set){0};
    CS_ARENA_ARRAY(arena, set->chunks, n_chunks, error);
    if (!error->status && !cs_gather_init(&set->gather, n_chunks, n_particles, arena, error))
        cs_arena_adopt(arena, finish_contacts, set, error);
    return error->status;
}

void cs_contact_set_clear(struct cs_contact_set *set, uint32_t chunk) {
    cs_gather_clear(set->gather.chunks + chunk);
    set->chunks[chunk].n = 0;
    set->chunks[chunk].energy = 0;
}

struct cs_contact *cs_contact_set_append(struct cs_contact_set *set, uint32_t chunk, uint32_t n,
                                         const uint32_t *points, const double *weights) {
    struct cs_contact_chunk *to = set->chunks + chunk;
    struct cs_gather_chunk *rows = set->gather.chunks + chunk;
    const uint32_t row = rows->n;
    // a point of two contacts has two rows
    for (uint32_t k = 0; k < n; k++)
        cs_gather_append(rows, points[k]);
    if (rows->failed || !CS_ARENA_REALLOC(to->contacts, to->capacity, to->n + 1)) {
        rows->failed = true;
        return NULL;
    }
    struct cs_contact *contact = to->contacts + to->n++;
    *contact = (struct cs_contact){.n = n, .row = row, .factor = 1};
    memcpy(contact->weights, weights, n * sizeof *weights);
    return contact;
}

void cs_contact_set_gather(struct cs_contact_set *set) {
    set->n = 0;
    for (uint32_t l = 0; l < set->gather.n_chunks; l++)
        set->n += set->chunks[l].n;
    set->failed = set->failed || !cs_gather_set(&set->gather);
    // later passes must not read contacts that were never appended
    if (set->failed)
        set->n = set->gather.n_rows = 0;
}

/* Sums in the order of chunks, so that the bits do not depend on threads. */
double cs_contact_set_energy(const struct cs_contact_set *set) {
    double sum = 0;
    for (uint32_t l = 0; l < set->gather.n_chunks; l++)
        sum += set->chunks[l].energy;
    return sum;
}

void cs_contact_set_write_vectors(struct cs_contact_set *set) {
    for (uint32_t l = 0; l < set->gather.n_chunks && set->n; l++) {
        double *row = cs_gather_of(set->gather.chunks + l, set->gather.row_sums, 3);
        for (size_t p = 0; p < set->chunks[l].n; p++) {
            const struct cs_contact *contact = set->chunks[l].contacts + p;
            for (uint32_t k = 0; k < contact->n; k++, row += 3)
                for (int c = 0; c < 3; c++)
                    row[c] = contact->weights[k] * contact->factor * contact->vector[c];
        }
    }
}

/* Factor by which the block of point k grows, so that the blocks bound the matrix of the
 * contact: sum |w_j| / |w_k| (proof: find_growth of pair_lanes.c). */
static double growth_of(const struct cs_contact *contact, uint32_t k) {
    double sum = 0;
    for (uint32_t j = 0; j < contact->n; j++)
        sum += fabs(contact->weights[j]);
    return contact->weights[k] != 0 ? sum / fabs(contact->weights[k]) : 1;
}

/* Into the six columns of what the gather has read, which no product uses. */
void cs_contact_set_write_blocks(struct cs_contact_set *set) {
    if (!cs_gather_reserve(&set->gather, 6)) {
        set->failed = true;
        set->n = set->gather.n_rows = 0;
    }
    for (uint32_t l = 0; l < set->gather.n_chunks && set->n; l++) {
        // rows follow each other as the contacts and their points do
        double *row = cs_gather_of(set->gather.chunks + l, set->gather.gathered, 6);
        for (size_t p = 0; p < set->chunks[l].n; p++) {
            const struct cs_contact *contact = set->chunks[l].contacts + p;
            for (uint32_t k = 0; k < contact->n; k++, row += 6) {
                const double w = contact->weights[k];
                const double rub = (set->diagonal_bound ? growth_of(contact, k) : 1) * w * w;
                for (int e = 0; e < 6; e++)
                    row[e] = rub * contact->block[e];
            }
        }
    }
}

void cs_contact_set_add(const struct cs_contact_set *set, size_t begin, size_t end, double *f) {
    cs_gather_add(&set->gather, set->gather.row_sums, 3, begin, end, f);
}

void cs_contact_set_add_blocks(const struct cs_contact_set *set, size_t begin, size_t end,
                               double *blocks) {
    cs_gather_add(&set->gather, set->gather.gathered, 6, begin, end, blocks);
}

/* One product: y += (A - diagonal) p. */
struct product {
    const struct cs_contact_set *set;
    const double *p;
    double *y;
};

/* Products of all contacts of a chunk without the diagonal, w_k B (sum w_j p_j - w_k p_k), into
 * their rows; points of colliders have p = 0. */
static void multiply_chunk(void *arg, uint32_t number) {
    const struct product *product = arg;
    const struct cs_gather *gather = &product->set->gather;
    const struct cs_contact_chunk *chunk = product->set->chunks + number;
    const size_t n = gather->n_particles;
    double *row = cs_gather_of(gather->chunks + number, gather->row_sums, 3);
    for (size_t l = 0; l < chunk->n; l++) {
        const struct cs_contact *contact = chunk->contacts + l;
        const uint32_t *points = cs_contact_points(product->set, number, contact);
        double p[4][3], all[3] = {0};
        for (uint32_t k = 0; k < contact->n; k++)
            for (size_t c = 0; c < 3; c++) {
                p[k][c] = points[k] < n ? product->p[c * n + points[k]] : 0;
                all[c] += contact->weights[k] * p[k][c];
            }
        // the solver applies what a point does to itself
        for (uint32_t k = 0; k < contact->n; k++, row += 3) {
            double others[3];
            for (int c = 0; c < 3; c++)
                others[c] = contact->weights[k] * (all[c] - contact->weights[k] * p[k][c]);
            cs_sym3_multiply(contact->block, others, row);
        }
    }
}

static void add_products(void *arg, size_t begin, size_t end) {
    const struct product *product = arg;
    cs_contact_set_add(product->set, begin, end, product->y);
}

void cs_contact_set_multiply(const struct cs_contact_set *set, const double *p, double *y) {
    struct product product = {set, p, y};
    if (!set->n)
        return;
    cs_pool_run(set->gather.n_chunks, multiply_chunk, &product);
    cs_vector_parallel_for(set->gather.n_particles, add_products, &product);
}

void cs_contact_set_add_bound(const struct cs_contact_set *set, double *stiffness,
                              double *damping) {
    // in one thread: chunks share particles
    for (uint32_t l = 0; l < set->gather.n_chunks; l++)
        for (size_t p = 0; p < set->chunks[l].n; p++) {
            const struct cs_contact *contact = set->chunks[l].contacts + p;
            const uint32_t *points = cs_contact_points(set, l, contact);
            for (uint32_t k = 0; k < contact->n; k++) {
                stiffness[points[k]] += contact->weights[k] * contact->vector[0];
                damping[points[k]] += contact->weights[k] * contact->vector[1];
            }
        }
}
