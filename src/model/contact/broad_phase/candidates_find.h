/* candidates_find.h - the pairs that may be near at a state, batch by batch. */
#ifndef CS_BROAD_PHASE_CANDIDATES_FIND_H
#define CS_BROAD_PHASE_CANDIDATES_FIND_H

#include "model/contact/broad_phase/candidate_list.h"

/* Takes what it needs beside search->flat, meetings and body. CS_ERR_MEMORY. */
enum cs_status cs_candidates_find_init(struct cs_candidates *candidates, struct cs_arena *arena,
                                       struct cs_error *error);

/* Fills batches and rows for the state search->from, which is the one in search->rough, and the
 * margin search->held, with all threads. false: no memory. */
bool cs_candidates_find(struct cs_candidates *candidates);

/* Gives back the memory that does not belong to the arena. */
void cs_candidates_find_finish(struct cs_candidates *candidates);

#endif
