/* style.c - how bodies and colliders look, from their tables in the scene. */
#include "draw/style.h"

#include "draw/matrix.h"

bool cs_look_has_values(int32_t look) {
    return look == CS_LOOK_FORCE || look == CS_LOOK_STRAIN;
}

void cs_style_cloth(struct cs_surface_style *style, const struct cs_material *material,
                    bool textured, int32_t look) {
    const bool has_back = !isnan(material->back_colour[0]);
    *style = (struct cs_surface_style){.ambient = material->ambient,
                                       .diffuse = material->diffuse,
                                       .specular = material->specular,
                                       .shininess = material->shininess,
                                       .scale = 1};
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

void cs_style_solid(struct cs_surface_style *style, const struct cs_collider *collider,
                    double cell) {
    const struct cs_sphere *sphere = &collider->sphere;
    *style = (struct cs_surface_style){
        .ambient = 1, .diffuse = 1, .specular = 0.04, .shininess = 12, .scale = 1};
    memcpy(style->front, collider->colour, sizeof style->front);
    memcpy(style->back, collider->colour, sizeof style->back);
    style->fade = collider->floor.present ? collider->floor.extent : 0;
    if (!sphere->present)
        return;
    memcpy(style->centre, sphere->centre, sizeof style->centre);
    style->scale = sphere->radius;
    // three times the height of a chord of one diagonal, for cloth seen at a slant
    style->sink = fmin(3 * cell * cell / (4 * sphere->radius), sphere->radius / 4);
    style->specular = 0.22;
    style->shininess = 40;
}

// a square about `middle`, seen from the side of the normal
static void make_square(struct cs_vertex corners[6], const double middle[3],
                        const double normal[3], double extent, double sink) {
    static const signed char signs[6][2] = {{-1, -1}, {1, -1}, {1, 1},
                                            {-1, -1}, {1, 1},  {-1, 1}};
    double across[3], third[3];
    cs_frame_across(normal, across, third);
    for (int k = 0; k < 6; k++) {
        for (int i = 0; i < 3; i++) {
            const double side = signs[k][0] * across[i] + signs[k][1] * third[i];
            corners[k].place[i] = (float)(middle[i] + extent * side - sink * normal[i]);
            corners[k].normal[i] = (float)normal[i];
        }
        corners[k].value = 0;
    }
}

bool cs_solid_square(const struct cs_collider *collider, double cell,
                     struct cs_vertex corners[6]) {
    static const double up[3] = {0, 1, 0};
    const double middle[3] = {0, collider->floor.height, 0};
    // a little below its place, or it would show through cloth that lies on it
    const double sink = 0.03 * cell;
    if (!collider->visible)
        return false;
    if (collider->plane.present)
        make_square(corners, collider->plane.point, collider->plane.normal,
                    collider->plane.extent, sink);
    else if (collider->floor.present)
        make_square(corners, middle, up, collider->floor.extent, sink);
    return collider->plane.present || collider->floor.present;
}
