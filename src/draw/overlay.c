/* Draws everything of a picture that consists of lines. */
#include "draw/overlay.h"

#include "draw/look.h"
#include "draw/matrix.h"
#include "draw/mesh.h"
#include "draw/srgb.h"
#include "draw/view.h"
#include "mesh/trimesh.h"
#include "model/event/event_state.h"
#include "model/system/seams.h"
#include "scene/body_keys.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <string.h>

/* A style in the colour 0xRRGGBB, of lines moved towards the eye by so many depth offsets. */
static struct cs_line_style style_of(const struct cs_overlay *overlay, uint32_t colour,
                                     double alpha, double offsets) {
    struct cs_line_style style = {.alpha = alpha,
                                  .depth_offset = offsets * overlay->depth_offset};
    cs_colour_linear(colour, style.colour);
    return style;
}

/* Draws the added lines, of a width given by its half in pixels. */
static void draw_lines(const struct cs_overlay *overlay, struct cs_line_style style,
                       double half_width) {
    style.half_width = half_width;
    cs_lines_draw(overlay->lines, &style);
}

/* Draws bodies as lines: edges, springs by kind, pins, goals and threads. */

/* Edges of a body's surface: of its mesh, or between neighbours of its grid. */
static uint32_t edges_of(const struct cs_body_range *body) {
    if (body->mesh)
        return body->mesh->n_edges;
    return (body->columns - 1) * body->rows + body->columns * (body->rows - 1);
}

/* Lines that the largest of the calls below adds between two draws. */
static uint32_t max_lines(const struct cs_system *system) {
    uint32_t most = system->springs.n > system->view.n ? system->springs.n : system->view.n;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const uint32_t edges = edges_of(system->bodies + b);
        most = edges > most ? edges : most;
    }
    return system->seams && system->seams->n_ends > most ? system->seams->n_ends : most;
}

/* Adds a line between particles a and b of the system; a dot if they are one. */
static void add_wire(const struct cs_overlay *overlay, const double *x, uint32_t a,
                     uint32_t b) {
    double from[3], to[3];
    cs_mesh_position(overlay->system->view.n, x, a, from);
    cs_mesh_position(overlay->system->view.n, x, b, to);
    cs_lines_add(overlay->lines, from, to);
}

/* Adds a dot for each particle whose mark is `value`, of (n). */
static void add_dots(const struct cs_overlay *overlay, const double *x, const uint8_t *marks,
                     uint8_t value) {
    for (uint32_t i = 0; i < overlay->system->view.n; i++)
        if (marks[i] == value)
            add_wire(overlay, x, i, i);
}

/* Which edges are added: all, or with `rim` those between two of its particles. While
 * `free_from` is set, none: held particles with a free neighbour are marked in the rim instead.
 */
struct choice {
    uint8_t *rim;            /* (n) */
    const double *free_from; /* (n) 1/kg, 0: held; NULL: the rim is marked */
};

static const struct choice all = {NULL, NULL};

static void add_edge(const struct cs_overlay *overlay, const double *x,
                     const struct choice *choice, const uint32_t ends[2]) {
    const uint32_t a = ends[0], b = ends[1];
    const double *inv_mass = choice->free_from;
    if (inv_mass && (inv_mass[a] == 0) != (inv_mass[b] == 0))
        choice->rim[inv_mass[a] == 0 ? a : b] = 1;
    if (!inv_mass && (!choice->rim || (choice->rim[a] && choice->rim[b])))
        add_wire(overlay, x, a, b);
}

/* Adds the edges of body b that are chosen, at most as many as edges_of counts. */
static void add_edges(const struct cs_overlay *overlay, const double *x, uint32_t b,
                      const struct choice *choice) {
    const struct cs_body_range *body = overlay->system->bodies + b;
    for (uint32_t e = 0; body->mesh && e < body->mesh->n_edges; e++) {
        const uint32_t *own = body->mesh->edges + 2 * (size_t)e;
        add_edge(overlay, x, choice, (uint32_t[2]){body->first + own[0], body->first + own[1]});
    }
    for (uint32_t row = 0; row < body->rows; row++)
        for (uint32_t column = 0; column < body->columns; column++) {
            const uint32_t i = body->first + row * body->columns + column;
            if (column + 1 < body->columns)
                add_edge(overlay, x, choice, (uint32_t[2]){i, i + 1});
            if (row + 1 < body->rows)
                add_edge(overlay, x, choice, (uint32_t[2]){i, i + body->columns});
        }
}

/* Half a line's width in pixels: the fraction `share` of the cell, so that fine grids keep
 * gaps, limited to least..most units. */
static double width_of(const struct cs_overlay *overlay, double share, double least,
                       double most) {
    return fmin(fmax(share * overlay->cell, least * overlay->line_unit),
                most * overlay->line_unit);
}

static void draw_edges(const struct cs_overlay *overlay, const double *x) {
    for (uint32_t b = 0; b < overlay->system->scene->bodies.n; b++) {
        // darkened to ink that still tells bodies apart
        const double *colour = cs_scene_bodies(overlay->system->scene)[b].material.colour;
        struct cs_line_style style = {.alpha = 0.9, .depth_offset = overlay->depth_offset};
        for (int i = 0; i < 3; i++)
            style.colour[i] = (float)(0.012 + 0.45 * colour[i]);
        add_edges(overlay, x, b, &all);
        draw_lines(overlay, style, width_of(overlay, 0.07, 0.35, 0.8));
    }
}

static void draw_springs(const struct cs_overlay *overlay, const double *x) {
    // Layers from back to front. Bend springs run along two stretch springs: wide and pale
    // below them, they frame them. Surface springs of a network are pale, or they would hide
    // its inside.
    enum { ALL, PLAIN, NETWORK };
    static const struct {
        uint32_t kind, of, colour;
        double alpha, share, least, most;
    } layers[] = {{CS_SPRING_STRETCH, NETWORK, 0xc8321f, 0.25, 0.05, 0.3, 0.6},
                  {CS_SPRING_BEND, ALL, 0x6fb3e8, 0.55, 0.17, 0.8, 2.4},
                  {CS_SPRING_SHEAR, NETWORK, 0x1f7f4d, 0.3, 0.05, 0.25, 0.5},
                  {CS_SPRING_SHEAR, PLAIN, 0x2f9e62, 0.85, 0.05, 0.3, 0.7},
                  {CS_SPRING_STRETCH, PLAIN, 0xc8321f, 0.95, 0.07, 0.4, 0.9}};
    const struct cs_springs *springs = &overlay->system->springs;
    const struct cs_body *bodies = cs_scene_bodies(overlay->system->scene);
    for (size_t k = 0; k < sizeof layers / sizeof *layers; k++) {
        for (uint32_t r = 0; r < springs->n_runs; r++) {
            const struct cs_spring_run *run = springs->runs + r;
            const uint32_t of = bodies[run->body].network.present ? NETWORK : PLAIN;
            if (run->kind != layers[k].kind || (layers[k].of != ALL && layers[k].of != of))
                continue;
            for (uint32_t i = 0; i < run->count; i++)
                add_wire(overlay, x, cs_spring_a(run, i), cs_spring_b(run, i));
        }
        draw_lines(overlay, style_of(overlay, layers[k].colour, layers[k].alpha, 1),
                   width_of(overlay, layers[k].share, layers[k].least, layers[k].most));
    }
}

// stitches that are not broken
static void draw_seams(const struct cs_overlay *overlay, const double *x) {
    const struct cs_seams *seams = overlay->system->seams;
    for (uint32_t s = 0; seams && s < seams->n; s++)
        for (uint32_t k = 1; k < seams->stitches[s].n && !seams->broken[s]; k++)
            add_wire(overlay, x, seams->stitches[s].at[0], seams->stitches[s].at[k]);
    if (seams)
        draw_lines(overlay, style_of(overlay, 0x6a2fa8, 1, 2), width_of(overlay, 0.14, 0.8, 2));
}

static void draw_pins(const struct cs_overlay *overlay, const double *x,
                      const double *inv_mass) {
    // a light disc with a dark border
    static const uint32_t colours[2] = {0x1d2733, 0xffd34d};
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < overlay->system->view.n; i++)
            if (inv_mass[i] == 0)
                add_wire(overlay, x, i, i);
        draw_lines(overlay, style_of(overlay, colours[pass], 1, 2),
                   width_of(overlay, 0.4, 2.2, 5) - pass * 1.1 * overlay->line_unit);
    }
}

/* Draws rods between held particles with a free neighbour, and pegs on these. */
static void draw_pegs(const struct cs_overlay *overlay, const double *x,
                      const double *inv_mass) {
    const struct cs_line_style style = style_of(overlay, 0x3b444f, 1, 2);
    struct choice choice = {overlay->rim, inv_mass};
    const uint32_t bodies = overlay->system->scene->bodies.n;
    memset(overlay->rim, 0, overlay->system->view.n);
    for (uint32_t b = 0; b < bodies; b++)
        add_edges(overlay, x, b, &choice);
    // rods, then pegs
    choice.free_from = NULL;
    for (uint32_t b = 0; b < bodies; b++)
        add_edges(overlay, x, b, &choice);
    draw_lines(overlay, style, 1.1 * overlay->line_unit);
    add_dots(overlay, x, overlay->rim, 1);
    draw_lines(overlay, style, 1.9 * overlay->line_unit);
}

/* Draws a line from each particle to its goal, and a dot there. A particle at its goal has the
 * dot alone. */
static void draw_goals(const struct cs_overlay *overlay, const double *x, const double *goals) {
    const struct cs_system *system = overlay->system;
    /* two passes: the dots of every body lie over the lines of all */
    for (int dots = 0; dots < 2; dots++) {
        for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
            const struct cs_body_range *body = system->bodies + b;
            if (!cs_scene_bodies(system->scene)[b].shape_matching.present)
                continue;
            for (uint32_t i = body->first; i < body->first + body->count; i++) {
                double from[3], goal[3];
                cs_mesh_position(system->view.n, dots ? goals : x, i, from);
                cs_mesh_position(system->view.n, goals, i, goal);
                cs_lines_add(overlay->lines, from, goal);
            }
        }
        if (dots)
            draw_lines(overlay, style_of(overlay, 0xc8321f, 0.95, 1),
                       width_of(overlay, 0.11, 0.5, 1.8));
        else
            draw_lines(overlay, style_of(overlay, 0x2b5fa8, 0.75, 1),
                       width_of(overlay, 0.06, 0.35, 0.8));
    }
}

/* Draws bodies of one row or column of particles, which have no surface, as a thread with
 * knots. */
static void draw_threads(const struct cs_overlay *overlay, const double *x) {
    for (uint32_t b = 0; b < overlay->system->scene->bodies.n; b++) {
        const struct cs_body_range *body = overlay->system->bodies + b;
        const double *colour = cs_scene_bodies(overlay->system->scene)[b].material.colour;
        struct cs_line_style style = {.alpha = 1};
        if (body->mesh || (body->columns > 1 && body->rows > 1))
            continue;
        for (int i = 0; i < 3; i++)
            style.colour[i] = (float)colour[i];
        add_edges(overlay, x, b, &all);
        draw_lines(overlay, style, overlay->line_unit);
        for (uint32_t i = 0; i < body->count; i++)
            add_wire(overlay, x, body->first + i, body->first + i);
        draw_lines(overlay, style, width_of(overlay, 0.3, 1.5, 5));
    }
}

/* Viewpoint forces drawn over a picture: viewpoint, rectangle, particles
 * affected.
 */

// true if the force acted since the picture before: a picture shows the time that ends with it
static bool was_active(const struct cs_system *system,
                       const struct cs_viewpoint_force_state *state, double t) {
    const struct cs_event_state *of = system->events->states + state->event;
    const double blow = of->begin + 1 / system->scene->time.fps + CS_EVENT_SAME;
    return of->begin < t && t <= (of->end > of->begin ? of->end : blow);
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
                visibility->eye[c] + cs_vec3_length(view) * (right[k] * visibility->axes[0][c] +
                                                             up[k] * visibility->axes[1][c] +
                                                             visibility->axes[2][c]);
}

// dots, then lines from the eye, then the rectangle in front of all
static void draw_viewpoint(const struct cs_overlay *overlay,
                           const struct cs_viewpoint_force_state *state, const double *x) {
    struct cs_line_style style = style_of(overlay, 0xff5a00, 1, 2);
    double corners[4][3];
    for (uint32_t i = 0; i < overlay->system->view.n; i++)
        if (state->is_visible[i])
            add_wire(overlay, x, i, i);
    draw_lines(overlay, style, width_of(overlay, 0.16, 0.9, 3));
    find_corners(overlay->system, state, corners);
    for (int k = 0; k < 4; k++)
        cs_lines_add(overlay->lines, state->query.eye, corners[k]);
    draw_lines(overlay, style, 0.6 * overlay->line_unit);
    for (int k = 0; k < 4; k++)
        cs_lines_add(overlay->lines, corners[k], corners[(k + 1) % 4]);
    style.on_top = true;
    draw_lines(overlay, style, 0.6 * overlay->line_unit);
}

/* Marks each viewpoint force that acted in the frame that ends now: dots on the particles that
 * it saw last; its rectangle at the distance of its target, in front of all; and lines from the
 * eye to its corners. Seen from the same viewpoint, that is the rectangle alone. */
static void draw_viewpoint_forces(const struct cs_overlay *overlay,
                                  const struct cs_frame *frame) {
    const struct cs_events *events = overlay->system->events;
    for (uint32_t k = 0; events && events->viewpoint_forces && k < events->viewpoint_forces->n;
         k++)
        if (was_active(overlay->system, events->viewpoint_forces->states + k, frame->t))
            draw_viewpoint(overlay, events->viewpoint_forces->states + k, frame->x);
}

/* Red discs with a light border in front of all, those of the neighbours first (cloth thesis,
 * fig. 6.4). */
static void draw_marks(const struct cs_overlay *overlay, const double *x) {
    for (int k = 0; k < 4; k++) {
        struct cs_line_style style = style_of(overlay, k % 2 ? 0xd0121b : 0xffffff, 1, 0);
        style.on_top = true;
        add_dots(overlay, x, overlay->marks, (uint8_t)(1 + k / 2));
        draw_lines(overlay, style,
                   (k < 2 ? 3 : 5.5) * overlay->line_unit - k % 2 * overlay->line_unit);
    }
}

enum cs_status cs_overlay_init(struct cs_overlay *overlay, const struct cs_system *system,
                               double pixels_per_m, struct cs_lines *lines,
                               struct cs_arena *arena, struct cs_error *error) {
    const struct cs_render *render = system->scene->render;
    const uint32_t most = max_lines(system);
    overlay->lines = lines;
    overlay->system = system;
    overlay->line_unit = fmax((double)render->size[1] / 480, 0.5);
    overlay->depth_offset = 0.12 * cs_scene_extent_cell(system);
    overlay->rim = cs_arena_alloc_array(arena, system->view.n, 1, error);
    if (error->status)
        return error->status;
    cs_overlay_aim(overlay, pixels_per_m);
    cs_colour_bar_init(&overlay->colour_bar, render);
    return cs_lines_init(lines, most > CS_COLOUR_BAR_LINES ? most : CS_COLOUR_BAR_LINES, arena,
                         error);
}

void cs_overlay_aim(struct cs_overlay *overlay, double pixels_per_m) {
    overlay->cell = cs_scene_extent_cell(overlay->system) * pixels_per_m;
}

bool cs_overlay_hides(const struct cs_scene *scene, uint32_t body) {
    return cs_look_of(scene->render->look)->springs &&
           cs_scene_bodies(scene)[body].network.present;
}

void cs_overlay_draw(const struct cs_overlay *overlay, const struct cs_frame *frame) {
    const struct cs_render *render = overlay->system->scene->render;
    const struct cs_look_kind *look = cs_look_of(render->look);
    draw_threads(overlay, frame->x);
    if (look->edges)
        draw_edges(overlay, frame->x);
    if (look->springs) {
        draw_springs(overlay, frame->x);
        draw_seams(overlay, frame->x);
        draw_pins(overlay, frame->x, frame->inv_mass);
    }
    if (render->pins && !look->springs && frame->inv_mass)
        draw_pegs(overlay, frame->x, frame->inv_mass);
    if (look->goals && frame->goals)
        draw_goals(overlay, frame->x, frame->goals);
    if (render->viewpoint_forces)
        draw_viewpoint_forces(overlay, frame);
    if (overlay->marks)
        draw_marks(overlay, frame->x);
    if (frame->title)
        cs_colour_bar_draw(&overlay->colour_bar, overlay->lines, frame);
}
