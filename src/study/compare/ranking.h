/* ranking.h - ranks methods by their cost at equal error (equal_error.h), and states their
 * margin.
 *
 * For each power of ten of the error the cheapest method is the best, and the next one the
 * runner-up. Cost is the median processor time, and the ranking by work is told beside it; in a
 * comparison with programs cost is work alone. The
 * Pareto front holds the cells with no other one both cheaper and at least as accurate. Only
 * cells that were timed on this machine are ranked. */
#ifndef CS_RANKING_H
#define CS_RANKING_H

#include "study/compare/equal_error.h"

/* Ratio from which two cells differ that were not timed in pairs. */
#define CS_APART_UNPAIRED 1.5

/* Energy error, as a fraction of the largest kinetic energy, up to which one step per frame
 * counts as stable. */
#define CS_FRAME_ENERGY 0.1

/* The cheapest method with an error of at most 10^exponent, and the next one. */
struct cs_rank {
    int exponent;
    const struct cs_cell *best, *runner_up; /* borrowed; NULL: no other series was run to it */
    struct cs_standing of[2];               /* of the two */
    bool has_factor;                        /* neither of them is somewhere below */
    bool by_work;                           /* cost is work, and no times are compared */
    struct cs_ratio ratio;                  /* runner-up over best, if has_factor */
    struct cs_ratio work;         /* the same of counts, with the last level of the interval */
    bool is_significant;          /* their costs differ significantly */
    const struct cs_cell *frugal; /* least work of a series at the bound; may be best */
    /* by another norm: the cheapest cell that is no worse than best, if it is another series
     * and significantly cheaper; NULL: best wins by that norm too */
    const struct cs_cell *better_by_norm[CS_NORMS];
};

struct cs_ranking {
    enum cs_norm norm;
    struct cs_rank ranks[CS_RANKS_MAX]; /* from large errors to small ones */
    uint32_t n;
    bool *on_pareto_front; /* (cells) nothing is both cheaper and more accurate; owned */
    bool *is_contender;    /* (cells) the verdict rests on them: to be timed in rounds; owned */
    /* one step a frame: the cheapest that keeps the energy and the next; best NULL: none */
    struct cs_rank frame;
    const struct cs_cell *frame_nearest;  /* with the least energy error of them; or NULL */
    uint32_t frame_tried, frame_finished; /* cells with a dt of a frame; of these to the end */
};

/* Ranks the cells of a comparison by settings->ranking_norm. Ranks point into compare->cells,
 * which must not change meanwhile. Returns CS_ERR_MEMORY; the ranking is then empty. */
enum cs_status cs_ranking_make(struct cs_ranking *ranking, const struct cs_compare *compare,
                               struct cs_error *error);

/* Frees the marks of cells; a zeroed ranking is allowed. */
void cs_ranking_finish(struct cs_ranking *ranking);

/* Finds the cheapest row with an error of at most bound (unit of the norm) and its runner-up.
 * best is NULL if there is none. */
void cs_ranking_at(const struct cs_compare *compare, double bound, struct cs_rank *rank);

/* True if the pairs of each ratio of contenders leave at most that fraction open to either
 * side. Ratios above 3 count as narrow: they decide nothing. */
bool cs_ranking_is_narrow(const struct cs_ranking *ranking, double share);

/* States the results of a comparison in words, with warnings. */

/* Adds the ranking, one line per statement after `bullet`. A line states facts of the rows that
 * were run, and claims nothing of others. */
void cs_verdict_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out);
/* Adds the ranking by work and single times, for the time that rounds take; nothing where the
 * cells are of little work. CS_ERR_MEMORY. */
enum cs_status cs_verdict_print_preliminary(const struct cs_compare *compare,
                                            struct cs_text *out, struct cs_error *error);

/* Adds a line: the cheapest way to an error of at most bound. */
void cs_verdict_print_at(const struct cs_compare *compare, double bound, struct cs_text *out);

/* Adds the warnings that apply, one per line after `bullet`, each with advice. */
void cs_compare_warn(const struct cs_compare *compare, const char *bullet, struct cs_text *out);

#endif
