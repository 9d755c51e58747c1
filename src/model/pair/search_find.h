/* search_find.h - the pairs that may be near at a state, batch by batch. */
#ifndef CS_PAIR_SEARCH_FIND_H
#define CS_PAIR_SEARCH_FIND_H

#include "model/pair/search_list.h"

/* Takes what it needs beside search->flat, meetings and body. CS_ERR_MEMORY. */
enum cs_status cs_search_find_init(struct cs_search *search, struct cs_arena *arena,
                                   struct cs_error *error);

/* Fills batches and rows for the state search->from, which is the one in search->rough, and the
 * margin search->held, with all threads. false: no memory. */
bool cs_search_find(struct cs_search *search);

/* Gives back the memory that does not belong to the arena. */
void cs_search_find_finish(struct cs_search *search);

#endif
