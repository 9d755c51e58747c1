/* verdict.h - a comparison in words: what its rows say, and what to mind. */
#ifndef CS_COMPARE_VERDICT_H
#define CS_COMPARE_VERDICT_H

#include "study/compare/ranking.h"

/* Adds the ranking, a line each behind `bullet`. Each line is true of the rows that were run,
 * and says nothing of others. */
void cs_verdict_print(const struct cs_ranking *ranking, const char *bullet,
                      const struct cs_compare *compare, struct cs_text *out);

/* Adds the answer to "what is the cheapest way to an error of at most bound": a line. */
void cs_verdict_print_at(const struct cs_compare *compare, double bound, struct cs_text *out);

/* The closed list of warnings, each with advice; adds one line a warning, each behind `bullet`.
 */
void cs_compare_warn(const struct cs_compare *compare, const char *bullet, struct cs_text *out);

#endif
