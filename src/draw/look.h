/* look.h - what each look shows.
 *
 * A new look: its line in CS_LOOK_LIST (scene/picture_keys.h), its row in look.c, and whatever
 * draws or measures what none before it did. */
#ifndef CS_DRAW_LOOK_H
#define CS_DRAW_LOOK_H

#include "scene/picture_keys.h"

/* What colours the surfaces of bodies. */
enum cs_look_colours {
    CS_COLOURS_MATERIAL, /* lit, with textures and folds */
    CS_COLOURS_FAINT,    /* they step back behind lines */
    CS_COLOURS_FORCE,    /* N */
    CS_COLOURS_STRAIN,
    CS_COLOURS_CROSSINGS /* marks of triangles: 0 or 1 */
};

struct cs_look_kind {
    enum cs_look_colours colours;
    const uint32_t *stops;    /* (6) of values, sRGB; NULL: none */
    const char *title, *unit; /* of the bar of colours: NULL: no bar, and no range of values */
    double factor;            /* of the bar's figures */
    bool has_sign;            /* the range is about 0 */
    bool edges, springs, goals; /* lines that lie over the surfaces */
};

const struct cs_look_kind *cs_look_of(int32_t look);

#endif
