/* Checks of a scene that ranges of single values cannot express. */
#include "base/options.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/body_particles.h"
#include "scene/collider.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"
#include "scene/mesh_keys.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Checks that the body has all pinned particles. */
static enum cs_status check_pins(const struct cs_check *check, const struct cs_scene *scene,
                                 const char *body, const struct cs_body *of) {
    char path[128], fault[160];
    const struct cs_pin *pins = of->pins.items;
    for (uint32_t p = 0; p < of->pins.n; p++) {
        snprintf(path, sizeof path, "%s.pins[%u]", body, p);
        if (cs_body_pin_fault(of, pins + p, fault, sizeof fault))
            return cs_check_refuse(check, path, "%s", fault);
        snprintf(path, sizeof path, "%s.pins[%u].to", body, p);
        if (pins[p].to && cs_holder_fault(scene, pins[p].to, fault, sizeof fault))
            return cs_check_refuse(check, path, "%s", fault);
    }
    return CS_OK;
}

/* Refuses a mass per spring for a body without springs: its particles would have no mass. */
static enum cs_status check_mass(const struct cs_check *check, const char *body,
                                 const struct cs_body *of) {
    char path[128];
    const struct cs_spring_law *law = &of->springs;
    const int64_t *grid = of->cloth.grid;
    const bool stretch = law->stretch > 0 && (of->mesh || grid[0] > 1 || grid[1] > 1);
    const bool shear = law->shear > 0 && grid[0] > 1 && grid[1] > 1;
    snprintf(path, sizeof path, "%s.mass.degree", body);
    if (!isnan(of->mass.degree) && (cs_scene_springs_left_out(of) || (!stretch && !shear)))
        return cs_check_refuse(check, path, "a particle without springs would have no mass");
    return CS_OK;
}

bool cs_scene_is_below(const char *file) {
    return *file != '/' && strcmp(file, "..") && strncmp(file, "../", 3) &&
           !strstr(file, "/../");
}

static enum cs_status check_texture(const struct cs_check *check, const char *body,
                                    const char *texture) {
    char path[128];
    snprintf(path, sizeof path, "%s.material.texture", body);
    if (cs_scene_is_below(texture))
        return CS_OK;
    return cs_check_refuse(check, path,
                           "found \"%.60s\", expected a file in the scene's folder or below",
                           texture);
}

static enum cs_status check_network(const struct cs_check *check, const char *body,
                                    const struct cs_body *of) {
    char path[128];
    snprintf(path, sizeof path, "%s.network", body);
    if (of->network.present && !of->mesh)
        return cs_check_refuse(check, path, "a cloth has no inside, expected a closed mesh");
    return CS_OK;
}

/* Refuses options of springs for a body whose springs do not act. */
static enum cs_status check_matching(const struct cs_check *check, const char *body,
                                     const struct cs_body *of) {
    char path[128];
    const bool network = of->network.present;
    if (!cs_scene_springs_left_out(of) || (!network && isnan(of->strain_limit)))
        return CS_OK;
    snprintf(path, sizeof path, "%s.%s", body, network ? "network" : "strain_limit");
    return cs_check_refuse(
        check, path,
        "shape_matching disables the springs, expected shape_matching.springs true");
}

/* Returns the first number of the springs that is not the default; NULL: none. */
static const char *changed_spring(const struct cs_spring_law *law) {
    struct cs_spring_law plain;
    cs_options_default(&cs_spring_table, &plain);
    for (uint32_t k = 0; k < cs_spring_table.n; k++)
        if (!cs_option_is_default(cs_spring_table.rows + k, law))
            return cs_spring_table.rows[k].name;
    return NULL;
}

/* Returns what a body has that needs springs; NULL: nothing. */
static const char *needs_springs(const struct cs_body *body) {
    return body->network.present          ? "network"
           : body->shape_matching.present ? "shape_matching"
           : !isnan(body->strain_limit)   ? "strain_limit"
                                          : NULL;
}

/* Refuses what is for springs in an elastic body. */
static enum cs_status check_elastic(const struct cs_check *check, const char *body,
                                    const struct cs_body *of) {
    const char *spring = changed_spring(&of->springs), *other = needs_springs(of);
    char path[128];
    if (!of->elastic.present)
        return CS_OK;
    snprintf(path, sizeof path, "%s.%s%s", body, spring ? "springs." : "",
             spring  ? spring
             : other ? other
                     : "");
    if (spring)
        return cs_check_refuse(check, path,
                               "elastic replaces the springs, expected one of the two");
    if (other)
        return cs_check_refuse(check, path, "it acts on springs, which elastic replaces");
    return cs_elastic_check(check, body, of);
}

/* Refuses a pressure in what has an edge: it would push the body away. */
static enum cs_status check_pressure(const struct cs_check *check, const char *body,
                                     const struct cs_body *of) {
    char path[128];
    snprintf(path, sizeof path, "%s.%s", body,
             of->pressure > 0 ? "pressure" : "outer_pressure");
    if ((of->pressure > 0 || of->outer_pressure >= 0) && !cs_body_is_closed(of))
        return cs_check_refuse(check, path, "expected a closed mesh whose faces look outwards");
    return CS_OK;
}

static enum cs_status check_body(const struct cs_check *check, const struct cs_scene *scene,
                                 uint32_t b, struct cs_body *body) {
    char path[64];
    snprintf(path, sizeof path, "bodies[%u]", b);
    if (body->cloth.present == (body->mesh != NULL))
        return cs_check_refuse(check, path, "found %s, expected cloth or mesh",
                               body->cloth.present ? "cloth and mesh" : "no shape");
    if (check_elastic(check, path, body) || check_network(check, path, body) ||
        check_matching(check, path, body) ||
        cs_check_pose(check, path, "cloth", &body->cloth.place) ||
        (body->mesh && cs_check_pose(check, path, "mesh", &body->mesh->place)) ||
        check_mass(check, path, body) || check_pins(check, scene, path, body) ||
        check_pressure(check, path, body) ||
        check_texture(check, path, body->material.texture) || cs_check_faces(check, path, body))
        return check->error->status;
    return CS_OK;
}

/* Checks all bodies, and their particles together against CS_PARTICLES_MAX. */
static enum cs_status check_bodies(const struct cs_check *check, struct cs_scene *scene) {
    struct cs_body *bodies = cs_scene_bodies(scene);
    double particles = 0;
    if (scene->bodies.n == 0)
        return cs_check_refuse(check, "bodies", "found none, expected at least one body");
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        if (check_body(check, scene, b, bodies + b))
            return check->error->status;
        particles += (double)cs_body_count(bodies + b);
    }
    if (particles > CS_PARTICLES_MAX)
        return cs_check_refuse(check, "bodies",
                               "%.0f particles in total, expected at most %.0f", particles,
                               CS_PARTICLES_MAX);
    return CS_OK;
}

/* Checks a collider by its shape's own check. */
static enum cs_status check_collider(const struct cs_check *check, uint32_t c,
                                     struct cs_collider *collider) {
    const struct cs_shape *shape = cs_collider_shape(collider);
    char path[64];
    snprintf(path, sizeof path, "colliders[%u]", c);
    cs_shape_assert(shape);
    return shape->check ? shape->check(check, path, collider) : CS_OK;
}

static enum cs_status check_colliders(const struct cs_check *check, struct cs_scene *scene) {
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        if (check_collider(check, c, cs_scene_colliders(scene) + c))
            return check->error->status;
    return CS_OK;
}

/* Returns the first pair of the list with the bodies of pair p, in either order. */
static uint32_t find_pair(const struct cs_body_pair_keys *pairs, uint32_t p) {
    const int64_t *of = pairs[p].bodies;
    uint32_t k = 0;
    while (!(pairs[k].bodies[0] == of[0] && pairs[k].bodies[1] == of[1]) &&
           !(pairs[k].bodies[0] == of[1] && pairs[k].bodies[1] == of[0]))
        k++;
    return k;
}

/* Checks that listed pairs are two different bodies, each pair once. */
static enum cs_status check_pairs(const struct cs_check *check, const struct cs_scene *scene) {
    const struct cs_body_pair_keys *pairs = scene->pairs->list.items;
    char path[64];
    for (uint32_t p = 0; p < scene->pairs->list.n; p++) {
        snprintf(path, sizeof path, "pairs.list[%u].bodies", p);
        for (int k = 0; k < 2; k++)
            if (pairs[p].bodies[k] >= scene->bodies.n)
                return cs_check_refuse(check, path, "found body %lld, expected 0..%u",
                                       (long long)pairs[p].bodies[k], scene->bodies.n - 1);
        if (pairs[p].bodies[0] == pairs[p].bodies[1])
            return cs_check_refuse(
                check, path, "found body %lld twice, expected bodies[%lld].self_contact",
                (long long)pairs[p].bodies[0], (long long)pairs[p].bodies[0]);
        if (find_pair(pairs, p) < p)
            return cs_check_refuse(check, path,
                                   "bodies %lld and %lld are in pairs.list[%u] already",
                                   (long long)pairs[p].bodies[0], (long long)pairs[p].bodies[1],
                                   find_pair(pairs, p));
    }
    return CS_OK;
}

/* Refuses contact between surfaces unless the contact law is a force: projection handles single
 * particles against colliders with a distance. */
static enum cs_status check_meetings(const struct cs_check *check,
                                     const struct cs_scene *scene) {
    char path[64] = "pairs";
    if (check_pairs(check, scene))
        return check->error->status;
    if (scene->contact->law == CS_CONTACT_FORCE || !cs_scene_has_body_contact(scene))
        return CS_OK;
    for (uint32_t b = scene->bodies.n; b--;)
        if (cs_scene_bodies(scene)[b].self_contact)
            snprintf(path, sizeof path, "bodies[%u].self_contact", b);
    for (uint32_t c = scene->colliders.n; c--;)
        if (cs_scene_colliders(scene)[c].mesh)
            snprintf(path, sizeof path, "colliders[%u].mesh", c);
    return cs_check_refuse(
        check, path,
        "contact.law is project, which handles only colliders that are not meshes; "
        "expected contact.law force");
}

/* Refuses friction that sticks where it is not known: without a force, and between surfaces
 * that meet in pairs. */
static enum cs_status check_sticking(const struct cs_check *check,
                                     const struct cs_scene *scene) {
    const struct cs_body_pair_keys *pairs = scene->pairs->list.items;
    char path[64] = "";
    if (scene->contact->friction_law != CS_FRICTION_BRISTLES)
        return CS_OK;
    if (scene->contact->law != CS_CONTACT_FORCE)
        return cs_check_refuse(check, "contact.friction_law",
                               "found stick with contact.law project, expected contact.law "
                               "force");
    for (uint32_t b = scene->bodies.n; b--;)
        if (cs_scene_bodies(scene)[b].self_contact && cs_scene_bodies(scene)[b].friction > 0)
            snprintf(path, sizeof path, "bodies[%u].friction", b);
    if (scene->pairs->among == CS_PAIRS_ALL && scene->pairs->friction > 0 &&
        scene->bodies.n > 1)
        snprintf(path, sizeof path, "pairs.friction");
    for (uint32_t p = scene->pairs->list.n; p--;)
        if (pairs[p].friction > 0)
            snprintf(path, sizeof path, "pairs.list[%u].friction", p);
    for (uint32_t c = scene->colliders.n; c--;)
        if (cs_scene_colliders(scene)[c].mesh) {
            char key[64];
            snprintf(key, sizeof key, "colliders[%u].friction", c);
            if (cs_event_key_acts(scene, cs_scene_colliders(scene)[c].friction, key))
                memcpy(path, key, sizeof path);
        }
    return *path ? cs_check_refuse(check, path,
                                   "contact.friction_law stick does not act between surfaces "
                                   "that meet; expected 0 here, or friction_law smooth")
                 : CS_OK;
}

/* Checks that the keys of a camera path ascend in time and that each is a view. */
static enum cs_status check_camera_path(const struct cs_check *check,
                                        const struct cs_camera *camera) {
    const struct cs_camera_key *keys = camera->path.items;
    char path[64];
    for (uint32_t k = 0; k < camera->path.n; k++) {
        const char *key,
            *fault = cs_viewpoint_fault(keys[k].eye, keys[k].target, camera->up, &key);
        const bool is_up = fault && !strcmp(key, "up");
        snprintf(path, sizeof path, "camera.path[%u]%s", k, fault && !is_up ? ".target" : "");
        if (isnan(keys[k].at))
            return cs_check_refuse(check, path, "missing key \"at\"");
        if (k > 0 && !(keys[k].at > keys[k - 1].at))
            return cs_check_refuse(check, path, "at = %.9g s is not after %.9g s", keys[k].at,
                                   keys[k - 1].at);
        if (fault)
            return cs_check_refuse(check, path, is_up ? "camera.up %s" : "%s", fault);
    }
    return CS_OK;
}

static enum cs_status check_camera(const struct cs_check *check,
                                   const struct cs_camera *camera) {
    char path[64];
    const char *key, *fault = cs_viewpoint_fault(camera->eye, camera->target, camera->up, &key);
    snprintf(path, sizeof path, "camera.%s", fault ? key : "");
    if (fault)
        return cs_check_refuse(check, path, "%s", fault);
    if (camera->path.n && camera->frame == CS_FRAME_AUTO)
        return cs_check_refuse(check, "camera.path",
                               "frame auto computes the camera itself, expected no path");
    return check_camera_path(check, camera);
}

static enum cs_status check_light(const struct cs_check *check, const char *path,
                                  struct cs_light *light) {
    const bool point = !isnan(light->point[0]), direction = !isnan(light->direction[0]);
    char key[CS_TEXT_MAX];
    snprintf(key, sizeof key, "%s.direction", path);
    if (point && direction)
        return cs_check_refuse(check, path, "found point and direction, expected one of them");
    return direction ? cs_check_unit(check, key, light->direction, 3) : CS_OK;
}

/* Checks light and lights; only the first has a direction by default. */
static enum cs_status check_lights(const struct cs_check *check, struct cs_scene *scene) {
    struct cs_light *lights = scene->lights.items;
    if (scene->lights.n >= CS_LIGHTS)
        return cs_check_refuse(check, "lights", "found %u, expected at most %d",
                               scene->lights.n, CS_LIGHTS - 1);
    for (uint32_t k = 0; k < scene->lights.n; k++) {
        char path[32];
        snprintf(path, sizeof path, "lights[%u]", k);
        if (isnan(lights[k].point[0]) && isnan(lights[k].direction[0]))
            return cs_check_refuse(check, path, "expected a point or a direction");
        if (check_light(check, path, lights + k))
            return check->error->status;
    }
    return check_light(check, "light", scene->light);
}

/* Checks that the body has the marked particles. */
static enum cs_status check_marks(const struct cs_check *check, const struct cs_scene *scene) {
    const struct cs_marks *marks = &scene->render->marks;
    const struct cs_pin *pins = marks->particles.items;
    char path[64], fault[200];
    if (marks->body >= scene->bodies.n)
        return cs_check_refuse(check, "render.marks.body", "found %lld, expected 0..%u",
                               (long long)marks->body, scene->bodies.n - 1);
    for (uint32_t k = 0; k < marks->particles.n; k++) {
        snprintf(path, sizeof path, "render.marks.particles[%u]", k);
        if (cs_body_pin_fault(cs_scene_bodies(scene) + marks->body, pins + k, fault,
                              sizeof fault))
            return cs_check_refuse(check, path, "%s", fault);
    }
    return CS_OK;
}

/* Checks samples, range and background of the pictures. */
static enum cs_status check_render(const struct cs_check *check,
                                   const struct cs_render *render) {
    if (render->samples != 1 && render->samples != 4 && render->samples != 8)
        return cs_check_refuse(check, "render.samples", "found %lld, expected 1, 4 or 8",
                               (long long)render->samples);
    if (!isnan(render->range[0]) && !(render->range[0] < render->range[1]))
        return cs_check_refuse(check, "render.range",
                               "found %.9g, %.9g, expected the smaller value first",
                               render->range[0], render->range[1]);
    if (!isnan(render->background.below[0]) &&
        render->background.kind != CS_BACKGROUND_GRADIENT)
        return cs_check_refuse(check, "render.background.below",
                               "only a gradient has a colour below");
    return CS_OK;
}

/* Makes the direction of the wind a unit vector, and checks that it is there unless the air has
 * a velocity. */
static enum cs_status check_wind(const struct cs_check *check, struct cs_wind *wind) {
    const bool flows = !isnan(wind->velocity[0]);
    // none yet: an event may bring it
    for (int c = 0; c < 3 && !wind->present; c++)
        wind->direction[c] = 0;
    if (!wind->present)
        return CS_OK;
    if (isnan(wind->direction[0]) && (!flows || wind->strength > 0))
        return cs_check_refuse(check, "forces.wind.direction",
                               "missing, expected a list of 3 numbers%s",
                               flows ? " for strength" : ", or velocity in m/s");
    // events may give it a strength
    for (int c = 0; c < 3 && isnan(wind->direction[2]); c++)
        wind->direction[c] = cs_vec3_is_zero(wind->velocity) ? c == 0 : wind->velocity[c];
    return cs_check_unit(check, "forces.wind.direction", wind->direction, 3);
}

enum cs_status cs_scene_check(struct cs_scene *scene, char *path_out, struct cs_error *error) {
    const struct cs_check check = {path_out, error};
    path_out[0] = 0;
    if (check_bodies(&check, scene) || check_colliders(&check, scene) ||
        check_meetings(&check, scene) || check_sticking(&check, scene) ||
        cs_seams_check(&check, scene) || check_wind(&check, &scene->forces->wind) ||
        check_camera(&check, scene->camera) || check_lights(&check, scene) ||
        check_render(&check, scene->render) || check_marks(&check, scene) ||
        cs_events_check(scene, path_out, error))
        return error->status;
    return CS_OK;
}
