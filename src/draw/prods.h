/* prods.h - viewpoint forces drawn over a picture: viewpoint, rectangle, particles affected.
 */
#ifndef CS_DRAW_PRODS_H
#define CS_DRAW_PRODS_H

#include "draw/net.h"
#include "draw/render.h"

/* Of each viewpoint force that acted in the frame that ends now: dots on the particles that it
 * saw last, its rectangle at the distance of its target, in front of all, and the lines to its
 * corners from the eye. On a picture from the same viewpoint that is the rectangle alone. */
void cs_prods_draw(const struct cs_net *net, struct cs_lines *lines,
                   const struct cs_frame *frame);

#endif
