/* ranking.h - what a comparison says: for each error the cheapest method, and by how much. */
#ifndef CS_RANKING_H
#define CS_RANKING_H

#include "study/compare/compare_state.h"

enum { CS_RANKS_MAX = 24 };

/* The cheapest cell with an error of at most 10^exponent m, and that of the next method. */
struct cs_rank {
    int exponent;
    const struct cs_cell *best, *next; /* borrowed; next NULL: no other method gets there */
    double factor, low, high;          /* next / best: medians, and from quartile to quartile */
};

struct cs_ranking {
    struct cs_rank ranks[CS_RANKS_MAX]; /* from large errors to small ones */
    uint32_t n;
    bool *front; /* (cells) nothing is both cheaper and more accurate; owned */
    /* the cheapest fixed step of one frame that got through, and the next; NULL: none */
    struct cs_rank frame;
};

enum cs_status cs_ranking_make(struct cs_ranking *ranking, const struct cs_compare *compare,
                               struct cs_error *error);
void cs_ranking_finish(struct cs_ranking *ranking);

/* Adds it in words, a line each behind `bullet`. */
void cs_ranking_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out);

/* The closed list of warnings, each with advice; adds one line a warning, each behind `bullet`.
 */
void cs_compare_warn(const struct cs_compare *compare, const char *bullet, struct cs_text *out);

#endif
