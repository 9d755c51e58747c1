/* Derives the looks of bodies and colliders from their tables in the scene. */
#include "draw/surface_style.h"

#include "draw/look.h"
#include "draw/matrix.h"

void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look) {
    const enum cs_look_colours colours = cs_look_of(look)->colours;
    const bool has_back = !isnan(material->back_colour[0]);
    *style = (struct cs_surface_style){.ambient = material->ambient,
                                       .diffuse = material->diffuse,
                                       .specular = material->specular,
                                       .shininess = material->shininess,
                                       .has_ambient_occlusion = colours == CS_COLOURS_MATERIAL};
    memcpy(style->front_colour, material->colour, sizeof style->front_colour);
    memcpy(style->back_colour, has_back ? material->back_colour : material->colour,
           sizeof style->back_colour);
    switch (colours) {
    case CS_COLOURS_MATERIAL:
        style->mode = textured ? CS_SURFACE_TEXTURED : CS_SURFACE_PLAIN;
        break;
    case CS_COLOURS_FAINT:
        style->mode = CS_SURFACE_FAINT;
        break;
    case CS_COLOURS_FORCE:
    case CS_COLOURS_STRAIN:
    case CS_COLOURS_CROSSINGS:
        style->mode = CS_SURFACE_VALUE;
    }
}

void cs_style_solid(struct cs_surface_style *style, const struct cs_posed_collider *obstacle,
                    double cell) {
    const struct cs_collider *collider = obstacle->collider;
    const struct cs_shape *shape = obstacle->shape;
    const bool flat = cs_shape_is_endless(shape);
    *style = (struct cs_surface_style){.ambient = 1,
                                       .diffuse = 1,
                                       .specular = flat ? 0.04 : 0.22,
                                       .shininess = flat ? 12 : 40};
    memcpy(style->front_colour, collider->colour, sizeof style->front_colour);
    memcpy(style->back_colour, collider->colour, sizeof style->back_colour);
    style->fade_radius = collider->floor.present ? collider->floor.extent : 0;
    style->depth_bias = shape->chord_depth ? shape->chord_depth(obstacle, cell) : 0;
}
