/* initial_penetration.c - refuses particles that start inside a collider, or moves them out
 * once; refuses surfaces that start crossed.
 *
 * Contact forces keep separated surfaces apart but cannot untangle surfaces that already
 * intersect. A particle is moved out of the collider in which it is deepest, along its normal
 * by the depth, until it is in none. Colliders that overlap may push it to and fro, so the
 * number of passes is limited. */
#include "model/post_step/contact_projection.h"

#include "model/contact/barrier_law.h"
#include "model/contact/ccd/crossings.h"
#include "model/contact/ccd/edge_triangle.h"
#include "model/contact/collider_params.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/posed_collider.h"
#include "model/event/carrier.h"
#include "model/event/event_state.h"
#include "model/force/diagnostics.h"

#include "base/vec3.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* passes after which a particle counts as caught between colliders; chosen by trial */
enum { PASSES = 16 };
/* Times that the layer in front of colliders is made 1.5 times as thick where the surface
 * between particles would still be inside, by trial; and m/s at which contact may throw what
 * "allow" lets start inside, the speed of sound in air. */
enum { LAYERS = 8, SPEED_MAX = 340 };

/* Moves out of colliders. With contact.untangle particles keep their place in `start` (3,n)
 * until they are led away, and keep `layer` times the distance at which a collider carries
 * them; NULL: they are moved at once. */
struct leaving {
    double *start, layer;
    uint32_t *colliders; /* (n) number of the collider that a particle leaves + 1, or 0 */
};

/* m in front of the bare surface of a collider to which a particle is moved: by contact by
 * force where it carries its own weight. */
static double way_beyond(const struct cs_system *system, uint32_t i, uint32_t collider) {
    const double *g = system->scene->forces->gravity;
    const double weight = system->mass[i] * sqrt(cs_vec3_dot(g, g));
    double range = system->collider_params ? system->collider_params[collider].range : 0,
           k = range > 0 ? system->collider_params[collider].k : 0;
    for (uint32_t b = 0; system->pairs && b < system->scene->bodies.n; b++) {
        const struct cs_body_pair_params *params = cs_body_pair_params_of(
            &system->pairs->body_pairs, b, system->scene->bodies.n + collider);
        if (i - system->bodies[b].first < system->bodies[b].count && params->range > 0)
            range = params->range, k = params->k;
    }
    return range > 0 ? cs_barrier_loaded_distance(range, k, weight) : 0;
}

/* m, signed distance of p from a closed mesh, negative where a ray along x goes through an odd
 * number of triangles; n points outwards. HUGE_VAL from an open one, which has no inside. */
static double mesh_distance(const struct cs_posed_collider *mesh, const double p[3],
                            double n[3]) {
    const struct cs_trimesh *geometry = mesh->collider->geometry;
    double least = HUGE_VAL;
    bool inside = false;
    if (geometry->n_open)
        return HUGE_VAL;
    for (uint32_t t = 0; t < geometry->n_triangles; t++) {
        struct cs_carrier at;
        double corners[3][3], own[3], far = p[0];
        cs_carrier_at(mesh, t, &at);
        for (uint32_t k = 0; k < 3; k++) {
            cs_posed_collider_vertex(mesh, geometry->triangles[3 * t + k], corners[k], NULL);
            far = fmax(far, corners[k][0] + 1);
        }
        const double ray[2][3] = {{p[0], p[1], p[2]}, {far, p[1], p[2]}};
        inside = inside != cs_edge_crosses_triangle(ray, (const double(*)[3])corners);
        const double squared = cs_carrier_find(&at, p, own);
        if (!(squared < least))
            continue;
        least = squared;
        // to the nearest point of the triangle
        const double a = fmin(fmax(own[0], 0), 1), b = fmin(fmax(own[1], 0), 1 - a);
        for (int c = 0; c < 3; c++)
            n[c] = squared > 0 ? at.place[0][c] + a * at.place[1][c] + b * at.place[2][c] - p[c]
                               : at.place[3][c];
    }
    const double length = sqrt(cs_vec3_dot(n, n)), sign = inside || least == 0 ? 1 : -1;
    for (int c = 0; c < 3; c++)
        n[c] *= sign / length;
    return inside ? -sqrt(least) : sqrt(least);
}

/* The collider that a particle is deepest in, and its way out: depth times n. */
struct penetration {
    uint32_t collider;
    double n[3], depth;
};

/* Finds that of particle i at p, or of one that it is by half a layer too near to; returns
 * false if there is none. */
static bool find_penetration(const struct cs_system *system, const struct leaving *leaving,
                             uint32_t i, const double p[3], struct penetration *out) {
    out->depth = CS_PENETRATION_MIN;
    bool found = false;
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        const bool project = system->scene->contact->law == CS_CONTACT_PROJECT;
        struct cs_posed_collider posed;
        double normal[3];
        cs_posed_collider_at(system, k, 0, &posed);
        const bool mesh = posed.shape->bounds == CS_BOUNDS_MESH && leaving->start;
        const double gap = mesh      ? mesh_distance(&posed, p, normal)
                           : project ? cs_posed_collider_signed_distance(&posed, p, normal)
                                     : cs_posed_collider_distance(&posed, p, normal);
        const double layer = leaving->layer > 0 ? leaving->layer * way_beyond(system, i, k) : 0;
        // half a layer does: where a surface is hollow, moves out of one face lead to others
        if (!(0.5 * layer - gap > out->depth))
            continue;
        out->depth = layer - gap;
        out->collider = k;
        memcpy(out->n, normal, sizeof normal);
        found = true;
    }
    return found;
}

/* Reports particle i with its depth. */
static enum cs_status refuse_penetration(const struct cs_system *system, uint32_t i,
                                         uint32_t collider, double depth,
                                         struct cs_error *error) {
    struct cs_text text = {0};
    const bool asked = system->scene->contact->start == CS_CONTACT_START_MOVE_OUT ||
                       !isnan(system->scene->contact->untangle);
    cs_system_print_particle(system, i, &text);
    cs_fail(error, CS_ERR_SCENE, "%s: %s starts %.3g m inside colliders[%u]%s",
            system->scene->path, cs_text_get(&text), depth, collider,
            asked ? ", and another collider blocks its way out"
                  : ": move it outside, or set contact.start to \"move-out\", or "
                    "contact.untangle to the seconds in which to move it");
    cs_text_finish(&text);
    return error->status;
}

/* Moves particle i out of all colliders, or refuses it. */
static enum cs_status clear(struct cs_system *system, const struct leaving *leaving, uint32_t i,
                            struct cs_initial_penetration *penetration,
                            struct cs_error *error) {
    const size_t size = system->view.n;
    double *x = system->state;
    double p[3] = {x[i], x[size + i], x[2 * size + i]}, moved = 0;
    struct penetration out;
    for (int pass = 0; find_penetration(system, leaving, i, p, &out); pass++) {
        if (pass == PASSES ||
            (!leaving->start && system->scene->contact->start == CS_CONTACT_START_REFUSE))
            return refuse_penetration(system, i, out.collider, out.depth, error);
        if (leaving->start && !leaving->colliders[i])
            leaving->colliders[i] = out.collider + 1;
        // one that is moved by contact by force carries its weight where it comes to lie
        out.depth += leaving->start ? 0 : way_beyond(system, i, out.collider);
        for (int c = 0; c < 3; c++)
            p[c] += out.depth * out.n[c];
        moved += out.depth;
    }
    if (moved == 0)
        return CS_OK;
    for (size_t c = 0; c < 3; c++)
        x[c * size + i] = p[c];
    penetration->n++;
    penetration->depth = fmax(penetration->depth, moved);
    return CS_OK;
}

/* Samples of one collider. */
struct between {
    const struct cs_system *system;
    struct cs_posed_collider posed;
    uint32_t collider;
    struct cs_error *error;
};

/* Refuses a sample of an edge or triangle that is inside the collider. */
static void check_sample(void *arg, const struct cs_contact_sample_point *point) {
    const struct between *between = arg;
    const struct cs_system *system = between->system;
    double p[3], n[3];
    cs_contact_sample_interpolate(point, system->view.n, system->state, p);
    const double depth = -cs_posed_collider_distance(&between->posed, p, n);
    // particles themselves are moved out or refused before
    if (point->n == 1 || between->error->status || !(depth > CS_PENETRATION_MIN) ||
        cs_contact_sample_mass(system, point) == HUGE_VAL)
        return;
    struct cs_text first = {0}, second = {0};
    cs_system_print_particle(system, point->particles[0], &first);
    cs_system_print_particle(system, point->particles[1], &second);
    cs_fail(between->error, CS_ERR_SCENE,
            "%s: between %s and %s the surface starts %.3g m inside colliders[%u]: move it "
            "outside",
            system->scene->path, cs_text_get(&first), cs_text_get(&second), depth,
            between->collider);
    cs_text_finish(&first);
    cs_text_finish(&second);
}

/* Checks the samples of all colliders. */
static enum cs_status check_between(const struct cs_system *system, struct cs_error *error) {
    struct between between = {.system = system, .error = error};
    for (uint32_t k = 0; k < system->scene->colliders.n && !error->status; k++) {
        between.collider = k;
        cs_posed_collider_at(system, k, 0, &between.posed);
        cs_contact_points_visit(system, k, check_sample, &between);
    }
    return error->status;
}

/* Refuses surfaces with contact that cross at the start. */
static enum cs_status check_crossings(const struct cs_system *system, struct cs_error *error) {
    if (!system->pairs || !system->crossings)
        return CS_OK;
    const struct cs_crossing_count found = cs_crossings_start(system);
    struct cs_text text = {0};
    if (found.n) {
        cs_crossings_print(system, &found, &text);
        cs_fail(error, CS_ERR_SCENE,
                "%s: at the start %s: separate the bodies, %sor set crossings to \"ignore\"",
                system->scene->path, cs_text_get(&text),
                system->points && isnan(system->scene->contact->untangle)
                    ? "set contact.untangle where one is inside a closed collider, "
                    : "");
    }
    cs_text_finish(&text);
    return error->status;
}

/* Particles first, then samples, whose vertices may have been moved, then crossings. */
static enum cs_status check_inside(struct cs_system *system,
                                   struct cs_initial_penetration *penetration,
                                   struct cs_error *error) {
    const struct leaving at_once = {.start = NULL};
    for (uint32_t i = 0; i < system->view.n && system->scene->colliders.n && !error->status;
         i++)
        if (system->inv_mass[i] > 0)
            clear(system, &at_once, i, penetration, error);
    if (!error->status && system->contact_samples)
        check_between(system, error);
    return error->status ? error->status : check_crossings(system, error);
}

/* Bodies within range come last: no move of whole bodies cures what is inside or crossed. A
 * move may bring a body into another surface, and all is checked again. */
static enum cs_status resolve(struct cs_system *system,
                              struct cs_initial_penetration *penetration,
                              struct cs_error *error) {
    if (check_inside(system, penetration, error))
        return error->status;
    if (system->scene->contact->law == CS_CONTACT_FORCE &&
        cs_initial_layer_resolve(system, penetration, error))
        return error->status;
    return penetration->n_moves ? check_inside(system, penetration, error) : CS_OK;
}

/* Returns whether a particle starts inside a collider. */
static bool is_any_inside(const struct cs_system *system, const struct leaving *leaving) {
    const size_t n = system->view.n;
    const double *x = leaving->start;
    struct penetration out;
    for (uint32_t i = 0; i < n; i++)
        if (system->inv_mass[i] > 0 &&
            find_penetration(system, leaving, i, (double[3]){x[i], x[n + i], x[2 * n + i]},
                             &out))
            return true;
    return false;
}

/* J of contact that the particles may store when they arrive: as bodies at the start
 * (initial_layer.c), their weight times the range. */
static double admitted_energy(const struct cs_system *system, const struct leaving *leaving) {
    const double *g = system->scene->forces->gravity;
    double sum = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (leaving->colliders[i])
            sum += system->mass[i] * sqrt(cs_vec3_dot(g, g)) *
                   way_beyond(system, i, leaving->colliders[i] - 1);
    return sum;
}

/* Places all particles outside, in a layer as thick as the surface between them needs: nothing
 * is inside, and contact stores no more than at rest, or a thicker layer changes little. */
static enum cs_status find_places(struct cs_system *system, struct leaving *leaving,
                                  struct cs_initial_penetration *penetration,
                                  struct cs_error *error) {
    const size_t n = system->view.n;
    double energy = HUGE_VAL;
    leaving->layer = 1;
    for (int k = 0; k < LAYERS; k++, leaving->layer *= 1.5) {
        const double before = energy;
        *error = (struct cs_error){0};
        penetration->n = 0, penetration->depth = 0;
        memcpy(system->state, leaving->start, 3 * n * sizeof(double));
        for (uint32_t i = 0; i < n && !error->status; i++)
            if (system->inv_mass[i] > 0)
                clear(system, leaving, i, penetration, error);
        if (error->status)
            break;
        if ((system->contact_samples && check_between(system, error)) ||
            check_crossings(system, error))
            continue;
        energy = cs_diagnostics_energy(system, 0, system->state, system->state + 3 * n).other;
        if (!(energy > admitted_energy(system, leaving) && energy < 0.9 * before))
            break;
    }
    return error->status;
}

/* Leads particles that start inside a collider out; counts them. */
static enum cs_status untangle(struct cs_system *system,
                               struct cs_initial_penetration *penetration,
                               struct cs_error *error) {
    const size_t n = system->view.n, bytes = 3 * n * sizeof(double);
    struct leaving leaving = {calloc(6 * n, sizeof(double)), 0, calloc(n, sizeof(uint32_t))};
    double *places = leaving.start ? leaving.start + 3 * n : NULL;
    if (!places || !leaving.colliders) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the ways of %zu particles", n);
    } else {
        memcpy(leaving.start, system->state, bytes);
        const bool any = is_any_inside(system, &leaving);
        if (any && !find_places(system, &leaving, penetration, error)) {
            memcpy(places, system->state, bytes);
            memcpy(system->state, leaving.start, bytes);
            cs_event_lead(system, leaving.colliders, places, system->scene->contact->untangle,
                          CS_TANGLED_LED_OUT, error);
        } else if (!any && !system->scene->events.n && !system->motions && !system->tangled) {
            // there is nothing to tell the method
            system->events = NULL;
            system->plan.rows[CS_FEATURE_EVENTS].built = false;
        }
    }
    free(leaving.start);
    free(leaving.colliders);
    return error->status;
}

/* Refuses what contact.start "allow" lets in, if no method can follow it: contact would throw
 * the bodies apart faster than sound. */
static enum cs_status check_thrown(const struct cs_system *system, struct cs_error *error) {
    const size_t n = system->view.n;
    double mass = 0;
    for (size_t i = 0; i < n; i++)
        mass += system->mass[i];
    const double speed =
        sqrt(2 / mass *
             cs_diagnostics_energy(system, 0, system->state, system->state + 3 * n).other);
    if (speed > SPEED_MAX)
        cs_fail(
            error, CS_ERR_SCENE,
            "%s: contact.start \"allow\": contact throws bodies apart at %.3g m/s, expected at "
            "most %d m/s; move them outside, or set contact.start to \"move-out\"",
            system->scene->path, speed, SPEED_MAX);
    return error->status;
}

enum cs_status cs_initial_penetration_resolve(struct cs_system *system,
                                              struct cs_initial_penetration *penetration,
                                              struct cs_error *error) {
    *penetration = (struct cs_initial_penetration){.seconds = system->scene->contact->untangle};
    if (penetration->seconds > 0 && untangle(system, penetration, error))
        return error->status;
    if (system->scene->contact->start != CS_CONTACT_START_ALLOW)
        return resolve(system, penetration, error);
    return check_crossings(system, error) ? error->status : check_thrown(system, error);
}

void cs_initial_penetration_print(const struct cs_initial_penetration *penetration,
                                  struct cs_text *out) {
    if (penetration->n)
        cs_text_add(out, "%u particle%s started inside colliders, moved out by at most %.3g m",
                    penetration->n, penetration->n == 1 ? "" : "s", penetration->depth);
    if (penetration->n && penetration->seconds > 0)
        cs_text_add(out, " in %.4g s", penetration->seconds);
    else if (penetration->seconds > 0)
        cs_text_add(out,
                    "contact.untangle has nothing to do: nothing starts inside a collider");
    if (penetration->n_moves)
        cs_text_add(out,
                    "%sbodies moved to balance by at most %.3g m: contact energy at the start "
                    "%.3g J, now %.3g J",
                    penetration->n ? "; " : "", penetration->shift, penetration->energy[0],
                    penetration->energy[1]);
}
