/* States the cheapest way to an error, as a comparison has found it. */
#include "advise/cheapest.h"

#include <math.h>

/* The cell with the smallest error of the norm, of all that are ranked; NULL: none. */
static const struct cs_cell *most_accurate(const struct cs_compare *compare) {
    const enum cs_norm norm = compare->settings->ranking_norm;
    const struct cs_cell *found = NULL;
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < compare->cells.n; k++) {
        const struct cs_cell *cell = compare->cells.cells + k;
        const double error = cs_norm_of(norm, cell, &compare->reference);
        if (cs_cell_is_finished(cell) && error < least) {
            least = error;
            found = cell;
        }
    }
    return found;
}

void cs_cheapest_print(const struct cs_compare *compare, double bound, struct cs_text *out) {
    const enum cs_norm norm = compare->settings->ranking_norm;
    char integrator[CS_CELL_INTEGRATOR];
    struct cs_rank rank;
    if (!cs_norm_is_known(norm, &compare->reference)) {
        cs_text_add(out, "no errors are known: %s\n", compare->reference.reason);
        return;
    }
    cs_ranking_at(compare, bound, &rank);
    const struct cs_cell *nearest = most_accurate(compare);
    if (rank.best) {
        cs_cell_integrator(rank.best, integrator, sizeof integrator);
        cs_text_add(out, "%s of at most %.3g %s after %.4g s: -i %s", cs_norm_words(norm),
                    bound, cs_norm_unit(norm), compare->time, integrator);
        if (rank.by_work)
            cs_verdict_add_cost(rank.best, true, out);
        else
            cs_text_add(out, ", %.3g ms per frame",
                        1e3 * rank.best->cpu / compare->settings->run.frames);
        cs_verdict_add_factor(&rank, "no other series was run to that error", out);
    } else if (nearest) {
        cs_cell_integrator(nearest, integrator, sizeof integrator);
        cs_text_add(out,
                    "no row has an %s of at most %.3g %s; the smallest is %.2g, of -i %s\n",
                    cs_norm_words(norm), bound, cs_norm_unit(norm),
                    cs_norm_of(norm, nearest, &compare->reference), integrator);
    } else
        cs_text_add(out, "no row finished\n");
}
