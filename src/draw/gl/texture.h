/* texture.h - a picture that repeats over a cloth. */
#ifndef CS_DRAW_TEXTURE_H
#define CS_DRAW_TEXTURE_H

#include "base/image.h"

/* Returns the name of a texture with trilinear filtering; its texels stay in sRGB. */
unsigned cs_texture_make(const struct cs_image *image);

#endif
