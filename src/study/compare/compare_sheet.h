/* compare_sheet.h - contact sheets: the last frame of each method, with particles coloured by
 * their distance to the reference. */
#ifndef CS_COMPARE_SHEET_H
#define CS_COMPARE_SHEET_H

#include "draw/render.h"
#include "study/compare/compare_state.h"

/* Writes FOLDER/pictures/KIND_SERIES.png and, if gnuplot is found, FOLDER/KIND.png with all of
 * them. KIND is equal_step (the step with which most methods finished) or equal_cost (the best
 * of each method within a cost that all can keep). Colours are powers of ten from the
 * reference's bar to the largest error. Nothing is drawn without errors of position.
 * CS_ERR_MODULE (renderer), CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_compare_contact_sheet_write(const struct cs_compare *compare,
                                              enum cs_renderer_kind kind,
                                              struct cs_error *error);

#endif
