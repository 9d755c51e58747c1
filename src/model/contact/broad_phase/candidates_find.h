/* candidates_find.h - the search for candidates at a state, batch by batch. */
#ifndef CS_BROAD_PHASE_CANDIDATES_FIND_H
#define CS_BROAD_PHASE_CANDIDATES_FIND_H

#include "model/contact/broad_phase/candidate_list.h"

/* Allocates clusters, batches and rows. flat_regions, body_pairs and body must be set.
 * CS_ERR_MEMORY. */
enum cs_status cs_candidates_find_init(struct cs_candidates *candidates, struct cs_arena *arena,
                                       struct cs_error *error);

/* Fills batches and rows for the state x_at_build, which scaled_points must hold too, and the
 * margin margin_now, with all threads. Returns false if out of memory. */
bool cs_candidates_find(struct cs_candidates *candidates);

/* Frees the memory that does not belong to the arena. */
void cs_candidates_find_finish(struct cs_candidates *candidates);

#endif
