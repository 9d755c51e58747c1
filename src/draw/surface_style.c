/* Derives the looks of bodies and colliders from their tables in the scene. */
#include "draw/surface_style.h"

#include "draw/matrix.h"

bool cs_look_has_values(int32_t look) {
    return look == CS_LOOK_FORCE || look == CS_LOOK_STRAIN || look == CS_LOOK_CROSSINGS;
}

void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look) {
    const bool has_back = !isnan(material->back_colour[0]);
    *style = (struct cs_surface_style){.ambient = material->ambient,
                                       .diffuse = material->diffuse,
                                       .specular = material->specular,
                                       .shininess = material->shininess,
                                       .has_ambient_occlusion = look == CS_LOOK_LIT};
    memcpy(style->front_colour, material->colour, sizeof style->front_colour);
    memcpy(style->back_colour, has_back ? material->back_colour : material->colour,
           sizeof style->back_colour);
    if (cs_look_has_values(look))
        style->mode = CS_SURFACE_VALUE;
    else if (look != CS_LOOK_LIT)
        style->mode = CS_SURFACE_FAINT;
    else if (textured)
        style->mode = CS_SURFACE_TEXTURED;
}

/* three times the height of a chord of one diagonal, for cloth seen at a slant */
static double chord(double cell, double radius) {
    return fmin(3 * cell * cell / (4 * radius), radius / 4);
}

/* how far cloth may cut into a collider between its particles */
static double depth_bias_of(const struct cs_posed_collider *obstacle, double cell) {
    const double *core = obstacle->half_sizes, radius = obstacle->radius;
    const double least = fmin(core[0], fmin(core[1], core[2])) + radius;
    switch (obstacle->kind) {
    case CS_COLLIDER_PLANE:
    case CS_COLLIDER_MESH:
        // cloth keeps off the triangles of a mesh
        return 0;
    case CS_COLLIDER_BOX:
        // a chord of one diagonal over a sharp edge
        return fmin(0.5 * cell, least / 4);
    case CS_COLLIDER_SPHERE:
    case CS_COLLIDER_CAPSULE:
        return chord(cell, radius);
    }
    return 0;
}

void cs_style_solid(struct cs_surface_style *style, const struct cs_posed_collider *obstacle,
                    double cell) {
    const struct cs_collider *collider = obstacle->collider;
    const bool flat = obstacle->kind == CS_COLLIDER_PLANE;
    *style = (struct cs_surface_style){.ambient = 1,
                                       .diffuse = 1,
                                       .specular = flat ? 0.04 : 0.22,
                                       .shininess = flat ? 12 : 40};
    memcpy(style->front_colour, collider->colour, sizeof style->front_colour);
    memcpy(style->back_colour, collider->colour, sizeof style->back_colour);
    style->fade_radius = collider->floor.present ? collider->floor.extent : 0;
    style->depth_bias = depth_bias_of(obstacle, cell);
}
