/* corners.h - the kept matrix of pairs, by the particles that they are of. */
#ifndef CS_SOLVER_CORNERS_H
#define CS_SOLVER_CORNERS_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cs_pairs;

/* A corner of a pair. */
struct cs_corner {
    uint32_t lot, pair, at;
};

struct cs_corners {
    uint32_t *starts;     /* (n + 2) */
    struct cs_corner *of; /* those of particle i: of[starts[i]..starts[i + 1]), in the order of
                             the lots */
    size_t starts_room, of_room;
};

/* The arena owns what grows. CS_ERR_MEMORY. */
enum cs_status cs_corners_init(struct cs_corners *corners, struct cs_arena *arena,
                               struct cs_error *error);

/* How many pairs the kept matrix is of. */
size_t cs_corners_pairs(const struct cs_pairs *pairs);

/* Finds the corners of the kept matrix. false: no memory. */
bool cs_corners_find(struct cs_corners *corners, const struct cs_pairs *pairs);

/* What a pair has of the matrix, seen from one of its corners. */
struct cs_corner_share {
    uint32_t at[4]; /* points of the pair */
    uint32_t corner;
    double weight[4];
    double own[6];   /* the block of the corner with itself */
    double whole[6]; /* that of a corner whose weight would be 1, where the gradient is bent
                        least and does not turn */
};
void cs_corners_read(const struct cs_pairs *pairs, const struct cs_corner *corner,
                     struct cs_corner_share *share);

#endif
