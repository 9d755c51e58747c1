/* What single ranges cannot say about a scene. */
#include "scene/body_pairs.h"
#include "scene/event_check.h"
#include "scene/shape.h"
#include "scene/viewpoint.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Where the check stands, for messages. */
struct place {
    char *path; /* CS_TEXT_MAX bytes of the caller */
    struct cs_error *error;
};

/* records the path of the value at fault and what is wrong with it */
static enum cs_status refuse(const struct place *at, const char *path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static enum cs_status refuse(const struct place *at, const char *path, const char *format,
                             ...) {
    char message[512];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    snprintf(at->path, CS_TEXT_MAX, "%s", path);
    return cs_fail(at->error, CS_ERR_SCENE, "%s", message);
}

static double length_of(const double *v, int n) {
    double squared = 0;
    for (int i = 0; i < n; i++)
        squared += v[i] * v[i];
    return sqrt(squared);
}

/* Makes v a unit vector. One that is unit already keeps its bits, so that the resolved scene
 * runs to the same hash as the scene it came from. */
static enum cs_status make_unit(const struct place *at, const char *path, double *v, int n) {
    const double length = length_of(v, n);
    if (length < 1e-12)
        return refuse(at, path, "the zero vector has no direction");
    if (fabs(length - 1) > 1e-14)
        for (int i = 0; i < n; i++)
            v[i] /= length;
    return CS_OK;
}

/* rows of unit length, at right angles, right-handed: to 1e-6, and said otherwise */
static enum cs_status check_matrix(const struct place *at, const char *path, const double *m) {
    const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
                               m[1] * (m[3] * m[8] - m[5] * m[6]) +
                               m[2] * (m[3] * m[7] - m[4] * m[6]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            const double product =
                m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
            if (!(fabs(product - (i == j)) <= 1e-6))
                return refuse(at, path,
                              "rows %d and %d have the product %.9g: not a rotation matrix", j,
                              i, product);
        }
    if (!(determinant > 0))
        return refuse(at, path, "a mirror image (determinant %.3g): not a rotation matrix",
                      determinant);
    return CS_OK;
}

static enum cs_status check_place(const struct place *at, const char *body, const char *shape,
                                  struct cs_pose *place) {
    char path[128];
    if (!isnan(place->matrix[0])) {
        snprintf(path, sizeof path, "%s.%s.place.matrix", body, shape);
        return check_matrix(at, path, place->matrix);
    }
    snprintf(path, sizeof path, "%s.%s.place.rotate", body, shape);
    return make_unit(at, path, place->rotate, 4);
}

static enum cs_status check_pins(const struct place *at, const char *body,
                                 const struct cs_body *of) {
    char path[128], fault[160];
    const struct cs_pin *pins = of->pins.items;
    for (uint32_t p = 0; p < of->pins.n; p++) {
        snprintf(path, sizeof path, "%s.pins[%u]", body, p);
        if (cs_shape_pin_fault(of, pins + p, fault, sizeof fault))
            return refuse(at, path, "%s", fault);
    }
    return CS_OK;
}

static enum cs_status check_mass(const struct place *at, const char *body,
                                 const struct cs_body *of) {
    char path[128];
    const struct cs_spring_law *law = &of->springs;
    const int64_t *grid = of->cloth.grid;
    const bool stretch = law->stretch > 0 && (of->mesh.present || grid[0] > 1 || grid[1] > 1);
    const bool shear = law->shear > 0 && grid[0] > 1 && grid[1] > 1;
    snprintf(path, sizeof path, "%s.mass.degree", body);
    if (!isnan(of->mass.degree) && (cs_scene_springs_left_out(of) || (!stretch && !shear)))
        return refuse(at, path, "a particle without springs would have no mass");
    return CS_OK;
}

bool cs_scene_is_below(const char *file) {
    return *file != '/' && strcmp(file, "..") && strncmp(file, "../", 3) &&
           !strstr(file, "/../");
}

static enum cs_status check_texture(const struct place *at, const char *body,
                                    const char *texture) {
    char path[128];
    snprintf(path, sizeof path, "%s.material.texture", body);
    if (!cs_scene_is_below(texture))
        return refuse(at, path,
                      "found \"%.60s\", expected a file in the scene's folder or below",
                      texture);
    return CS_OK;
}

static enum cs_status check_network(const struct place *at, const char *body,
                                    const struct cs_body *of) {
    char path[128];
    snprintf(path, sizeof path, "%s.network", body);
    if (of->network.present && !of->mesh.present)
        return refuse(at, path, "a cloth has no inside, expected a closed mesh");
    return CS_OK;
}

/* what acts through springs cannot be asked of a body whose springs are left out */
static enum cs_status check_matching(const struct place *at, const char *body,
                                     const struct cs_body *of) {
    char path[128];
    const bool network = of->network.present;
    if (!cs_scene_springs_left_out(of) || (!network && isnan(of->strain_limit)))
        return CS_OK;
    snprintf(path, sizeof path, "%s.%s", body, network ? "network" : "strain_limit");
    return refuse(
        at, path,
        "shape_matching leaves the springs out, expected shape_matching.springs true");
}

static enum cs_status check_body(const struct place *at, uint32_t b, struct cs_body *body) {
    char path[64];
    snprintf(path, sizeof path, "bodies[%u]", b);
    if (body->cloth.present == body->mesh.present)
        return refuse(at, path, "found %s, expected cloth or mesh",
                      body->cloth.present ? "cloth and mesh" : "no shape");
    if (check_network(at, path, body) || check_matching(at, path, body) ||
        check_place(at, path, "cloth", &body->cloth.place) ||
        check_place(at, path, "mesh", &body->mesh.place) || check_mass(at, path, body) ||
        check_pins(at, path, body) || check_texture(at, path, body->material.texture))
        return at->error->status;
    return CS_OK;
}

static enum cs_status check_bodies(const struct place *at, struct cs_scene *scene) {
    struct cs_body *bodies = cs_scene_bodies(scene);
    double particles = 0;
    if (scene->bodies.n == 0)
        return refuse(at, "bodies", "found none, expected at least one body");
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        if (check_body(at, b, bodies + b))
            return at->error->status;
        particles += (double)cs_shape_count(bodies + b);
    }
    if (particles > CS_PARTICLES_MAX)
        return refuse(at, "bodies", "%.0f particles in all, expected at most %.0f", particles,
                      CS_PARTICLES_MAX);
    return CS_OK;
}

static enum cs_status check_box(const struct place *at, uint32_t c, struct cs_cuboid *box) {
    const double least = 0.5 * fmin(box->size[0], fmin(box->size[1], box->size[2]));
    char path[64];
    snprintf(path, sizeof path, "colliders[%u].box.radius", c);
    if (isnan(box->radius))
        box->radius = 0.1 * least;
    if (box->radius > least)
        return refuse(at, path, "%.9g m is more than half the shortest edge, %.9g m",
                      box->radius, least);
    snprintf(path, sizeof path, "colliders[%u].box.rotate", c);
    return make_unit(at, path, box->rotate, 4);
}

static enum cs_status check_capsule(const struct place *at, uint32_t c,
                                    const struct cs_capsule *capsule) {
    const double axis[3] = {capsule->to[0] - capsule->from[0],
                            capsule->to[1] - capsule->from[1],
                            capsule->to[2] - capsule->from[2]};
    char path[64];
    snprintf(path, sizeof path, "colliders[%u].capsule", c);
    return length_of(axis, 3) > 1e-9
               ? CS_OK
               : refuse(at, path, "from and to are the same, expected a sphere");
}

static enum cs_status check_collider(const struct place *at, uint32_t c,
                                     struct cs_collider *collider) {
    char path[64];
    snprintf(path, sizeof path, "colliders[%u]", c);
    if (collider->mesh.present)
        return check_place(at, path, "mesh", &collider->mesh.place);
    snprintf(path, sizeof path, "colliders[%u].plane.normal", c);
    if (collider->plane.present)
        return make_unit(at, path, collider->plane.normal, 3);
    if (collider->box.present)
        return check_box(at, c, &collider->box);
    return collider->capsule.present ? check_capsule(at, c, &collider->capsule) : CS_OK;
}

static enum cs_status check_colliders(const struct place *at, struct cs_scene *scene) {
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (check_collider(at, c, cs_scene_colliders(scene) + c))
            return at->error->status;
    return CS_OK;
}

/* the first pair of the list with the bodies of pair p */
static uint32_t find_pair(const struct cs_body_pair_keys *pairs, uint32_t p) {
    const int64_t *of = pairs[p].bodies;
    uint32_t k = 0;
    while (!(pairs[k].bodies[0] == of[0] && pairs[k].bodies[1] == of[1]) &&
           !(pairs[k].bodies[0] == of[1] && pairs[k].bodies[1] == of[0]))
        k++;
    return k;
}

static enum cs_status check_pairs(const struct place *at, const struct cs_scene *scene) {
    const struct cs_body_pair_keys *pairs = scene->pairs.list.items;
    char path[64];
    for (uint32_t p = 0; p < scene->pairs.list.n; p++) {
        snprintf(path, sizeof path, "pairs.list[%u].bodies", p);
        for (int k = 0; k < 2; k++)
            if (pairs[p].bodies[k] >= scene->bodies.n)
                return refuse(at, path, "found body %lld, expected 0..%u",
                              (long long)pairs[p].bodies[k], scene->bodies.n - 1);
        if (pairs[p].bodies[0] == pairs[p].bodies[1])
            return refuse(at, path, "found body %lld twice, expected bodies[%lld].self_contact",
                          (long long)pairs[p].bodies[0], (long long)pairs[p].bodies[0]);
        if (find_pair(pairs, p) < p)
            return refuse(at, path, "bodies %lld and %lld are in pairs.list[%u] already",
                          (long long)pairs[p].bodies[0], (long long)pairs[p].bodies[1],
                          find_pair(pairs, p));
    }
    return CS_OK;
}

/* surfaces of bodies meet by a force alone */
static enum cs_status check_meetings(const struct place *at, const struct cs_scene *scene) {
    char path[64] = "pairs";
    if (check_pairs(at, scene))
        return at->error->status;
    if (scene->contact.law == CS_CONTACT_FORCE || !cs_scene_has_body_contact(scene))
        return CS_OK;
    for (uint32_t b = scene->bodies.n; b--;)
        if (cs_scene_bodies(scene)[b].self_contact)
            snprintf(path, sizeof path, "bodies[%u].self_contact", b);
    for (uint32_t c = scene->colliders.n; c--;)
        if (cs_scene_colliders(scene)[c].mesh.present)
            snprintf(path, sizeof path, "colliders[%u].mesh", c);
    return refuse(at, path,
                  "contact.law is project, which handles only colliders that are not meshes; "
                  "expected contact.law force");
}

static enum cs_status check_camera_path(const struct place *at,
                                        const struct cs_camera *camera) {
    const struct cs_camera_key *keys = camera->path.items;
    char path[64];
    for (uint32_t k = 0; k < camera->path.n; k++) {
        const char *key,
            *fault = cs_viewpoint_fault(keys[k].eye, keys[k].target, camera->up, &key);
        const bool is_up = fault && !strcmp(key, "up");
        snprintf(path, sizeof path, "camera.path[%u]%s", k, fault && !is_up ? ".target" : "");
        if (isnan(keys[k].at))
            return refuse(at, path, "found no time, expected at");
        if (k > 0 && !(keys[k].at > keys[k - 1].at))
            return refuse(at, path, "at = %.9g s is not after %.9g s", keys[k].at,
                          keys[k - 1].at);
        if (fault)
            return refuse(at, path, is_up ? "camera.up %s" : "%s", fault);
    }
    return CS_OK;
}

static enum cs_status check_camera(const struct place *at, const struct cs_camera *camera) {
    char path[64];
    const char *key, *fault = cs_viewpoint_fault(camera->eye, camera->target, camera->up, &key);
    snprintf(path, sizeof path, "camera.%s", fault ? key : "");
    if (fault)
        return refuse(at, path, "%s", fault);
    if (camera->path.n && camera->frame == CS_FRAME_AUTO)
        return refuse(at, "camera.path", "frame auto finds the way itself, expected no path");
    return check_camera_path(at, camera);
}

static enum cs_status check_light(const struct place *at, struct cs_light *light) {
    const bool point = !isnan(light->point[0]), direction = !isnan(light->direction[0]);
    if (point && direction)
        return refuse(at, "light", "found point and direction, expected one of them");
    return direction ? make_unit(at, "light.direction", light->direction, 3) : CS_OK;
}

static enum cs_status check_render(const struct place *at, const struct cs_render *render) {
    if (render->samples != 1 && render->samples != 4)
        return refuse(at, "render.samples", "found %lld, expected 1 or 4",
                      (long long)render->samples);
    if (!isnan(render->range[0]) && !(render->range[0] < render->range[1]))
        return refuse(at, "render.range", "found %.9g, %.9g, expected the smaller value first",
                      render->range[0], render->range[1]);
    if (!isnan(render->background.below[0]) &&
        render->background.kind != CS_BACKGROUND_GRADIENT)
        return refuse(at, "render.background.below", "only a gradient has a colour below");
    return CS_OK;
}

enum cs_status cs_scene_check(struct cs_scene *scene, char *path_out, struct cs_error *error) {
    const struct place at = {path_out, error};
    path_out[0] = 0;
    if (check_bodies(&at, scene) || check_colliders(&at, scene) || check_meetings(&at, scene) ||
        (scene->forces.wind.present &&
         make_unit(&at, "forces.wind.direction", scene->forces.wind.direction, 3)) ||
        check_camera(&at, &scene->camera) || check_light(&at, &scene->light) ||
        check_render(&at, &scene->render) || cs_events_check(scene, path_out, error))
        return error->status;
    return CS_OK;
}

void cs_scene_finish(struct cs_scene *scene) {
    struct cs_arena arena = scene->arena;
    cs_arena_finish(&arena);
    *scene = (struct cs_scene){0};
}
