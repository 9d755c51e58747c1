/* golden_image.h - one picture through the two-level gate. */
#ifndef CS_GOLDEN_IMAGE_H
#define CS_GOLDEN_IMAGE_H

#include "study/golden/golden_run.h"

/* Renders the last frame of a row's run and compares it with the golden image: row->found,
 * row->renderer and row->message say what came of it. With golden->accept the image is written
 * over. */
enum cs_status cs_golden_check_image(struct cs_golden *golden, struct cs_golden_row *row,
                                     struct cs_error *error);

#endif
