/* Contact pairs: updates the candidate list and evaluates the pairs in range.
 *
 * Two lists of active contacts exist. The solver's matrix refers to one until it is replaced,
 * while forces at other states use the other. A list is reused as long as its pairs are those
 * in range. */
#include "model/contact/narrow_phase/contact_pairs.h"

#include "model/contact/narrow_phase/candidates_in_range.h"
#include "model/contact/narrow_phase/narrow_phase.h"
#include "model/contact/surface_points.h"

/* Active contacts at x: those of a list that fits, else found into the list that the solver's
 * matrix does not use; NULL if out of memory. */
static struct cs_active_contacts *find(struct cs_pairs *pairs, const double *x) {
    if (!cs_candidates_find_in_range(&pairs->candidates, x))
        return NULL;
    for (int k = 0; k < 2; k++)
        if (cs_active_contacts_is_there(pairs->lists + k))
            return pairs->lists + k;
    struct cs_active_contacts *active =
        pairs->lists + (pairs->solver_psd.contacts == pairs->lists);
    return cs_active_contacts_find(active, x) ? active : NULL;
}

/* Runs one query; returns false if out of memory. */
static bool answer(struct cs_pairs *pairs, struct cs_narrow_phase *narrow) {
    const struct cs_eval *at = &narrow->eval;
    narrow->x = cs_surface_points_positions(pairs->system, CS_POINTS_BEGIN, at->t, at->x);
    narrow->v = cs_surface_points_velocities(pairs->system, at->t, at->v);
    cs_body_pair_table_update_friction(pairs->system, &pairs->body_pairs);
    narrow->contacts = find(pairs, narrow->x);
    if (!narrow->contacts)
        return false;
    pairs->current_contacts = narrow->contacts;
    if (narrow->query != CS_CONTACT_QUERY_ENERGY &&
        !cs_active_contacts_gather(pairs->current_contacts))
        return false;
    if (narrow->psd &&
        !cs_psd_operator_begin(narrow->psd, pairs->current_contacts,
                               narrow->psd == &pairs->other_psd && narrow->matrix->bound))
        return false;
    return cs_narrow_phase_run(narrow);
}

/* Runs one query. Out of memory is remembered, and the query then has no pairs. */
static void run(struct cs_pairs *pairs, struct cs_narrow_phase *narrow) {
    if (answer(pairs, narrow))
        return;
    pairs->failed = true;
    pairs->current_contacts->n = 0;
}

/* The query is a Jacobian product as soon as one direction is given. */
void cs_pairs_set(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct cs_narrow_phase narrow = {
        .query = at->dx || at->dv ? CS_CONTACT_QUERY_JVP : CS_CONTACT_QUERY_FORCE, .eval = *at};
    run(pairs, &narrow);
}

void cs_pairs_add(const struct cs_pairs *pairs, size_t begin, size_t end, double *f) {
    const struct cs_gather *gather = &pairs->current_contacts->force_gather;
    if (pairs->current_contacts->n)
        cs_gather_add(gather, gather->row_sums, 3, begin, end, f);
}

double cs_pairs_energy(struct cs_pairs *pairs, const struct cs_eval *at) {
    struct cs_narrow_phase narrow = {.query = CS_CONTACT_QUERY_ENERGY, .eval = *at};
    double sum = 0;
    run(pairs, &narrow);
    for (uint32_t l = 0; l < pairs->candidates.n_chunks && pairs->current_contacts->n; l++)
        sum += pairs->current_contacts->chunks[l].energy;
    return sum;
}

/* --- matrices --- */

/* Set of an exact matrix: the solver's, or another. */
static struct cs_contact_set *set_of(struct cs_pairs *pairs, const struct cs_matrix *matrix,
                                     bool kept) {
    struct cs_contact_set *set = kept ? &pairs->solver_exact : &pairs->other_exact;
    set->has_hessians = true;
    set->diagonal_bound = !kept && matrix->bound;
    return set;
}

/* A new solver matrix first releases the list of active contacts that the old one used. */
void cs_pairs_set_matrix(struct cs_pairs *pairs, const struct cs_matrix *matrix, bool kept) {
    struct cs_narrow_phase narrow = {
        .query = CS_CONTACT_QUERY_MATRIX,
        .eval = {.t = matrix->t, .x = matrix->x, .v = matrix->v, .parts = CS_PART_ALL},
        .matrix = matrix};
    if (matrix->psd)
        narrow.psd = kept ? &pairs->solver_psd : &pairs->other_psd;
    else
        narrow.exact_set = set_of(pairs, matrix, kept);
    if (kept)
        pairs->solver_psd.contacts = NULL;
    run(pairs, &narrow);
    if (kept)
        pairs->blocks = matrix->psd ? CS_PAIRS_SOLVER_PSD : CS_PAIRS_SOLVER_EXACT;
    else
        pairs->blocks = matrix->psd ? CS_PAIRS_OTHER_PSD : CS_PAIRS_OTHER_EXACT;
}

void cs_pairs_add_blocks(const struct cs_pairs *pairs, size_t begin, size_t end,
                         double *blocks) {
    if (pairs->failed)
        return;
    if (pairs->blocks == CS_PAIRS_SOLVER_EXACT || pairs->blocks == CS_PAIRS_OTHER_EXACT)
        cs_contact_set_add_blocks(pairs->blocks == CS_PAIRS_SOLVER_EXACT ? &pairs->solver_exact
                                                                         : &pairs->other_exact,
                                  begin, end, blocks);
    else
        cs_psd_operator_add_blocks(pairs->blocks == CS_PAIRS_SOLVER_PSD ? &pairs->solver_psd
                                                                        : &pairs->other_psd,
                                   begin, end, blocks);
}

/* solver_psd.contacts is NULL while the solver's matrix is exact. */
void cs_pairs_multiply(const struct cs_pairs *pairs, const double *p, double *y) {
    if (pairs->failed)
        return;
    if (pairs->solver_psd.contacts)
        cs_psd_operator_apply(&pairs->solver_psd, p, y);
    else
        cs_contact_set_multiply(&pairs->solver_exact, p, y);
}

/* Damping follows stiffness in the same array, n_rows numbers later. */
void cs_pairs_add_bound(struct cs_pairs *pairs, const struct cs_eval *at, double *stiffness,
                        double *damping) {
    struct cs_narrow_phase narrow = {.query = CS_CONTACT_QUERY_BOUND, .eval = *at};
    run(pairs, &narrow);
    const struct cs_gather *gather = &pairs->current_contacts->force_gather;
    const size_t n = pairs->system->view.n;
    if (!pairs->current_contacts->n)
        return;
    cs_gather_add(gather, gather->row_sums, 1, 0, n, stiffness);
    cs_gather_add(gather, gather->row_sums + gather->n_rows, 1, 0, n, damping);
}
