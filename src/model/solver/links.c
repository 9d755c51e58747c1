/* Lists of springs that are made anew for every matrix. */
#include "model/solver/links.h"

#include "base/pool.h"

#include <clothsim/small.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = CS_LINKS_LANES };

static void finish(void *object) {
    struct cs_links *links = object;
    for (uint32_t p = 0; p < links->n_pieces; p++) {
        free(links->pieces[p].list);
        free(links->pieces[p].cells);
        free(links->pieces[p].springs);
    }
}

enum cs_status cs_links_init(struct cs_links *links, uint32_t n_cells, struct cs_arena *arena,
                             struct cs_error *error) {
    *links = (struct cs_links){.n_blocks = n_cells / LANES};
    const uint32_t n_pieces = (links->n_blocks + CS_LINKS_PIECE - 1) / CS_LINKS_PIECE;
    links->pieces = cs_arena_take_n(arena, n_pieces, sizeof *links->pieces, error);
    links->begins = cs_arena_take_n(arena, links->n_blocks, sizeof(uint32_t), error);
    links->held = cs_arena_take_n(arena, 6 * (size_t)n_cells, sizeof(float), error);
    links->ends = cs_arena_take_n(arena, links->n_blocks, sizeof(uint32_t), error);
    links->n_pieces = error->status ? 0 : n_pieces;
    if (!error->status)
        cs_arena_own(arena, finish, links, error);
    return error->status;
}

/* the place of a spring in the list, a new one at its end; NULL: no memory */
static struct cs_link *link_to(struct cs_links_piece *piece, uint32_t to) {
    uint32_t k = 0;
    while (k < piece->n_list && piece->list[k].to != to)
        k++;
    if (k < piece->n_list)
        return piece->list + k;
    struct cs_link *list =
        cs_arena_grow(piece->list, &piece->list_room, (size_t)k + 1, sizeof *list);
    piece->failed = piece->failed || !list;
    if (!list)
        return NULL;
    piece->list = list;
    list[piece->n_list++] = (struct cs_link){.to = to};
    return list + k;
}

void cs_links_add(struct cs_links_piece *piece, uint32_t to, const float block[6],
                  float factor) {
    struct cs_link *link = link_to(piece, to);
    const bool less = factor * (block[0] + block[3] + block[5]) < 0;
    for (int c = 0; link && c < 6; c++)
        *((less ? link->less : link->more) + c) += factor * block[c];
}

/* but for rounding: a spring may well hold one direction alone */
static bool is_positive(const float block[6]) {
    double sum[6], cofactors[6];
    for (int c = 0; c < 6; c++)
        sum[c] = (double)block[c];
    const double extra = 1e-6 * (sum[0] + sum[3] + sum[5]);
    for (int c = 0; c < 6; c += c ? 2 : 3)
        sum[c] += extra;
    const double determinant = cs_sym3_cofactors(sum, cofactors);
    return cs_sym3_is_definite(sum, cofactors, determinant);
}

/* a slot without springs for the block of 16 cells; false: no memory, now or before */
static bool open_slot(struct cs_links_piece *piece, uint32_t block) {
    const size_t n = (size_t)piece->n_slots + 1, slot = piece->n_slots;
    uint32_t *cells = cs_arena_grow(piece->cells, &piece->cells_room, LANES * n, sizeof *cells);
    piece->cells = cells ? cells : piece->cells;
    float *springs =
        cs_arena_grow(piece->springs, &piece->springs_room, 6 * LANES * n, sizeof *springs);
    piece->springs = springs ? springs : piece->springs;
    piece->failed = piece->failed || !cells || !springs;
    if (piece->failed)
        return false;
    for (uint32_t l = 0; l < LANES; l++)
        cells[LANES * slot + l] = LANES * block + l;
    memset(springs + 6 * LANES * slot, 0, 6 * LANES * sizeof *springs);
    piece->n_slots++;
    return true;
}

/* Into the slot of its block, and into the diagonal. A sum that is neither above nor below 0
 * has all there that is above. */
static void put_link(struct cs_links *links, struct cs_links_piece *piece, uint32_t cell,
                     const struct cs_link *link, size_t slot) {
    const size_t n = (size_t)links->n_blocks * LANES;
    float sum[6];
    for (int c = 0; c < 6; c++)
        sum[c] = link->more[c] + link->less[c];
    const bool above = sum[0] + sum[3] + sum[5] > 0;
    const float *held = is_positive(sum) ? sum : link->more;
    piece->cells[LANES * slot + cell % LANES] = link->to;
    for (size_t c = 0; c < 6; c++) {
        piece->springs[LANES * (6 * slot + c) + cell % LANES] = sum[c];
        links->held[c * n + cell] += above ? held[c] : 0;
    }
}

/* from `slot` on */
static void put_list(struct cs_links *links, struct cs_links_piece *piece, uint32_t cell,
                     size_t slot) {
    const size_t n = (size_t)links->n_blocks * LANES;
    for (size_t c = 0; c < 6; c++)
        links->held[c * n + cell] = 0;
    for (uint32_t k = 0; k < piece->n_list; k++, slot++)
        if (slot < piece->n_slots || open_slot(piece, cell / LANES))
            put_link(links, piece, cell, piece->list + k, slot);
}

struct making {
    struct cs_links *links;
    void (*find)(void *arg, struct cs_links_piece *piece, uint32_t cell);
    void *arg;
};

static void make_piece(void *arg, uint32_t number) {
    const struct making *making = arg;
    struct cs_links *links = making->links;
    struct cs_links_piece *piece = links->pieces + number;
    piece->n_slots = 0;
    piece->failed = false;
    const uint32_t begin = number * CS_LINKS_PIECE, end = begin + CS_LINKS_PIECE;
    for (uint32_t b = begin; b < end && b < links->n_blocks; b++) {
        links->begins[b] = piece->n_slots;
        for (uint32_t l = 0; l < LANES; l++) {
            piece->n_list = 0;
            making->find(making->arg, piece, LANES * b + l);
            put_list(links, piece, LANES * b + l, links->begins[b]);
        }
        links->ends[b] = piece->n_slots;
    }
}

bool cs_links_make(struct cs_links *links,
                   void (*find)(void *arg, struct cs_links_piece *piece, uint32_t cell),
                   void *arg) {
    struct making making = {links, find, arg};
    bool failed = false;
    links->any = false;
    cs_pool_run(links->n_pieces, make_piece, &making);
    for (uint32_t p = 0; p < links->n_pieces; p++) {
        failed = failed || links->pieces[p].failed;
        links->any = links->any || links->pieces[p].n_slots;
    }
    links->any = links->any && !failed;
    return !failed;
}
