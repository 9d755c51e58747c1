/* narrow_phase.h - what the pairs in range at a state do. */
#ifndef CS_NARROW_PHASE_NARROW_PHASE_H
#define CS_NARROW_PHASE_NARROW_PHASE_H

#include "model/contact/narrow_phase/active_contacts.h"
#include "model/contact/narrow_phase/psd_operator.h"

/* what the pairs in range are asked for */
enum cs_contact_query {
    CS_CONTACT_QUERY_FORCE,
    CS_CONTACT_QUERY_JVP, /* of the force */
    CS_CONTACT_QUERY_ENERGY,
    CS_CONTACT_QUERY_MATRIX,
    CS_CONTACT_QUERY_BOUND
};

struct cs_narrow_phase {
    struct cs_active_contacts *contacts; /* those of x */
    const double *x, *v;                 /* (3, n_points) at the state; v NULL: at rest */
    enum cs_contact_query query;
    struct cs_eval eval;
    const struct cs_matrix *matrix;   /* of CS_CONTACT_QUERY_MATRIX */
    struct cs_psd_operator *psd;      /* of a matrix that is psd */
    struct cs_contact_set *exact_set; /* of any other */
};

/* Answers into the sums of the active pairs' rows, which are there but for energies: forces
 * (n_rows, 3), or bounds (2, n_rows), stiffness and damping; into their chunks' energies; or
 * fills the product or the set. false: no memory. With all threads. */
bool cs_narrow_phase_run(struct cs_narrow_phase *narrow);

#endif
