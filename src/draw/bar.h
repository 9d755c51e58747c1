/* bar.h - the colour bar beside a picture, with the range in figures. */
#ifndef CS_DRAW_BAR_H
#define CS_DRAW_BAR_H

#include "draw/line.h"
#include "scene/scene.h"

struct cs_bar {
    float ink[3];
    double width, height; /* of the picture */
    bool percent;         /* values are shown times 100 as %, else in N */
};

enum { CS_BAR_LINES = 1024 }; /* lines that it draws at once at most */

void cs_bar_init(struct cs_bar *bar, const struct cs_render *render);
void cs_bar_draw(const struct cs_bar *bar, struct cs_lines *lines, const double range[2]);

#endif
