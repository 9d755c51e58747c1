/* Speeds at which surfaces may meet, by boxes of positions and velocities at the start. */
#include "model/contact/approach.h"

#include "model/contact/posed_collider.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"

#include <math.h>
#include <string.h>

/* The largest speed on a smooth leg of a path, 3 s^2 - 2 s^3, over the mean. */
#define SMOOTH_PEAK 1.5

/* A body or a collider at the start. */
struct surface {
    double low[3], high[3]; /* m */
    /* m/s of its particles, without those that are pinned */
    double slowest[3], fastest[3];
    double path_speed; /* m/s, largest along its events */
    double mass;       /* kg, heaviest particle; 0: a collider */
    double drop;       /* m to the nearest collider below it */
    double most;       /* m2/s2, square of the largest speed at which a body meets anything */
    bool tethered;     /* it has pins that no event releases */
    /* a plane: the box is empty, and it is all behind the plane */
    bool endless;
    double point[3], normal[3]; /* m, unit vector */
};

struct cs_approach {
    double gravity, down[3]; /* m/s2 and its direction */
    uint32_t n_bodies, n;    /* bodies, and bodies and colliders */
    struct surface *surfaces;
};

/* --- boxes --- */

static void clear(struct surface *surface) {
    *surface = (struct surface){0};
    for (int c = 0; c < 3; c++) {
        surface->low[c] = HUGE_VAL;
        surface->high[c] = -HUGE_VAL;
    }
}

static void set_body(const struct cs_system *system, uint32_t body, struct surface *out) {
    const struct cs_body_range *range = system->bodies + body;
    const size_t n = system->view.n;
    bool pinned = false;
    clear(out);
    for (size_t i = range->first; i < (size_t)range->first + range->count; i++) {
        const double *x = system->state + i, *v = x + 3 * n;
        const double p[3] = {x[0], x[n], x[2 * n]};
        cs_vec3_extend_box(out->low, out->high, p, 0);
        out->mass = fmax(out->mass, system->mass[i]);
        pinned = pinned || system->inv_mass[i] == 0;
        for (size_t c = 0; c < 3; c++) {
            out->slowest[c] = i == range->first ? v[c * n] : fmin(out->slowest[c], v[c * n]);
            out->fastest[c] = i == range->first ? v[c * n] : fmax(out->fastest[c], v[c * n]);
        }
    }
    out->tethered = pinned && !cs_event_releases_any(system->scene);
}

/* A mesh by its vertices, a core by its corners and its radius. */
static void set_collider(const struct cs_system *system, uint32_t collider,
                         struct surface *out) {
    struct cs_posed_collider at;
    cs_posed_collider_at(system, collider, 0, &at);
    const struct cs_trimesh *mesh = at.collider->mesh ? at.collider->geometry : NULL;
    clear(out);
    out->endless = cs_shape_is_endless(at.shape);
    memcpy(out->point, at.centre, sizeof out->point);
    memcpy(out->normal, at.axes[1], sizeof out->normal);
    // corners of the core by the bits of i
    for (size_t i = 0; i < (mesh ? mesh->n : 8) && !out->endless; i++) {
        double p[3], own[3];
        for (size_t k = 0; k < 3; k++)
            own[k] = (i >> k & 1 ? 1 : -1) * at.half_sizes[k];
        if (mesh)
            cs_collider_mesh_vertex(&at, (uint32_t)i, own);
        for (int c = 0; c < 3; c++)
            p[c] = at.centre[c] + own[0] * at.axes[0][c] + own[1] * at.axes[1][c] +
                   own[2] * at.axes[2][c];
        cs_vec3_extend_box(out->low, out->high, p, mesh ? 0 : at.radius);
    }
}

/* --- speeds --- */

/* m/s, largest along a path that begins at `from` and `begin`. A first point that is no shift
 * is reached from the middle of what is grabbed. */
static double speed_along(const struct cs_list *path, int32_t motion, const double from[3],
                          double begin) {
    const struct cs_path_point *points = path->items;
    double speed = 0;
    for (uint32_t k = 0; k < path->n; k++) {
        const double *before = k ? points[k - 1].point : from;
        const double seconds = points[k].at - (k ? points[k - 1].at : begin);
        if (seconds > 0)
            speed = fmax(speed, cs_vec3_distance(points[k].point, before) / seconds);
    }
    return speed * (motion == CS_MOTION_SMOOTH ? SMOOTH_PEAK : 1);
}

/* m, half the diagonal of a surface's box; 0 of an endless one */
static double half_diagonal(const struct surface *surface) {
    const double length = 0.5 * cs_vec3_distance(surface->high, surface->low);
    return isfinite(length) ? length : 0;
}

/* m, from the point that a move turns about to the centre at the start */
static double lever_of(const struct cs_move *move, const double centre[3]) {
    return isnan(move->centre[0]) ? 0 : cs_vec3_distance(centre, move->centre);
}

/* Adds the events that move bodies and colliders along paths, and key frames. */
static void add_paths(const struct cs_scene *scene, struct cs_approach *approach) {
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(scene) + e;
        const double begin = cs_event_begin(event);
        if (event->move.present) {
            struct surface *at = approach->surfaces + approach->n_bodies + event->move.collider;
            double centre[3];
            for (int c = 0; c < 3; c++)
                centre[c] = event->move.relative ? 0 : at->point[c];
            at->path_speed =
                fmax(at->path_speed,
                     speed_along(&event->move.path, event->move.motion, centre, begin) +
                         cs_vec3_length(event->move.spin) *
                             (half_diagonal(at) + lever_of(&event->move, at->point)));
        }
        // a grab without a body acts on all
        for (uint32_t b = 0; event->grab.present && b < approach->n_bodies; b++) {
            struct surface *at = approach->surfaces + b;
            double middle[3];
            for (int c = 0; c < 3; c++)
                middle[c] = event->grab.relative ? 0 : 0.5 * (at->low[c] + at->high[c]);
            if (event->grab.target.body < 0 || event->grab.target.body == b)
                at->path_speed =
                    fmax(at->path_speed,
                         speed_along(&event->grab.path, event->grab.motion, middle, begin) +
                             2 * cs_vec3_length(event->grab.spin) * half_diagonal(at));
        }
    }
    for (uint32_t c = 0; c < scene->colliders.n; c++) {
        const struct cs_vertex_paths *paths = cs_scene_colliders(scene)[c].paths;
        approach->surfaces[approach->n_bodies + c].path_speed += paths ? paths->speed : 0;
    }
}

/* --- drops --- */

/* m, smallest value of direction.p in a box */
static double least_along(const struct surface *at, const double direction[3]) {
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += fmin(direction[c] * at->low[c], direction[c] * at->high[c]);
    return sum;
}

/* m that a may fall onto a plane; -1 if it does not. */
static double drop_onto_plane(const struct cs_approach *approach, const struct surface *a,
                              const struct surface *plane) {
    const double steep = -cs_vec3_dot(plane->normal, approach->down);
    const double height =
        least_along(a, plane->normal) - cs_vec3_dot(plane->normal, plane->point);
    return steep > 0 && height > 0 ? height / steep : -1;
}

/* m/s, largest difference of initial velocities */
static double relative_speed(const struct surface *a, const struct surface *b) {
    double apart[3];
    for (int c = 0; c < 3; c++)
        apart[c] = fmax(a->fastest[c] - b->slowest[c], b->fastest[c] - a->slowest[c]);
    return cs_vec3_length(apart);
}

/* m that a may fall onto b, which is no plane: the gap along gravity, if the box of a, on its
 * way down past b and carried aside by the initial velocities, meets that of b; else -1. */
static double drop_onto_box(const struct cs_approach *approach, const struct surface *a,
                            const struct surface *b) {
    double up[3];
    for (int c = 0; c < 3; c++)
        up[c] = -approach->down[c];
    const double gap = least_along(b, approach->down) + least_along(a, up);
    const double whole = -least_along(b, up) - least_along(a, approach->down);
    const double aside = relative_speed(a, b) * sqrt(2 * fmax(whole, 0) / approach->gravity);
    // the box swept down, and widened to both sides
    for (int c = 0; c < 3; c++) {
        const double way = approach->down[c] * whole;
        if (a->low[c] + fmin(way, 0) - aside > b->high[c] ||
            a->high[c] + fmax(way, 0) + aside < b->low[c])
            return -1;
    }
    return gap;
}

/* m that a may fall onto b; 0 or less if it does not. */
static double drop_onto(const struct cs_approach *approach, const struct surface *a,
                        const struct surface *b) {
    if (approach->gravity == 0)
        return 0;
    const double drop =
        b->endless ? drop_onto_plane(approach, a, b) : drop_onto_box(approach, a, b);
    return a->tethered && drop > 2 * half_diagonal(a) ? 0 : drop;
}

/* Sets the drop of a body to the nearest collider below it. */
static void set_drop(struct cs_approach *approach, struct surface *body) {
    double least = HUGE_VAL;
    for (uint32_t c = approach->n_bodies; c < approach->n; c++) {
        const double drop = drop_onto(approach, body, approach->surfaces + c);
        least = drop > 0 ? fmin(least, drop) : least;
    }
    body->drop = least < HUGE_VAL ? least : 0;
}

/* m2/s2, of the speed at which two surfaces may meet after a drop */
static double square_between(const struct cs_approach *approach, const struct surface *a,
                             const struct surface *b, double drop) {
    const double thrown = relative_speed(a, b);
    const double path = a == b ? a->path_speed : a->path_speed + b->path_speed;
    return fmax(thrown * thrown + 2 * approach->gravity * drop, path * path);
}

/* The largest of these of a body and whatever it meets: it meets itself and others as fast
 * afterwards. */
static double largest_square(const struct cs_scene *scene, const struct cs_approach *approach,
                             uint32_t body) {
    const struct surface *a = approach->surfaces + body;
    double most = 0, friction;
    for (uint32_t c = 0; c < approach->n; c++) {
        const struct surface *b = approach->surfaces + c;
        const double drop = fmax(fmax(drop_onto(approach, a, b), drop_onto(approach, b, a)), 0);
        if (c >= approach->n_bodies)
            most = fmax(most, square_between(approach, a, b, fmin(drop, a->drop)));
        else if (cs_scene_bodies_collide(scene, body, c, &friction))
            most =
                fmax(most, square_between(approach, a, b, fmax(drop, fmax(a->drop, b->drop))));
    }
    return most;
}

enum cs_status cs_approach_build(struct cs_system *system, struct cs_error *error) {
    const struct cs_scene *scene = system->scene;
    const double *g = scene->forces->gravity;
    if (system->approach)
        return CS_OK;
    struct cs_approach *approach = cs_arena_alloc(&system->arena, sizeof *approach, error);
    struct surface *surfaces = cs_arena_alloc_array(
        &system->arena, scene->bodies.n + scene->colliders.n, sizeof *surfaces, error);
    if (error->status)
        return error->status;
    *approach = (struct cs_approach){.gravity = cs_vec3_length(g),
                                     .n_bodies = scene->bodies.n,
                                     .n = scene->bodies.n + scene->colliders.n,
                                     .surfaces = surfaces};
    // surfaces first: paths and drops read their boxes
    for (int c = 0; c < 3 && approach->gravity > 0; c++)
        approach->down[c] = g[c] / approach->gravity;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        set_body(system, b, surfaces + b);
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        set_collider(system, c, surfaces + scene->bodies.n + c);
    add_paths(scene, approach);
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        set_drop(approach, surfaces + b);
    // once: every pair of bodies asks for it
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        surfaces[b].most = largest_square(scene, approach, b);
    system->approach = approach;
    return CS_OK;
}

/* m2/s2, of the speed at which body a meets body or collider b */
static double square_of(const struct cs_approach *approach, uint32_t a, uint32_t b) {
    const struct surface *first = approach->surfaces + a, *second = approach->surfaces + b;
    return b < approach->n_bodies ? fmax(first->most, second->most)
                                  : square_between(approach, first, second,
                                                   fmax(drop_onto(approach, first, second), 0));
}

double cs_approach_speed(const struct cs_system *system, uint32_t a, uint32_t b) {
    return sqrt(square_of(system->approach, a, b));
}

double cs_approach_energy(const struct cs_system *system, uint32_t a, uint32_t b) {
    const struct surface *surfaces = system->approach->surfaces;
    return 0.5 * fmax(surfaces[a].mass, surfaces[b].mass) * square_of(system->approach, a, b);
}

double cs_approach_stiffness(const struct cs_system *system, double softest, double energy,
                             double range) {
    const double given = system->scene->contact->stiffness;
    return isnan(given) ? fmax(softest, CS_APPROACH_STIFFNESS * energy / (range * range))
                        : given;
}
