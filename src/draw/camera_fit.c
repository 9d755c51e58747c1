/* camera_fit.c - fits a camera to points, by the maxima that camera_fit.h derives. */
#include "draw/camera_fit.h"

#include "base/vec3.h"
#include "draw/glyph.h"
#include "draw/matrix.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"

/* Particles whose view is tested, and by how many a direction is clearly worse; bodies whose
 * fall is tested, in parts. */
enum { MOST_POINTS = 200, MOST_HIDDEN = MOST_POINTS / 50, MOST_BODIES = 8, FALL_STEPS = 40 };

void cs_camera_fit_begin(struct cs_camera_fit *fit, const struct cs_camera *camera,
                         const struct cs_render *render) {
    double look[16];
    cs_matrix_look(camera->eye, camera->target, camera->up, look);
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 3; i++)
            fit->axes[row][i] = look[4 * i + row];
    fit->camera = *camera;
    fit->slope = cs_tangent(camera->fov * (3.14159265358979323846 / 360));
    fit->aspect =
        ((double)render->size[0] - cs_colour_bar_width(render)) / (double)render->size[1];
    fit->has_corners = false;
}

// coordinate of point i along an axis of the picture
static double along(const struct cs_camera_fit *fit, int axis, size_t n, const double *x,
                    size_t i) {
    const double place[3] = {x[i], x[n + i], x[2 * n + i]};
    return cs_vec3_dot(fit->axes[axis], place);
}

// direction side * axis + back * (view's back): a left side of the inequalities
static void bounding_direction(const struct cs_camera_fit *fit, int axis, double side,
                               double back, double way[3]) {
    for (int i = 0; i < 3; i++)
        way[i] = side * fit->axes[axis][i] + back * fit->axes[2][i];
}

/* maximum of way . x over the finite points, and its index; n if there is none */
static double reach(const double way[3], size_t n, const double *x, size_t *found) {
    double most = -HUGE_VAL;
    *found = n;
    for (size_t i = 0; i < n; i++) {
        const double sum = way[0] * x[i] + way[1] * x[n + i] + way[2] * x[2 * n + i];
        if (sum > most && sum < HUGE_VAL) {
            most = sum;
            *found = i;
        }
    }
    return most;
}

/* maximum of way . x over the finite points and the corners of the fit */
static double bound(const struct cs_camera_fit *fit, const double way[3], size_t n,
                    const double *x) {
    size_t which;
    const double most = reach(way, n, x, &which);
    return fit->has_corners
               ? fmax(most, reach(way, CS_CAMERA_FIT_CORNERS, fit->corners, &which))
               : most;
}

// a camera's coordinate along one axis (cx or cy), and its distance back (cz)
struct stand {
    double middle, back;
};

/* The nearest camera that has all points within -slope and slope along an axis. Parallel rays
 * have no cz; there `back` is half the extent over slope, so that the camera's height fits. */
static struct stand camera_position(const struct cs_camera_fit *fit, int axis, double slope,
                                    size_t n, const double *x) {
    const bool leans = fit->camera.projection == CS_PROJECTION_PERSPECTIVE;
    double way[3];
    bounding_direction(fit, axis, 1, leans ? slope : 0, way);
    const double high = bound(fit, way, n, x);
    bounding_direction(fit, axis, -1, leans ? slope : 0, way);
    const double low = bound(fit, way, n, x);
    return (struct stand){(high - low) / 2, (high + low) / 2 / slope};
}

void cs_camera_fit_solve(const struct cs_camera_fit *fit, size_t n, const double *x,
                         double share, struct cs_camera *camera) {
    const struct stand wide = camera_position(fit, 0, 0.96 * fit->slope * fit->aspect, n, x);
    const struct stand tall = camera_position(fit, 1, share * fit->slope, n, x);
    double front[3], behind[3];
    bounding_direction(fit, 0, 0, 1, front);
    bounding_direction(fit, 0, 0, -1, behind);
    const double nearest = bound(fit, front, n, x), far = -bound(fit, behind, n, x);
    const double depth = (nearest + far) / 2;
    *camera = fit->camera;
    double eye = fmax(tall.back, wide.back);
    if (camera->projection == CS_PROJECTION_ORTHOGRAPHIC)
        eye += depth;
    // what is flat, or a point, is not touched
    eye = fmax(eye, nearest + 1e-3);
    for (int i = 0; i < 3 && eye < HUGE_VAL; i++) {
        const double across = wide.middle * fit->axes[0][i] + tall.middle * fit->axes[1][i];
        camera->eye[i] = across + eye * fit->axes[2][i];
        camera->target[i] = across + depth * fit->axes[2][i];
    }
}

void cs_camera_fit_picture(const struct cs_camera_fit *fit,
                           const struct cs_posed_collider *colliders, size_t n, const double *x,
                           struct cs_camera *camera) {
    struct cs_camera_fit moved = *fit;
    for (int i = 0; fit->follows > 0 && i < 3; i++)
        for (int k = 0; k < CS_CAMERA_FIT_CORNERS; k++)
            moved.corners[CS_CAMERA_FIT_CORNERS * i + k] +=
                colliders[fit->follows - 1].centre[i] - fit->follows_from[i];
    cs_camera_fit_solve(&moved, n, x, 0.9, camera);
}

void cs_camera_fit_rows(const struct cs_camera_fit *fit, const struct cs_camera *camera,
                        size_t n, const double *x, double rows[2]) {
    double eye[3], view[3];
    cs_subtract(camera->eye, camera->target, view);
    for (int axis = 0; axis < 3; axis++)
        eye[axis] = cs_vec3_dot(fit->axes[axis], camera->eye);
    rows[0] = HUGE_VAL;
    rows[1] = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        const double far = camera->projection == CS_PROJECTION_ORTHOGRAPHIC
                               ? cs_vec3_length(view)
                               : eye[2] - along(fit, 2, n, x, i);
        const double row = (along(fit, 1, n, x, i) - eye[1]) / (fit->slope * far);
        rows[0] = row < rows[0] ? row : rows[0];
        rows[1] = row > rows[1] ? row : rows[1];
    }
}

void cs_camera_fit_extremes(const struct cs_camera_fit *fit, size_t n, const double *x,
                            double *out) {
    for (size_t k = 0; k < CS_CAMERA_FIT_EXTREMES; k++) {
        const size_t step = k / 4;
        const int axis = (int)(k >> 1 & 1);
        const double side = k & 1 ? -1 : 1, slope = fit->slope * (axis ? 1 : fit->aspect);
        double way[3];
        size_t i;
        if (step > CS_CAMERA_FIT_STEPS)
            bounding_direction(fit, axis, 0, side, way);
        else
            bounding_direction(fit, axis, side, (double)step / CS_CAMERA_FIT_STEPS * slope,
                               way);
        reach(way, n, x, &i);
        for (size_t c = 0; c < 3; c++)
            out[c * CS_CAMERA_FIT_EXTREMES + k] = i < n ? x[c * n + i] : 0;
    }
}

/* Depth in m below the box of the start that a run is taken to reach: that of a floor below, or
 * what a sheet of the box's width hangs down. */
static double depth_below(const struct cs_scene *scene, const double low[3],
                          const double high[3]) {
    const double *g = scene->forces->gravity;
    const double width = fmax(high[0] - low[0], high[2] - low[2]);
    double depth = cs_vec3_dot(g, g) > 0 ? 0.5 * width : 0;
    for (uint32_t k = 0; k < scene->colliders.n; k++) {
        const struct cs_collider *collider = cs_scene_colliders(scene) + k;
        const double below = low[1] - collider->floor.height;
        // what stands on a floor may reach a little into it
        if (collider->floor.present && below < 3 * fmax(width, high[1] - low[1]))
            depth = fmax(below, 0);
    }
    return depth;
}

static void set_corners(struct cs_camera_fit *fit, double depth, const double low[3],
                        const double high[3]) {
    double inset[3], sunk[3] = {0, depth, 0};
    for (int i = 0; i < 3; i++)
        inset[i] = fmin(depth, (high[i] - low[i]) / 2) / 2;
    for (int k = 0; k < CS_CAMERA_FIT_CORNERS; k++)
        for (int i = 0; i < 3; i++) {
            const double inwards = i != 1 && !(k & 2) ? inset[i] : 0;
            fit->corners[CS_CAMERA_FIT_CORNERS * i + k] =
                k >> i & 1 ? high[i] - inwards : low[i] - sunk[i] + inwards;
        }
    fit->has_corners = true;
}

/* Number of thinned particles of the start that a collider hides with this shift. */
static uint32_t count_behind(const struct cs_system *system,
                             const struct cs_posed_collider *collider, const double shift[3],
                             const double eye[3]) {
    const double *x = system->view.start;
    const size_t n = system->view.n;
    double from[3], way[3];
    uint32_t hidden = 0;
    cs_subtract(eye, shift, from);
    for (size_t i = 0; i < n; i += n / MOST_POINTS + 1) {
        cs_subtract((double[3]){x[i], x[n + i], x[2 * n + i]}, eye, way);
        hidden += cs_posed_collider_hits_segment(collider, from, way, 1 - 1e-3);
    }
    return hidden;
}

/* The points of a path in turn, of a collider's moves or of a grab. */
struct walk {
    uint32_t event, point;
    double begin[3], shift[3]; /* m from the start: at the begin of the event, at the point */
};

/* Steps to the next point of the paths of collider k, whose centre at the start is given.
 * Returns false behind the last one. */
static bool step(const struct cs_scene *scene, uint32_t k, const double centre[3],
                 struct walk *at) {
    for (; at->event < scene->events.n; at->event++, at->point = 0) {
        const struct cs_move *move = &cs_scene_events(scene)[at->event].move;
        const struct cs_path_point *points = move->path.items;
        if (!move->present || move->collider != k || at->point == move->path.n)
            continue;
        if (at->point == 0)
            memcpy(at->begin, at->shift, sizeof at->begin);
        for (int i = 0; i < 3; i++)
            at->shift[i] =
                points[at->point].point[i] + (move->relative ? at->begin[i] : -centre[i]);
        at->point++;
        return true;
    }
    return false;
}

/* The most thinned particles that collider k hides at the start or at a point of its paths. */
static uint32_t most_behind(const struct cs_system *system,
                            const struct cs_posed_collider *collider, uint32_t k,
                            const double eye[3]) {
    struct walk walk = {0};
    uint32_t most = 0;
    do {
        const uint32_t hidden = count_behind(system, collider, walk.shift, eye);
        most = hidden > most ? hidden : most;
    } while (step(system->scene, k, collider->centre, &walk));
    return most;
}

/* Extends a box by a shape with a core: the core's half sizes along its axes, and the radius.
 */
static void grow_by(double low[3], double high[3], const struct cs_posed_collider *collider) {
    for (int i = 0; i < 3; i++) {
        double reach = collider->radius;
        for (int k = 0; k < 3; k++)
            reach += fabs(collider->axes[k][i]) * collider->half_sizes[k];
        low[i] = fmin(low[i], collider->centre[i] - reach);
        high[i] = fmax(high[i], collider->centre[i] + reach);
    }
}

static void grow_by_mesh(double low[3], double high[3],
                         const struct cs_posed_collider *collider) {
    const uint32_t n = collider->collider->geometry->n;
    for (uint32_t i = 0; i < n; i++) {
        double own[3], place[3];
        cs_collider_mesh_vertex(collider, i, own);
        cs_collider_to_world(collider, own, place);
        cs_vec3_extend_box(low, high, place, 0);
    }
}

void cs_box_grow_by_collider(double low[3], double high[3],
                             const struct cs_posed_collider *collider) {
    if (!collider->collider->visible || cs_shape_is_endless(collider->shape))
        return;
    if (collider->shape->bounds == CS_BOUNDS_MESH)
        grow_by_mesh(low, high, collider);
    else
        grow_by(low, high, collider);
}

/* Extends a box by where paths take visible colliders and the bodies that they hold. Returns
 * the collider + 1 that goes farthest; 0: none moves. */
static uint32_t grow_by_moves(const struct cs_system *system,
                              const struct cs_posed_collider *colliders, double low[3],
                              double high[3]) {
    const struct cs_scene *scene = system->scene;
    uint32_t farthest = 0;
    double most = 0;
    for (uint32_t k = 0; k < scene->colliders.n; k++) {
        struct cs_posed_collider moved = colliders[k];
        struct walk walk = {0};
        while (step(scene, k, colliders[k].centre, &walk)) {
            for (int i = 0; i < 3; i++)
                moved.centre[i] = colliders[k].centre[i] + walk.shift[i];
            cs_box_grow_by_collider(low, high, &moved);
            if (colliders[k].collider->visible && cs_vec3_length(walk.shift) > most) {
                most = cs_vec3_length(walk.shift);
                farthest = k + 1;
            }
        }
    }
    return farthest;
}

/* True if a visible collider is met on the way. */
static bool meets(const struct cs_system *system, const struct cs_posed_collider *colliders,
                  const double from[3], const double way[3]) {
    bool met = false;
    for (uint32_t k = 0; k < system->scene->colliders.n && !met; k++)
        met = colliders[k].collider->visible &&
              cs_posed_collider_hits_segment(colliders + k, from, way, 1 - 1e-3);
    return met;
}

/* True if a body without pins falls to where visible colliders hide its middle from the eye. */
static bool lands_hidden(const struct cs_camera_fit *fit, const struct cs_system *system,
                         const struct cs_posed_collider *colliders, uint32_t body,
                         const double eye[3]) {
    const struct cs_body_range *range = system->bodies + body;
    // the lowest of the corners, and the highest
    const double *y = fit->corners + CS_CAMERA_FIT_CORNERS, *x = system->view.start;
    const double fall[3] = {0, (y[0] - y[2]) / FALL_STEPS, 0};
    double way[3], point[3] = {0};
    for (size_t k = 0; k < 3 * (size_t)range->count; k++)
        point[k % 3] += x[k % 3 * system->view.n + range->first + k / 3] / range->count;
    for (int k = 0; k <= FALL_STEPS && !cs_scene_bodies(system->scene)[body].pins.n; k++) {
        cs_subtract(point, eye, way);
        if (meets(system, colliders, point, fall))
            return meets(system, colliders, eye, way);
        point[1] += fall[1];
    }
    return false;
}

/* Thinned particles of the start that visible colliders hide from the fit's camera; and, for
 * each of some bodies that fall to where they are hidden, as many as decide. */
static uint32_t count_hidden(const struct cs_camera_fit *fit, const struct cs_system *system,
                             const struct cs_posed_collider *colliders) {
    const uint32_t n = system->scene->bodies.n;
    struct cs_camera camera;
    uint32_t hidden = 0;
    cs_camera_fit_picture(fit, colliders, 0, NULL, &camera);
    for (uint32_t k = 0; k < system->scene->colliders.n; k++)
        if (colliders[k].collider->visible)
            hidden += most_behind(system, colliders + k, k, camera.eye);
    for (uint32_t b = 0; b < n; b += n / MOST_BODIES + 1)
        hidden += lands_hidden(fit, system, colliders, b, camera.eye) * (MOST_HIDDEN + 1);
    return hidden;
}

void cs_camera_fit_start(struct cs_camera_fit *fit, const struct cs_system *system,
                         const struct cs_posed_collider *colliders, const double start_low[3],
                         const double start_high[3]) {
    /* the first is the default of the key */
    static const double eyes[][3] = {{1.2, 0.7, 2.2}, {-1.2, 0.7, 2.2}, {0, 0.7, 2.5},
                                     {1.2, 2, 1.7},   {-1.2, 2, 1.7},   {0, 2.5, 1}};
    const struct cs_scene *scene = system->scene;
    struct cs_camera camera = *scene->camera;
    const bool is_free = !memcmp(camera.eye, eyes[0], sizeof camera.eye) &&
                         !(cs_vec3_dot(camera.target, camera.target) > 0);
    uint32_t least = UINT32_MAX;
    double low[3], high[3];
    uint32_t follows = 0;
    memcpy(low, start_low, sizeof low);
    memcpy(high, start_high, sizeof high);
    const uint32_t farthest = grow_by_moves(system, colliders, low, high);
    for (int i = 0; i < 3; i++)
        if (high[i] - low[i] > 2 * (start_high[i] - start_low[i]))
            follows = farthest;
    if (follows > 0) {
        memcpy(low, start_low, sizeof low);
        memcpy(high, start_high, sizeof high);
    }
    for (size_t k = 0; k < (is_free ? sizeof eyes / sizeof *eyes : 1) && least > 0; k++) {
        struct cs_camera_fit tried;
        if (k > 0)
            memcpy(camera.eye, eyes[k], sizeof camera.eye);
        cs_camera_fit_begin(&tried, &camera, scene->render);
        tried.follows = follows;
        if (follows > 0)
            memcpy(tried.follows_from, colliders[follows - 1].centre, sizeof low);
        set_corners(&tried, depth_below(scene, low, high), low, high);
        const uint32_t hidden = count_hidden(&tried, system, colliders);
        // a direction further down the list must show clearly more
        if (k == 0 || hidden + MOST_HIDDEN < least) {
            least = hidden;
            *fit = tried;
        }
    }
}
