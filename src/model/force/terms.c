#include "model/force/terms.h"

#include "base/pool.h"

#include <string.h>

const struct cs_term *const cs_terms[CS_TERMS] = {&cs_term_springs, &cs_term_gravity,
                                                  &cs_term_drag, &cs_term_wind, &cs_term_push};

/* what blocks are done with; dx and dv are of a product alone */
struct job {
    const struct cs_system *system;
    double t;
    const double *x, *v;
    uint32_t parts;
    const double *dx, *dv;
    double *to;
};

static void clear(const struct cs_system *system, const struct cs_block *block, double *f) {
    for (size_t c = 0; c < 3; c++)
        memset(f + c * system->view.n + block->begin, 0,
               sizeof *f * (block->end - block->begin));
}

/* the first pinned particle of a block, by its number in the list */
static uint32_t find_pinned(const struct cs_system *system, uint32_t begin) {
    uint32_t low = 0;
    for (uint32_t high = system->n_pinned; low < high;) {
        const uint32_t middle = low + (high - low) / 2;
        if (system->pinned[middle] < begin)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void clear_pinned(const struct cs_system *system, const struct cs_block *block,
                         double *f) {
    const uint32_t first = find_pinned(system, block->begin),
                   end = find_pinned(system, block->end);
    for (size_t c = 0; c < 3; c++)
        for (uint32_t p = first; p < end; p++)
            f[c * system->view.n + system->pinned[p]] = 0;
}

static void force_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    clear(system, &block, job->to);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->parts & job->parts)
            system->terms[k]->add_force(system, job->t, job->x, job->v, job->parts, &block,
                                        job->to);
    clear_pinned(system, &block, job->to);
}

void cs_terms_force(const struct cs_system *system, double t, const double *x, const double *v,
                    uint32_t parts, double *f) {
    struct job job = {system, t, x, v, parts, NULL, NULL, f};
    cs_springs_wait_force(&system->springs, system->view.n, x, v, parts);
    cs_pool_run(system->springs.n_blocks, force_block, &job);
}

static void jvp_block(void *arg, uint32_t number) {
    const struct job *job = arg;
    const struct cs_system *system = job->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    clear(system, &block, job->to);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->parts & job->parts && system->terms[k]->add_jvp)
            system->terms[k]->add_jvp(system, job->t, job->x, job->v, job->parts, job->dx,
                                      job->dv, &block, job->to);
    clear_pinned(system, &block, job->to);
}

void cs_terms_jvp(const struct cs_system *system, double t, const double *x, const double *v,
                  uint32_t parts, const double *dx, const double *dv, double *df) {
    struct job job = {system, t, x, v, parts, dx, dv, df};
    cs_springs_wait_jvp(&system->springs, system->view.n, x, v, parts, dx, dv);
    cs_pool_run(system->springs.n_blocks, jvp_block, &job);
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
