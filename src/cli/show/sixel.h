/* sixel.h - images through libsixel, which is loaded by sixel.c alone. */
#ifndef CS_SIXEL_H
#define CS_SIXEL_H

#include "base/image.h"
#include "base/text.h"

/* Loads the library. Returns false if it is not installed. */
bool cs_sixel_load(void);

/* Adds an image as a sixel sequence. Returns false if the library fails. */
bool cs_sixel_add(const struct cs_image *image, struct cs_text *out);

#endif
