/* look.h - table of looks: colours and lines of each.
 *
 * A new look needs: its line in CS_LOOK_LIST (scene/picture_keys.h), its row in look.c, and
 * code for anything that no look draws or measures yet. */
#ifndef CS_DRAW_LOOK_H
#define CS_DRAW_LOOK_H

#include "scene/picture_keys.h"

/* Source of the colours of bodies. */
enum cs_look_colours {
    CS_COLOURS_MATERIAL, /* lit, with textures and folds */
    CS_COLOURS_FAINT,    /* pale, behind lines */
    CS_COLOURS_FORCE,    /* N */
    CS_COLOURS_STRAIN,   /* 1 */
    CS_COLOURS_CROSSINGS /* marks of triangles: 0 or 1 */
};

/* One look. */
struct cs_look_kind {
    enum cs_look_colours colours;
    const uint32_t *stops;      /* (6) colours of the map, 0xrrggbb in sRGB; NULL: no values */
    const char *title, *unit;   /* of the colour bar; NULL: no bar, and no range of values */
    double factor;              /* from values to the bar's labels */
    bool has_sign;              /* the range is symmetric about 0 */
    bool edges, springs, goals; /* lines over the surfaces */
};

/* Returns the row of a look (enum of CS_LOOK_LIST); constant. */
const struct cs_look_kind *cs_look_of(int32_t look);

#endif
