/* The table of looks, and the colours of their values. */
#include "draw/look.h"

#include <stddef.h>

static const uint32_t force_stops[6] = {0x3b1f6b, 0x31578f, 0x1f8a8c,
                                        0x3db86f, 0xa4d742, 0xfbe84a};
static const uint32_t strain_stops[6] = {0x1d3f8f, 0x4f8fc9, 0xc3dcea,
                                         0xf3d3bd, 0xde7a55, 0x8f1626};

// marked triangles are red, all others pale
static const uint32_t mark_stops[6] = {0xd9dde2, 0xd9dde2, 0xd9dde2,
                                       0xd9dde2, 0xd9dde2, 0xd0121b};

static const struct cs_look_kind lit = {.colours = CS_COLOURS_MATERIAL};
static const struct cs_look_kind wireframe = {.colours = CS_COLOURS_FAINT, .edges = true};
static const struct cs_look_kind springs = {.colours = CS_COLOURS_FAINT, .springs = true};
static const struct cs_look_kind force = {.colours = CS_COLOURS_FORCE,
                                          .stops = force_stops,
                                          .title = "force N",
                                          .unit = "N",
                                          .factor = 1};
static const struct cs_look_kind strain = {.colours = CS_COLOURS_STRAIN,
                                           .stops = strain_stops,
                                           .title = "strain %",
                                           .unit = "",
                                           .factor = 100,
                                           .has_sign = true};
static const struct cs_look_kind goals = {.colours = CS_COLOURS_FAINT, .goals = true};
static const struct cs_look_kind crossings = {.colours = CS_COLOURS_CROSSINGS,
                                              .stops = mark_stops};

const struct cs_look_kind *cs_look_of(int32_t look) {
#define X(NAME, name) [CS_LOOK_##NAME] = &name,
    static const struct cs_look_kind *const kinds[] = {CS_LOOK_LIST(X)};
#undef X
    return kinds[look];
}
