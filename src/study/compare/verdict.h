/* verdict.h - states the results of a comparison in words, with warnings. */
#ifndef CS_COMPARE_VERDICT_H
#define CS_COMPARE_VERDICT_H

#include "study/compare/ranking.h"

/* Adds the ranking, one line per statement after `bullet`. A line states facts of the rows that
 * were run, and claims nothing of others. */
void cs_verdict_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out);

/* Adds a line: the cheapest way to an error of at most bound. */
void cs_verdict_print_at(const struct cs_compare *compare, double bound, struct cs_text *out);

/* Adds the warnings that apply, one per line after `bullet`, each with advice. */
void cs_compare_warn(const struct cs_compare *compare, const char *bullet, struct cs_text *out);

#endif
