/* The table of looks, the colours of their values, and styles from the keys of a scene. */
#include "draw/look.h"

#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/picture_keys.h"

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
static const struct cs_look_kind stress = {.colours = CS_COLOURS_STRESS,
                                           .stops = strain_stops,
                                           .title = "stress N/m",
                                           .unit = "N/m",
                                           .factor = 1,
                                           .has_sign = true};
static const struct cs_look_kind normals = {.colours = CS_COLOURS_NORMALS};
static const struct cs_look_kind uv = {.colours = CS_COLOURS_UV};
static const struct cs_look_kind goals = {.colours = CS_COLOURS_FAINT, .goals = true};
static const struct cs_look_kind crossings = {.colours = CS_COLOURS_CROSSINGS,
                                              .stops = mark_stops};

const struct cs_look_kind *cs_look_of(int32_t look) {
#define X(NAME, name) [CS_LOOK_##NAME] = &name,
    static const struct cs_look_kind *const kinds[] = {CS_LOOK_LIST(X)};
#undef X
    return kinds[look];
}

bool cs_look_needs_uv(int32_t look, bool textured) {
    return textured || cs_look_of(look)->colours == CS_COLOURS_UV;
}

const double *cs_look_repeat(int32_t look, const struct cs_material *material) {
    static const double once[2] = {1, 1};
    return cs_look_of(look)->colours == CS_COLOURS_UV ? once : material->texture_repeat;
}

void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look) {
    const enum cs_look_colours colours = cs_look_of(look)->colours;
    static const double red[3] = CS_CLOTH_RED, white[3] = {1, 1, 1};
    const bool has_back = !isnan(material->back_colour[0]);
    *style = (struct cs_surface_style){.ambient = material->ambient,
                                       .diffuse = material->diffuse,
                                       .specular = material->specular,
                                       .shininess = material->shininess,
                                       .has_ambient_occlusion = colours == CS_COLOURS_MATERIAL};
    // the default colour would hide those of a texture
    const double *colour =
        textured && !memcmp(material->colour, red, sizeof red) ? white : material->colour;
    memcpy(style->front_colour, colour, sizeof style->front_colour);
    memcpy(style->back_colour, has_back ? material->back_colour : colour,
           sizeof style->back_colour);
    switch (colours) {
    case CS_COLOURS_MATERIAL:
        style->mode = textured ? CS_SURFACE_TEXTURED : CS_SURFACE_PLAIN;
        break;
    case CS_COLOURS_FAINT:
        style->mode = CS_SURFACE_FAINT;
        break;
    case CS_COLOURS_NORMALS:
        style->mode = CS_SURFACE_NORMALS;
        break;
    case CS_COLOURS_UV:
        style->mode = CS_SURFACE_UV;
        break;
    case CS_COLOURS_FORCE:
    case CS_COLOURS_STRAIN:
    case CS_COLOURS_STRESS:
    case CS_COLOURS_CROSSINGS:
        style->mode = CS_SURFACE_VALUE;
    }
}

/* Specular coefficients and shininess of colliders were chosen by trial: planes dull, others
 * glossy. */
void cs_style_solid(struct cs_surface_style *style, const struct cs_posed_collider *posed,
                    double cell) {
    const struct cs_collider *collider = posed->collider;
    const struct cs_shape *shape = posed->shape;
    const bool flat = cs_shape_is_endless(shape);
    *style = (struct cs_surface_style){.ambient = 1,
                                       .diffuse = 1,
                                       .specular = flat ? 0.04 : 0.22,
                                       .shininess = flat ? 12 : 40};
    memcpy(style->front_colour, collider->colour, sizeof style->front_colour);
    memcpy(style->back_colour, collider->colour, sizeof style->back_colour);
    style->depth_bias = shape->chord_depth ? shape->chord_depth(posed, cell) : 0;
}
