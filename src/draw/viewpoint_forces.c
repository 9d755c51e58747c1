/* Draws viewpoint forces over a picture: viewpoint, rectangle and the particles affected. */
#include "draw/viewpoint_forces.h"

#include "draw/colour.h"
#include "draw/matrix.h"
#include "draw/mesh.h"
#include "model/event/event_times.h"
#include "model/event/viewpoint_forces.h"

// true if the force acted since the picture before: a picture shows the time that ends with it
static bool was_active(const struct cs_system *system,
                       const struct cs_viewpoint_force_state *state, double t) {
    const struct cs_event_state *of = system->events->states + state->event;
    const double blow = of->begin + 1 / system->scene->time.fps + CS_EVENT_SAME;
    return of->begin < t && t <= (of->end > of->begin ? of->end : blow);
}

// adds a dot for each particle that was visible at the last test
static void add_visible(const struct cs_wireframe *net, struct cs_lines *lines,
                        const struct cs_viewpoint_force_state *state, const double *x) {
    double place[3];
    for (uint32_t i = 0; i < net->system->view.n; i++)
        if (state->is_visible[i]) {
            cs_mesh_position(net->system->view.n, x, i, place);
            cs_lines_add(lines, place, place);
        }
}

/* Corners of the rectangle in the plane through the target at right angles to the view. low and
 * high are slopes of its sides: eye + distance (right a_0 + up a_1 + a_2) with the view's
 * axes. */
static void find_corners(const struct cs_system *system,
                         const struct cs_viewpoint_force_state *state, double corners[4][3]) {
    const struct cs_visibility_query *visibility = &state->query;
    const struct cs_viewpoint_force *viewpoint_force =
        &cs_scene_events(system->scene)[state->event].viewpoint_force;
    const double right[4] = {visibility->low[0], visibility->high[0], visibility->high[0],
                             visibility->low[0]};
    const double up[4] = {visibility->low[1], visibility->low[1], visibility->high[1],
                          visibility->high[1]};
    double view[3];
    cs_subtract(viewpoint_force->viewpoint.target, visibility->eye, view);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            corners[k][c] =
                visibility->eye[c] +
                cs_length(view) * (right[k] * visibility->axes[0][c] +
                                   up[k] * visibility->axes[1][c] + visibility->axes[2][c]);
}

// dots, then lines from the eye, then the rectangle in front of all
static void draw(const struct cs_wireframe *net, struct cs_lines *lines,
                 const struct cs_viewpoint_force_state *state, const double *x) {
    struct cs_line_style style = {.alpha = 1, .depth_offset = 2 * net->depth_offset};
    double corners[4][3];
    cs_colour_linear(0xff5a00, style.colour);
    style.half_width = cs_wireframe_width(net, 0.16, 0.9, 3);
    add_visible(net, lines, state, x);
    cs_lines_draw(lines, &style);

    style.half_width = 0.6 * net->line_unit;
    find_corners(net->system, state, corners);
    for (int k = 0; k < 4; k++)
        cs_lines_add(lines, state->query.eye, corners[k]);
    cs_lines_draw(lines, &style);
    for (int k = 0; k < 4; k++)
        cs_lines_add(lines, corners[k], corners[(k + 1) % 4]);
    style.on_top = true;
    cs_lines_draw(lines, &style);
}

void cs_viewpoint_forces_draw(const struct cs_wireframe *net, struct cs_lines *lines,
                              const struct cs_frame *frame) {
    const struct cs_events *events = net->system->events;
    for (uint32_t k = 0; events && events->viewpoint_forces && k < events->viewpoint_forces->n;
         k++)
        if (was_active(net->system, events->viewpoint_forces->states + k, frame->t))
            draw(net, lines, events->viewpoint_forces->states + k, frame->x);
}
