/* narrow_phase.h - forces, Jacobian products, energies, matrix terms and bounds of the pairs in
 * range at a state. */
#ifndef CS_NARROW_PHASE_NARROW_PHASE_H
#define CS_NARROW_PHASE_NARROW_PHASE_H

#include "model/contact/narrow_phase/active_contacts.h"
#include "model/contact/narrow_phase/pair_matrix.h"
#include "model/contact/point_query.h"

/* One evaluation; the caller fills it. All pointers are borrowed. */
struct cs_narrow_phase {
    const struct cs_system *system;
    /* active contacts of the positions x */
    struct cs_active_contacts *contacts;
    /* (3, n_points) positions in m and velocities in m/s; v NULL: at rest */
    const double *x, *v;
    enum cs_contact_query query;
    struct cs_eval eval;
    const struct cs_matrix *matrix; /* of CS_QUERY_MATRIX */
    struct cs_pair_matrix *result;  /* receives it */
    /* chunk of lagged friction that the first chunk goes to */
    uint32_t first_lagged;
};

/* Evaluates all active contacts, whose rows must exist, with all threads. The result goes to
 *
 * - contacts->force_gather.row_sums: forces (n_rows, 3), or bounds (n_rows, 2), stiffness and
 *   damping;
 * - contacts->chunks[].energy for energies;
 * - result for a matrix;
 * - the store of the system for lagged friction.
 *
 * Returns false if out of memory; results are then incomplete and the run must end. */
bool cs_narrow_phase_run(struct cs_narrow_phase *narrow);

#endif
