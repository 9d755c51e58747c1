/* Decides which features a scene and a method need, and prints them with bytes and reasons. */
#include "model/plan.h"

#include "base/pool.h"
#include "mesh/trimesh.h"
#include "mesh/vertex_paths.h"
#include "model/contact/rebound.h"
#include "model/event/event_state.h"
#include "model/force/terms.h"
#include "model/solver/multigrid.h"
#include "model/spring/springs.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/body_particles.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/event_key.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"

#include <math.h>

/* Printed names of enum cs_feature. */
static const char *const feature_names[CS_FEATURES] = {
#define X(name, text) text,
    CS_FEATURE_LIST(X)
#undef X
};

/* Sets the row of a feature, with the reason for the decision. */
static void decide(struct cs_plan *plan, enum cs_feature feature, bool built, const char *why,
                   const char *why_not) {
    plan->rows[feature] = (struct cs_plan_row){.built = built, .reason = built ? why : why_not};
}

/* Counts particles and springs. Springs of meshes are also counted by surface and network, to
 * be printed. */
static void count_bodies(struct cs_plan *plan, const struct cs_scene *scene) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    plan->n_bodies = scene->bodies.n;
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const uint32_t before = plan->n_springs;
        plan->n += (uint32_t)cs_body_count(bodies + b);
        cs_springs_of_body(bodies + b, b, 0, NULL, NULL, &plan->n_springs);
        if (!bodies[b].mesh)
            continue;
        const uint32_t inner =
            bodies[b].springs.stretch > 0 ? bodies[b].geometry->n_network_springs : 0;
        plan->n_network_springs += inner;
        plan->n_surface_springs += plan->n_springs - before - inner;
    }
}

/* Counts bytes of meshes and key frames. They belong to the scene, and exist before anything is
 * built. */
static void count_bytes(struct cs_plan *plan, const struct cs_scene *scene) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    size_t *meshes = &plan->rows[CS_FEATURE_MESHES].bytes;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        *meshes += bodies[b].geometry ? bodies[b].geometry->bytes : 0;
    for (uint32_t c = 0; c < scene->colliders.n; c++) {
        const struct cs_collider *of = cs_scene_colliders(scene) + c;
        *meshes += of->geometry ? of->geometry->bytes : 0;
        plan->rows[CS_FEATURE_KEY_FRAMES].bytes += of->paths ? of->paths->bytes : 0;
    }
}

/* Tells whether a body has a property. */
static bool any_body(const struct cs_scene *scene, bool (*has)(const struct cs_body *body)) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        if (has(bodies + b))
            return true;
    return false;
}
static bool is_mesh(const struct cs_body *body) {
    return body->mesh;
}
static bool has_damping(const struct cs_body *body) {
    return body->springs.damping > 0;
}
static bool has_limit(const struct cs_body *body) {
    return !isnan(body->strain_limit);
}

/* Forces and what belongs to them. A feature that an event can switch on counts as needed. */
static void plan_forces(struct cs_plan *plan, const struct cs_scene *scene) {
    const struct cs_forces *forces = scene->forces;
    const bool springs = plan->n_springs > 0;
    decide(plan, CS_FEATURE_SPRINGS, springs, "the bodies have springs",
           cs_scene_first_matched(scene) < plan->n_bodies
               ? "no stiffness above 0, or shape_matching instead"
           : cs_scene_first_elastic(scene) < plan->n_bodies
               ? "no stiffness above 0, or elastic instead"
               : "no stiffness above 0");
    decide(plan, CS_FEATURE_DAMPING,
           springs && (any_body(scene, has_damping) || cs_event_key_changes(scene, ".damping")),
           "springs.damping is above 0", "springs.damping is 0");
    for (uint32_t k = 0; k < cs_n_terms; k++) {
        cs_term_assert(cs_terms[k]);
        plan->forces[k] = cs_terms[k]->plan(scene);
    }
    decide(plan, CS_FEATURE_AREA, cs_terms_use(scene, plan) & CS_USE_AREA,
           "a force is per area", "no force is per area");
    decide(plan, CS_FEATURE_VELOCITY_LOSS,
           forces->velocity_loss > 0 || cs_event_key_changes(scene, "forces.velocity_loss"),
           "forces.velocity_loss is above 0", "forces.velocity_loss is 0");
    decide(plan, CS_FEATURE_STRAIN_LIMIT, springs && any_body(scene, has_limit),
           "a body has strain_limit", "no strain_limit");
    const bool leads = !isnan(scene->contact->untangle), sews = cs_scene_sews(scene, true);
    decide(plan, CS_FEATURE_EVENTS,
           scene->events.n > 0 || leads || sews || cs_scene_carries_pins(scene, true),
           scene->events.n > 0 ? "the scene has events"
           : leads             ? "contact.untangle is given"
           : sews              ? "colliders carry what is sewn to them"
                               : "key frames carry particles",
           "no events");
    decide(plan, CS_FEATURE_VIEWPOINT_FORCES, cs_viewpoint_forces_any(scene),
           "an event is a viewpoint_force; it needs a visibility test",
           "no event is a viewpoint_force");
}

#define PROJECTED_BY_DEFAULT                                                                   \
    "no contact.law is given, and the integrator or the bodies do not suit a force"

/* Contact by projection, and the test for crossings. Contact by force is a force of the list.
 */
static void plan_contact(struct cs_plan *plan, const struct cs_scene *scene, bool render) {
    decide(plan, CS_FEATURE_CONTACT,
           scene->colliders.n > 0 && scene->contact->law == CS_CONTACT_PROJECT,
           scene->contact->law_is_default ? PROJECTED_BY_DEFAULT : "contact.law is project",
           scene->colliders.n > 0 ? "contact is a force" : "no colliders");
    decide(plan, CS_FEATURE_FRICTION_ANCHORS, cs_scene_friction_sticks(scene),
           "contact.friction_law is stick",
           scene->contact->law == CS_CONTACT_FORCE && scene->colliders.n > 0
               ? (scene->contact->friction_law == CS_FRICTION_BRISTLES
                      ? "no friction on colliders that are no meshes"
                      : "contact.friction_law is smooth")
               : "no contact by force with a collider");
    const bool shown = render && scene->render->look == CS_LOOK_CROSSINGS;
    const bool wanted = cs_scene_crossings(scene) != CS_CROSSINGS_IGNORE;
    decide(plan, CS_FEATURE_CROSSINGS, wanted || shown,
           cs_scene_crossings_by_pairs(scene)
               ? "bodies have contact with each other or themselves"
           : wanted ? "crossings is not ignore"
                    : "they are drawn",
           "crossings is ignore");
}

/* Tells whether a contact by force has friction, now or after an event. */
static bool has_friction(const struct cs_scene *scene) {
    const uint32_t n = cs_scene_surfaces(scene);
    bool any = cs_event_key_changes(scene, ".friction");
    double friction;
    for (uint32_t c = 0; c < scene->colliders.n; c++)
        any |= cs_scene_colliders(scene)[c].friction > 0;
    // friction that sticks to colliders has a memory, and is not lagged
    any &= scene->contact->law == CS_CONTACT_FORCE && !cs_scene_friction_sticks(scene);
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = a; b < n; b++)
            any |= cs_scene_bodies_collide(scene, a, b, &friction) && friction > 0;
    return any;
}

/* Features that depend on the integrator. */
static void plan_needs(struct cs_plan *plan, const struct cs_scene *scene, uint32_t needs) {
    const char *idle = "the integrator does not ask for it";
    const bool matched = cs_scene_first_matched(scene) < plan->n_bodies;
    decide(plan, CS_FEATURE_SPRING_LIST, needs & CS_NEED_SPRINGS, "the integrator asks for it",
           idle);
    plan->colours = needs & CS_NEED_SPRINGS && needs & CS_NEED_COLOURS;
    decide(plan, CS_FEATURE_CLUSTERS, needs & CS_NEED_CLUSTERS && matched,
           "bodies have shape_matching, and the integrator asks for it",
           needs & CS_NEED_CLUSTERS ? "no body has shape_matching" : idle);
    const bool lags = needs & CS_NEED_LAGGED_FRICTION;
    decide(plan, CS_FEATURE_LAGGED_FRICTION, lags && has_friction(scene),
           "contact has friction, and the integrator asks for it",
           lags ? "no contact by force with friction" : idle);
    decide(plan, CS_FEATURE_SOLVER, needs & CS_NEED_SOLVE,
           cs_multigrid_is_used(scene) ? "the integrator asks for it; multigrid for stiff steps"
           : cs_multigrid_is_in_reserve(scene)
               ? "the integrator asks for it; multigrid for solves that are slow with blocks"
               : "the integrator asks for it",
           idle);
    const bool rebounds = needs & CS_NEED_REBOUNDS && needs & CS_NEED_SOLVE;
    decide(plan, CS_FEATURE_REBOUNDS, rebounds && cs_rebounds_possible(scene),
           "particles in impact with a collider are stepped alone",
           rebounds ? "no contact by force with a collider that is no mesh" : idle);
}

void cs_plan_make(struct cs_plan *plan, const struct cs_scene *scene, uint32_t needs,
                  bool render) {
    *plan = (struct cs_plan){0};
    count_bodies(plan, scene);
    const bool bodies_are = any_body(scene, is_mesh);
    decide(plan, CS_FEATURE_MESHES, bodies_are || cs_scene_surfaces(scene) > scene->bodies.n,
           bodies_are ? "bodies are meshes" : "colliders are meshes", "every body is a grid");
    decide(plan, CS_FEATURE_KEY_FRAMES, cs_scene_has_key_frames(scene),
           "a collider has key_frames", "no collider has key_frames");
    count_bytes(plan, scene);
    plan_forces(plan, scene);
    plan_contact(plan, scene, render);
    plan_needs(plan, scene, needs);
    decide(plan, CS_FEATURE_RENDER, render, "frames are drawn", "no frame is drawn");
    decide(plan, CS_FEATURE_THREADS, cs_pool_threads() > 1, "several share the work",
           "one does all the work");
}

bool cs_plan_has_own_springs(const struct cs_integrator *method) {
    return method->fidelity != CS_FIDELITY_ODE &&
           method->needs & (CS_NEED_SPRINGS | CS_NEED_CLUSTERS);
}

/* Says what makes a scene's motion not smooth: contact, what acts after a step, events and
 * their forces (CS_PART_EXTERNAL). NULL: nothing. */
static const char *what_is_not_smooth(const struct cs_scene *scene) {
    static const enum cs_feature features[] = {CS_FEATURE_EVENTS, CS_FEATURE_VELOCITY_LOSS,
                                               CS_FEATURE_STRAIN_LIMIT, CS_FEATURE_CROSSINGS};
    if (scene->colliders.n > 0 || cs_scene_has_body_contact(scene))
        return scene->colliders.n > 0 ? "the scene has colliders" : "bodies have contact";
    struct cs_plan plan;
    cs_plan_make(&plan, scene, 0, false);
    for (size_t k = 0; k < sizeof features / sizeof *features; k++)
        if (plan.rows[features[k]].built)
            return plan.rows[features[k]].reason;
    for (uint32_t k = 0; k < cs_n_terms; k++)
        if (plan.forces[k].built && cs_terms[k]->part_bits & CS_PART_EXTERNAL)
            return plan.forces[k].reason;
    return NULL;
}

void cs_plan_choose_contact_law(struct cs_scene *scene, const struct cs_integrator *method) {
    const struct cs_body *bodies = cs_scene_bodies(scene);
    const bool follows =
        !(method->traits & CS_EXPLICIT_OUTER || method->needs & CS_NEED_CLUSTERS) &&
        !(method->traits & CS_NOT_GALILEAN && cs_event_moves_any(scene));
    bool elastic = !isnan(scene->contact->stiffness);
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        elastic |= bodies[b].elastic.present ||
                   (bodies[b].springs.stretch > 0 && !cs_scene_springs_left_out(bodies + b));
    if (scene->contact->law_is_default && scene->colliders.n > 0 &&
        !cs_scene_has_body_contact(scene) && !(follows && elastic))
        scene->contact->law = CS_CONTACT_PROJECT;
}

enum cs_status cs_plan_check(const struct cs_scene *scene, const struct cs_integrator *method,
                             struct cs_error *error) {
    const uint32_t matched = cs_scene_first_matched(scene);
    if (matched < scene->bodies.n && !(method->needs & CS_NEED_CLUSTERS))
        return cs_fail(error, CS_ERR_SCENE,
                       "bodies[%u].shape_matching: no force law, so integrator \"%s\" cannot "
                       "follow it, and no error can be measured; use clothsim run "
                       "--integrator shape-matching",
                       matched, method->name);
    if (matched == scene->bodies.n && method->needs & CS_NEED_CLUSTERS)
        return cs_fail(error, CS_ERR_SCENE,
                       "bodies: none has shape_matching, and without it integrator \"%s\" has "
                       "nothing to match",
                       method->name);
    if (scene->contact->law == CS_CONTACT_FORCE &&
        (scene->colliders.n > 0 || cs_scene_has_body_contact(scene)) &&
        method->traits & CS_EXPLICIT_OUTER)
        return cs_fail(error, CS_ERR_SCENE,
                       "contact.law: force is too stiff for integrator \"%s\", which treats "
                       "contact explicitly; use %sanother integrator",
                       method->name, cs_scene_has_body_contact(scene) ? "" : "project, or ");
    if (scene->contact->law == CS_CONTACT_FORCE && method->traits & CS_NOT_GALILEAN &&
        cs_event_moves_any(scene))
        return cs_fail(
            error, CS_ERR_SCENE,
            "contact.law: force gains energy by integrator \"%s\" where colliders move, "
            "because its drag does not move with them; use %sanother integrator",
            method->name, cs_scene_has_body_contact(scene) ? "" : "project, or ");
    const uint32_t elastic = cs_scene_first_elastic(scene);
    if (elastic < scene->bodies.n && cs_plan_has_own_springs(method))
        return cs_fail(
            error, CS_ERR_SCENE,
            "bodies[%u].elastic: integrator \"%s\" has a model of springs of its own, "
            "and none of membranes; use another integrator",
            elastic, method->name);
    if (cs_scene_sews(scene, false) && method->traits & CS_EXPLICIT_OUTER)
        return cs_fail(error, CS_ERR_SCENE,
                       "seams: integrator \"%s\" treats all forces but springs explicitly, for "
                       "which stitches are too stiff; use another integrator",
                       method->name);
    const char *acts = method->traits & CS_SMOOTH_ONLY ? what_is_not_smooth(scene) : NULL;
    if (acts)
        return cs_fail(error, CS_ERR_SCENE,
                       "integrator \"%s\" needs motion without contact or events, but %s; "
                       "use another integrator",
                       method->name, acts);
    return CS_OK;
}

/* One line of the plan; none for a row without a reason. */
static void print_row(const char *name, const struct cs_plan_row *row, struct cs_text *out) {
    if (row->reason)
        cs_text_add(out, "%-18s %-9s %10zu bytes   %s\n", name,
                    row->built ? "built" : "not built", row->bytes, row->reason);
}

void cs_plan_print(const struct cs_plan *plan, struct cs_text *out) {
    cs_text_add(out,
                "particles          %u\nbodies             %u\nsprings            %u\n"
                "state              %zu bytes\n",
                plan->n, plan->n_bodies, plan->n_springs, plan->state_bytes);
    if (plan->n_surface_springs)
        cs_text_add(out, "on surfaces        %u springs\n", plan->n_surface_springs);
    if (plan->n_network_springs)
        cs_text_add(out, "inside             %u springs\n", plan->n_network_springs);
    for (uint32_t f = 0; f < CS_FEATURE_AREA; f++)
        print_row(feature_names[f], plan->rows + f, out);
    for (uint32_t k = 0; k < cs_n_terms; k++)
        print_row(cs_terms[k]->name, plan->forces + k, out);
    for (uint32_t f = CS_FEATURE_AREA; f < CS_FEATURES; f++)
        print_row(feature_names[f], plan->rows + f, out);
}
