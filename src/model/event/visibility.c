/* visibility.c - visibility from a viewpoint: selects the particles inside the rectangle that
 * no triangle and no collider occludes.
 *
 * The steps of one query:
 * 1. Positions are expressed in the axes of the eye: p = (right, up, forward).
 * 2. Particles with an image p_x/p_z, p_y/p_z outside the rectangle drop out, then those
 *    behind a visible collider. The others are the candidates.
 * 3. Candidates are sorted into a uniform grid over the bounds of their images, about one per
 *    cell.
 * 4. Each triangle of every body is tested against the candidates in the cells that its image
 *    covers.
 *
 * With n candidates and images of triangles of about a cell the cost is O(n) for tests
 * instead of O(n^2).
 *
 * The occlusion test needs no division. For corners a, b, c as seen from the eye the line to
 * p passes through the triangle if p.(a x b), p.(b x c) and p.(c x a) have the same sign. It
 * meets the plane of the triangle at the fraction a.(b x c) / (sum of the three) of its
 * length. */
#include "model/event/event_state.h"

#include "base/portable_sine.h"
#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "model/system/surfaces.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* The fraction of the line to a particle that is tested; see cs_visibility_query_run. */
#define REACH (1 - 1e-9)
/* Fraction of a cell, or of the grid, by which a triangle's bounds are widened: far above
 * rounding (2e-16), far below a cell. */
#define MARGIN 1e-6

/* The image plane is at distance 1: a point (right, up, forward) has the image (right /
 * forward, up / forward). Its half height is tan(fov / 2), as a quotient of sines that have the
 * same bits everywhere; the rectangle is given from the top left in 0..1. */
void cs_visibility_query_make(struct cs_visibility_query *visibility,
                              const struct cs_viewpoint_force *viewpoint_force) {
    const struct cs_viewpoint *from = &viewpoint_force->viewpoint;
    const double slope =
        cs_quarter_sine(from->fov / 180) / cs_quarter_sine(1 - from->fov / 180);
    const double *rectangle = viewpoint_force->rectangle;
    double(*axes)[3] = visibility->axes;
    for (int c = 0; c < 3; c++) {
        visibility->eye[c] = from->eye[c];
        axes[2][c] = from->target[c] - from->eye[c];
    }
    cs_vec3_normalise(axes[2]);
    cs_vec3_cross(axes[2], from->up, axes[0]);
    cs_vec3_normalise(axes[0]);
    cs_vec3_cross(axes[0], axes[2], axes[1]);
    visibility->low[0] = (2 * rectangle[0] - 1) * (slope * from->aspect);
    visibility->high[0] = (2 * rectangle[2] - 1) * (slope * from->aspect);
    visibility->low[1] = (1 - 2 * rectangle[3]) * slope;
    visibility->high[1] = (1 - 2 * rectangle[1]) * slope;
}

enum cs_status cs_visibility_scratch_init(struct cs_visibility_scratch *work, uint32_t n,
                                          struct cs_arena *arena, struct cs_error *error) {
    CS_ARENA_ARRAY(arena, work->projected, 3 * (size_t)n, error);
    work->cells = cs_arena_alloc_array(arena, n, sizeof *work->cells, error);
    work->order = cs_arena_alloc_array(arena, n, sizeof *work->order, error);
    CS_ARENA_ARRAY(arena, work->cell_starts, (size_t)n + 1, error);
    return error->status;
}

/* The candidates, sorted into cells x cells over the bounds [low, high] of their images:
 * about one per cell, so that a triangle is tested against a few. scale: cells per unit of
 * image. */
struct grid {
    const struct cs_visibility_scratch *work;
    size_t n;
    uint32_t cells;
    double low[2], high[2], scale[2];
    bool *seen;
};

/* Position i relative to the eye, along its axes. */
static void position_of(const struct cs_visibility_scratch *work, size_t n, size_t i,
                        double p[3]) {
    for (size_t c = 0; c < 3; c++)
        p[c] = work->projected[c * n + i];
}

/* Fills work->projected from x. */
static void turn_positions(const struct cs_visibility_query *visibility,
                           const struct cs_visibility_scratch *work, size_t n,
                           const double *x) {
    for (size_t i = 0; i < n; i++) {
        const double from[3] = {x[i] - visibility->eye[0], x[n + i] - visibility->eye[1],
                                x[2 * n + i] - visibility->eye[2]};
        for (size_t c = 0; c < 3; c++)
            work->projected[c * n + i] = cs_vec3_dot(visibility->axes[c], from);
    }
}

/* True in front of the eye and inside the rectangle; multiplied by p_z > 0 instead of divided.
 */
static bool is_in_rectangle(const struct cs_visibility_query *visibility, const double p[3]) {
    return p[2] > 0 && isfinite(p[0] + p[1] + p[2]) && p[0] >= visibility->low[0] * p[2] &&
           p[0] <= visibility->high[0] * p[2] && p[1] >= visibility->low[1] * p[2] &&
           p[1] <= visibility->high[1] * p[2];
}

/* Removes the candidates of a body that lie in or behind a collider. */
static void hide_behind_collider(const struct cs_visibility_query *visibility,
                                 const struct cs_posed_collider *collider, const double *x,
                                 const struct cs_body_range *body, struct grid *grid) {
    const size_t n = grid->n, end = (size_t)body->first + body->count;
    for (size_t i = body->first; i < end; i++) {
        const double way[3] = {x[i] - visibility->eye[0], x[n + i] - visibility->eye[1],
                               x[2 * n + i] - visibility->eye[2]};
        grid->seen[i] = grid->seen[i] &&
                        !cs_posed_collider_hits_segment(collider, visibility->eye, way, REACH);
    }
}

/* Marks the candidates of a body, widens the grid's bounds by their images, and returns their
 * number. */
static uint32_t mark(const struct cs_visibility_query *visibility,
                     const struct cs_system *system, double t, const double *x,
                     const struct cs_body_range *body, struct grid *grid) {
    const struct cs_list *colliders = &system->scene->colliders;
    const uint32_t end = body->first + body->count;
    uint32_t count = 0;
    double p[3];
    for (uint32_t i = body->first; i < end; i++) {
        position_of(grid->work, grid->n, i, p);
        grid->seen[i] = is_in_rectangle(visibility, p);
    }
    /* colliders first: particles behind them would widen the bounds */
    for (uint32_t k = 0; k < colliders->n; k++) {
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, k, t, &collider);
        if (collider.collider->visible)
            hide_behind_collider(visibility, &collider, x, body, grid);
    }
    for (uint32_t i = body->first; i < end; i++) {
        position_of(grid->work, grid->n, i, p);
        for (int c = 0; c < 2 && grid->seen[i]; c++) {
            grid->low[c] = cs_fmin(grid->low[c], p[c] / p[2]);
            grid->high[c] = cs_fmax(grid->high[c], p[c] / p[2]);
        }
        count += grid->seen[i];
    }
    return count;
}

/* Column (axis 0) or row (axis 1) of an image position, shifted by `move` cells; outside the
 * grid the one at its border. */
static uint32_t line_of(const struct grid *grid, int axis, double image, double move) {
    const double at = (image - grid->low[axis]) * grid->scale[axis] + move;
    return (uint32_t)cs_fmin(cs_fmax(at, 0), grid->cells - 1);
}

/* Sorts the candidates by cell: a counting sort, ascending within each cell. */
static void sort(struct grid *grid, uint32_t count) {
    const struct cs_visibility_scratch *work = grid->work;
    grid->cells = (uint32_t)sqrt(count);
    for (int c = 0; c < 2; c++) {
        const double span = grid->high[c] - grid->low[c];
        grid->scale[c] = span > 0 ? grid->cells / span : 0;
    }
    const uint32_t n_cells = grid->cells * grid->cells;
    memset(work->cell_starts, 0, (n_cells + 1) * sizeof *work->cell_starts);
    for (size_t i = 0; i < grid->n; i++) {
        double p[3];
        if (!grid->seen[i])
            continue;
        position_of(work, grid->n, i, p);
        work->cells[i] =
            line_of(grid, 1, p[1] / p[2], 0) * grid->cells + line_of(grid, 0, p[0] / p[2], 0);
        work->cell_starts[work->cells[i]]++;
    }
    /* counts become ends of cells; filling from the last particle moves them to the starts */
    for (uint32_t c = 1; c <= n_cells; c++)
        work->cell_starts[c] += work->cell_starts[c - 1];
    for (size_t i = grid->n; i-- > 0;)
        if (grid->seen[i])
            work->order[--work->cell_starts[work->cells[i]]] = (uint32_t)i;
}

/* A triangle as seen from the eye: the cells that its image covers, and the data of the
 * occlusion test. */
struct face {
    uint32_t corners[3];
    uint32_t from[2], to[2]; /* column, row */
    double nearest;          /* m along the view */
    double sides[3][3];      /* cross products of corners: normals of the planes of its sides */
    double volume;           /* determinant of the corners */
};

/* Sets face->nearest and the cells of a triangle. Returns false if it hides nothing: behind
 * the eye, off the grid, or not finite. */
static bool bound(const struct grid *grid, double p[3][3], struct face *face) {
    double nearest = HUGE_VAL, farthest = -HUGE_VAL, low[2] = {HUGE_VAL, HUGE_VAL},
           high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int k = 0; k < 3; k++) {
        if (!isfinite(p[k][0] + p[k][1] + p[k][2]))
            return false;
        nearest = cs_fmin(nearest, p[k][2]);
        farthest = cs_fmax(farthest, p[k][2]);
        for (int c = 0; c < 2; c++) {
            low[c] = cs_fmin(low[c], p[k][c] / p[k][2]);
            high[c] = cs_fmax(high[c], p[k][c] / p[k][2]);
        }
    }
    if (farthest <= 0)
        return false;
    face->nearest = nearest;
    for (int c = 0; c < 2; c++) {
        /* a triangle that reaches behind the eye has an unbounded image: all cells */
        const double from = nearest > 0 ? low[c] : -HUGE_VAL;
        const double to = nearest > 0 ? high[c] : HUGE_VAL;
        if (from > grid->high[c] + MARGIN * (grid->high[c] - grid->low[c]) ||
            to < grid->low[c] - MARGIN * (grid->high[c] - grid->low[c]))
            return false;
        face->from[c] = line_of(grid, c, cs_fmax(from, grid->low[c]), -MARGIN);
        face->to[c] = line_of(grid, c, cs_fmin(to, grid->high[c]), MARGIN);
    }
    return true;
}

/* True if the line to p passes through the triangle: p lies on the same side of the three
 * planes through the eye and an edge, and behind the plane of the triangle. Neighbours
 * compute the same number with opposite sign for their common edge, and 0 counts as inside:
 * nothing is visible through a seam. */
static bool hides(const struct face *face, const double p[3]) {
    if (p[2] <= face->nearest)
        return false;
    const double a = cs_vec3_dot(face->sides[0], p), b = cs_vec3_dot(face->sides[1], p),
                 c = cs_vec3_dot(face->sides[2], p);
    const double sum = a + b + c; /* the line meets the plane at volume / sum of its length */
    if (a >= 0 && b >= 0 && c >= 0)
        return face->volume > 0 && face->volume < REACH * sum;
    if (a <= 0 && b <= 0 && c <= 0)
        return face->volume < 0 && face->volume > REACH * sum;
    return false;
}

/* Removes the candidates of a cell that a triangle hides, except its own corners. */
static void hide_cell(struct grid *grid, const struct face *face, uint32_t cell) {
    const struct cs_visibility_scratch *work = grid->work;
    for (uint32_t k = work->cell_starts[cell]; k < work->cell_starts[cell + 1]; k++) {
        const uint32_t i = work->order[k];
        double p[3];
        if (!grid->seen[i] || i == face->corners[0] || i == face->corners[1] ||
            i == face->corners[2])
            continue;
        position_of(work, grid->n, i, p);
        grid->seen[i] = !hides(face, p);
    }
}

/* Removes the candidates that triangle t of a body hides. */
static void mark_occluded(struct grid *grid, const struct cs_body_range *body, uint32_t t) {
    struct face face;
    double p[3][3];
    cs_face_corners(body, t, face.corners);
    for (int k = 0; k < 3; k++) {
        face.corners[k] += body->first;
        position_of(grid->work, grid->n, face.corners[k], p[k]);
    }
    if (!bound(grid, p, &face))
        return;
    for (int k = 0; k < 3; k++)
        cs_vec3_cross(p[k], p[(k + 1) % 3], face.sides[k]);
    face.volume = cs_vec3_dot(p[0], face.sides[1]);
    for (uint32_t row = face.from[1]; row <= face.to[1]; row++)
        for (uint32_t column = face.from[0]; column <= face.to[0]; column++)
            hide_cell(grid, &face, row * grid->cells + column);
}

void cs_visibility_query_run(const struct cs_visibility_query *visibility,
                             const struct cs_system *system, double t, const double *x,
                             int64_t body, const struct cs_visibility_scratch *work,
                             bool *seen) {
    struct grid grid = {.work = work,
                        .n = system->view.n,
                        .low = {HUGE_VAL, HUGE_VAL},
                        .high = {-HUGE_VAL, -HUGE_VAL},
                        .seen = seen};
    uint32_t count = 0;
    memset(seen, 0, grid.n * sizeof *seen);
    turn_positions(visibility, work, grid.n, x);
    for (uint32_t b = 0; b < system->scene->bodies.n; b++)
        if (body < 0 || body == b)
            count += mark(visibility, system, t, x, system->bodies + b, &grid);
    if (count == 0)
        return;
    sort(&grid, count);
    for (uint32_t b = 0; b < system->scene->bodies.n; b++)
        for (uint32_t f = 0; f < cs_faces_count(system->bodies + b); f++)
            mark_occluded(&grid, system->bodies + b, f);
}
