/* sieve.h - which pairs may be nearer to each other than a reach: in single precision, all of a
 * lot at once, so that the question costs a few nanoseconds a pair.
 *
 * What it lets through is to be asked in double; what it holds back is further apart for
 * certain. Single precision moves a place by 6e-8 of what it is, and the foot of a
 * perpendicular along a sliver by 1e-3 of the longest edge, where slivers are at last taken for
 * segments; more than twice that is allowed. */
#ifndef CS_NEAR_SIEVE_H
#define CS_NEAR_SIEVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* pairs that are asked about together */
enum { CS_SIEVE = 64 };

/* A place against the first of all, in units of a length that the caller chooses: about that of
 * the things themselves, so that their squares are far from the ends of the numbers. */
struct cs_sieve_place {
    float at[4]; /* the last is 0 */
};

/* Pairs of one kind; lanes from n on have numbers that mean nothing. */
struct cs_sieve {
    float p[4][3][CS_SIEVE]; /* a point and a triangle's corners, or the ends of two edges */
    float reach[CS_SIEVE];   /* in their units */
    float over[CS_SIEVE];    /* of its distance squared over the reach's: for cs_sieve_run */
    uint32_t pairs[CS_SIEVE][2]; /* the caller's */
    uint32_t n;
};

/* places [begin, end) of x (3, n); inverse: 1/unit */
void cs_sieve_round(const double *x, size_t n, double inverse, size_t begin, size_t end,
                    struct cs_sieve_place *places);

/* Adds a pair; there must be room. Returns whether that was the last of it. */
static inline bool cs_sieve_add(struct cs_sieve *sieve, const struct cs_sieve_place *places,
                                const uint32_t at[4], double reach, const uint32_t pair[2]) {
    const uint32_t l = sieve->n++;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            sieve->p[k][c][l] = places[at[k]].at[c];
    sieve->reach[l] = (float)reach;
    sieve->pairs[l][0] = pair[0];
    sieve->pairs[l][1] = pair[1];
    return sieve->n == CS_SIEVE;
}

/* Empties the sieve: the pairs that may be nearer than their reach come first in sieve->pairs,
 * in the order in which they were added; returns how many. Pairs with places that are not
 * finite are among them. */
uint32_t cs_sieve_run(struct cs_sieve *sieve, bool edges);

#endif
