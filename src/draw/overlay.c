/* Draws everything of a picture that consists of lines. */
#include "draw/overlay.h"

#include "draw/look.h"
#include "draw/scene_extent.h"
#include "draw/surface_style.h"
#include "draw/viewpoint_forces.h"

#include <math.h>

enum cs_status cs_overlay_init(struct cs_overlay *overlay, const struct cs_system *system,
                               double pixels_per_m, struct cs_lines *lines,
                               struct cs_arena *arena, struct cs_error *error) {
    const struct cs_render *render = &system->scene->render;
    const double cell = cs_scene_extent_cell(system);
    const uint32_t most = cs_wireframe_capacity(system);
    overlay->lines = lines;
    overlay->wireframe =
        (struct cs_wireframe){.system = system,
                              .line_unit = fmax((double)render->size[1] / 480, 0.5),
                              .depth_offset = 0.12 * cell};
    cs_overlay_aim(overlay, pixels_per_m);
    cs_colour_bar_init(&overlay->colour_bar, render);
    return cs_lines_init(lines, most > CS_COLOUR_BAR_LINES ? most : CS_COLOUR_BAR_LINES, arena,
                         error);
}

void cs_overlay_aim(struct cs_overlay *overlay, double pixels_per_m) {
    overlay->wireframe.cell = cs_scene_extent_cell(overlay->wireframe.system) * pixels_per_m;
}

bool cs_overlay_hides(const struct cs_scene *scene, uint32_t body) {
    return cs_look_of(scene->render.look)->springs &&
           cs_scene_bodies(scene)[body].network.present;
}

void cs_overlay_draw(const struct cs_overlay *overlay, const struct cs_frame *frame) {
    const struct cs_render *render = &overlay->wireframe.system->scene->render;
    const struct cs_look_kind *look = cs_look_of(render->look);
    const struct cs_wireframe *net = &overlay->wireframe;
    struct cs_lines *lines = overlay->lines;
    cs_wireframe_draw_threads(net, lines, frame->x);
    if (look->edges)
        cs_wireframe_draw_edges(net, lines, frame->x);
    if (look->springs) {
        cs_wireframe_draw_springs(net, lines, frame->x);
        cs_wireframe_draw_pins(net, lines, frame->x, frame->inv_mass);
    }
    if (look->goals && frame->goals)
        cs_wireframe_draw_goals(net, lines, frame->x, frame->goals);
    if (render->viewpoint_forces)
        cs_viewpoint_forces_draw(net, lines, frame);
    if (frame->title)
        cs_colour_bar_draw(&overlay->colour_bar, lines, frame);
}
