/* golden_image.h - checks one picture in two levels. */
#ifndef CS_GOLDEN_IMAGE_H
#define CS_GOLDEN_IMAGE_H

#include "study/golden/golden_run.h"

/* Renders the last frame of a row's run and compares it with the golden image; the result is in
 * row->found, row->renderer and row->message. With accept_all the image is replaced. */
enum cs_status cs_golden_check_image(struct cs_golden *golden, struct cs_golden_row *row,
                                     struct cs_error *error);

#endif
