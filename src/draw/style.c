/* Derives the looks of bodies and colliders from their tables in the scene. */
#include "draw/style.h"

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
                                       .folds = look == CS_LOOK_LIT};
    memcpy(style->front, material->colour, sizeof style->front);
    memcpy(style->back, has_back ? material->back_colour : material->colour,
           sizeof style->back);
    if (cs_look_has_values(look))
        style->mode = CS_SURFACE_VALUE;
    else if (look != CS_LOOK_LIT)
        style->mode = CS_SURFACE_FAINT;
    else if (textured)
        style->mode = CS_SURFACE_TEXTURED;
}

void cs_style_solid(struct cs_surface_style *style, const struct cs_obstacle *obstacle,
                    double cell) {
    const struct cs_collider *collider = obstacle->collider;
    const struct cs_shape *shape = obstacle->shape;
    const bool flat = cs_shape_is_endless(shape);
    *style = (struct cs_surface_style){.ambient = 1,
                                       .diffuse = 1,
                                       .specular = flat ? 0.04 : 0.22,
                                       .shininess = flat ? 12 : 40};
    memcpy(style->front, collider->colour, sizeof style->front);
    memcpy(style->back, collider->colour, sizeof style->back);
    style->fade = collider->floor.present ? collider->floor.extent : 0;
    style->sink = shape->chord_depth ? shape->chord_depth(obstacle, cell) : 0;
}
