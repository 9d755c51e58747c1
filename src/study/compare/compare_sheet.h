/* compare_sheet.h - contact sheets: the last frame of the methods, each particle coloured by
 * its distance to the reference. */
#ifndef CS_COMPARE_SHEET_H
#define CS_COMPARE_SHEET_H

#include "draw/render.h"
#include "study/compare/compare_state.h"

/* Writes FOLDER/pictures/KIND_SERIES.png and, where gnuplot is found, FOLDER/KIND.png with all
 * of them, for the kinds equal_step (the step that most methods got through with) and
 * equal_cost (what each method does within the time that all of them can keep). Colours stand
 * for powers of ten from the reference's bar to the largest error. Without errors of position
 * nothing is drawn. CS_ERR_MODULE (renderer), CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_compare_contact_sheet_write(const struct cs_compare *compare,
                                              enum cs_renderer_kind kind,
                                              struct cs_error *error);

#endif
