#include "model/terms.h"

#include <string.h>

const struct cs_term *const cs_terms[CS_TERMS] = {&cs_term_springs, &cs_term_gravity,
                                                  &cs_term_drag, &cs_term_wind, &cs_term_push};

static void clear_pinned(const struct cs_system *system, double *f) {
    for (uint32_t c = 0; c < 3; c++)
        for (uint32_t p = 0; p < system->n_pinned; p++)
            f[(size_t)c * system->view.n + system->pinned[p]] = 0;
}

void cs_terms_force(const struct cs_system *system, double t, const double *x, const double *v,
                    uint32_t parts, double *f) {
    memset(f, 0, 3 * sizeof *f * system->view.n);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->parts & parts)
            system->terms[k]->add_force(system, t, x, v, parts, f);
    clear_pinned(system, f);
}

void cs_terms_jvp(const struct cs_system *system, double t, const double *x, const double *v,
                  uint32_t parts, const double *dx, const double *dv, double *df) {
    memset(df, 0, 3 * sizeof *df * system->view.n);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->parts & parts && system->terms[k]->add_jvp)
            system->terms[k]->add_jvp(system, t, x, v, parts, dx, dv, df);
    clear_pinned(system, df);
}

void cs_terms_diagonal(const struct cs_system *system, const double *x, double *kxx,
                       double *dvv) {
    memset(kxx, 0, 6 * sizeof *kxx * system->view.n);
    memset(dvv, 0, 6 * sizeof *dvv * system->view.n);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->add_diagonal)
            system->terms[k]->add_diagonal(system, x, kxx, dvv);
}

bool cs_terms_need_normals(const struct cs_system *system, uint32_t parts) {
    return system->normals && parts & CS_PART_WIND;
}
