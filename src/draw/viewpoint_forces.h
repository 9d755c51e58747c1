/* viewpoint_forces.h - viewpoint forces drawn over a picture: viewpoint, rectangle, particles
 * affected.
 */
#ifndef CS_DRAW_VIEWPOINT_FORCES_H
#define CS_DRAW_VIEWPOINT_FORCES_H

#include "draw/render.h"
#include "draw/wireframe.h"

/* Marks each viewpoint force that acted in the frame that ends now: dots on the particles that
 * it saw last; its rectangle at the distance of its target, in front of all; and lines from the
 * eye to its corners. Seen from the same viewpoint, that is the rectangle alone. */
void cs_viewpoint_forces_draw(const struct cs_wireframe *net, struct cs_lines *lines,
                              const struct cs_frame *frame);

#endif
