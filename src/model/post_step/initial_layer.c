/* initial_layer.c - refuses bodies that start within the range of contact with more energy than
 * a rest can have, or moves them to balance.
 *
 * Contact stores energy from the range on, so a body that starts there is thrown off: at the
 * distance d by up to sqrt(2 psi(d)/m). At rest under a load F a contact stores about F D/4,
 * and the load between two surfaces is at most the weight of everything, M g. Their energy is
 * therefore admitted up to
 *
 *   W = M g D,   without gravity   W = 1e-3 k D^2 per particle in contact
 *
 * with D the range of the two. The measure is taken for each two surfaces by themselves,
 * because a stack of bodies has a balance at each of its interfaces.
 *
 * A range that nobody set shrinks first, until its two surfaces start out of it: bodies may
 * start closer than their coarse grid would have it.
 *
 * contact.start "move-out" moves one of both bodies as a whole along the mean of its contact
 * forces, until the energy is at most W and their sum carries at most the body's weight. */
#include "model/contact/collider_params.h"
#include "model/contact/contact_samples.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/post_step/contact_projection.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Energy per particle without gravity, in k D^2. */
#define WEIGHTLESS 1e-3
/* Largest way out in units of D: a body that is still in range then is caught. */
#define WAY_MAX 8.0
/* Halvings of an interval of WAY_MAX D: to 1e-8 D. */
enum { HALVINGS = 30 };
/* Moves per body; each may bring the body into the range of another one. Chosen by trial. */
enum { MOVES = 16 };

/* Two surfaces and their contact at a state: bodies, or a body and a collider. Surfaces are
 * numbered as in body_pairs.h, and colliders that are no meshes in the same way. */
struct interface {
    uint32_t a, b;   /* a is a body, b a later one or a collider */
    double range, k; /* m, N/m */
    double energy;   /* J */
    double force[3]; /* N, sum of the elastic forces on a */
    uint32_t touching;
};

/* One call; the caller owns the arrays. */
struct search {
    struct cs_system *system;
    double *f; /* (3,n) scratch */
    double *k; /* (n_bodies, n_bodies) scratch: the stiffness of each pair */
    double gravity, mass;
};

/* Adds one contact of a point with a collider. */
static void add_contact(struct interface *at, const struct cs_point_contact *contact) {
    const double force = cs_barrier_at(contact->d, contact->range, contact->k).force;
    at->energy += cs_barrier_energy(contact->d, contact->range, contact->k);
    at->touching++;
    for (int c = 0; c < 3; c++)
        at->force[c] += force * contact->g[c];
}

/* Two surfaces, one of them a collider. */
struct layer {
    const struct cs_system *system;
    struct cs_posed_collider_law law;
    struct interface *at;
};

/* Adds a point of the body that is free and in range of the collider. */
static void add_point(void *arg, const struct cs_contact_sample_point *point) {
    const struct layer *layer = arg;
    const struct cs_body_range *body = layer->system->bodies + layer->at->a;
    const double rest[3] = {0};
    struct cs_point_contact contact;
    double p[3];
    cs_contact_sample_interpolate(point, layer->system->view.n, layer->system->state, p);
    if (point->particles[0] - body->first < body->count &&
        cs_contact_sample_mass(layer->system, point) < HUGE_VAL &&
        cs_posed_collider_law_in_range(&layer->law, p, rest, &contact))
        add_contact(layer->at, &contact);
}

/* Contact of body a with a collider that is no mesh. */
static void measure_collider(const struct search *search, struct interface *at) {
    const uint32_t collider = at->b - search->system->scene->bodies.n;
    struct layer layer = {.system = search->system, .at = at};
    cs_posed_collider_law_at(search->system, collider, 0, &layer.law);
    at->range = layer.law.params.range;
    at->k = layer.law.params.k;
    cs_contact_points_visit(search->system, collider, add_point, &layer);
}

/* Contact in pairs: the energy and the forces with the stiffness of all other pairs at 0. */
static void measure_pairs(const struct search *search, struct interface *at) {
    struct cs_system *system = search->system;
    struct cs_body_pair_table *table = &system->pairs->body_pairs;
    const size_t n = system->view.n, n_bodies = table->n_bodies;
    const struct cs_block all = {.end = system->view.n};
    const struct cs_eval eval = {.x = system->state, .parts = CS_PART_POTENTIAL, .block = &all};
    for (size_t k = 0; k < n_bodies * n_bodies; k++) {
        search->k[k] = table->params[k].k;
        if (k != at->a * n_bodies + at->b && k != at->b * n_bodies + at->a)
            table->params[k].k = 0;
    }
    // the pair itself still has its own; contacts that were found with others are void
    table->params_version++;
    at->range = cs_body_pair_params_of(table, at->a, at->b)->range;
    at->k = cs_body_pair_params_of(table, at->a, at->b)->k;
    at->energy = cs_term_pairs.energy(system, &eval);
    memset(search->f, 0, 3 * n * sizeof *search->f);
    cs_term_pairs.prepare(system, &eval);
    cs_term_pairs.add_force(system, &eval, search->f);
    for (size_t k = 0; k < n_bodies * n_bodies; k++)
        table->params[k].k = search->k[k];
    table->params_version++;
    const struct cs_body_range *body = system->bodies + at->a;
    for (size_t i = body->first; i < (size_t)body->first + body->count; i++) {
        const double *f = search->f + i;
        at->touching += f[0] != 0 || f[n] != 0 || f[2 * n] != 0;
        for (size_t c = 0; c < 3; c++)
            at->force[c] += f[c * n];
    }
}

/* Sets all but a and b. */
static void measure_layer(const struct search *search, struct interface *at) {
    const struct cs_collider *collider = cs_scene_collider_at(search->system->scene, at->b);
    *at = (struct interface){.a = at->a, .b = at->b};
    if (collider && !collider->mesh)
        measure_collider(search, at);
    else
        measure_pairs(search, at);
}

/* J, the most that two surfaces may store at rest. */
static double admitted(const struct search *search, const struct interface *at) {
    return search->gravity > 0 ? search->mass * search->gravity * at->range
                               : WEIGHTLESS * at->k * at->range * at->range * at->touching;
}

/* Finds the first two surfaces from (a, b) on that store too much; returns false if none. */
static bool find_interface(const struct search *search, struct interface *at) {
    const struct cs_scene *scene = search->system->scene;
    // mostly none stores anything, and then none is measured by itself
    const bool pairs = search->system->pairs &&
                       cs_term_pairs.energy(search->system,
                                            &(struct cs_eval){.x = search->system->state}) != 0;
    double friction;
    for (uint32_t a = 0; a < scene->bodies.n; a++)
        for (uint32_t b = a + 1; b < scene->bodies.n + scene->colliders.n; b++) {
            const struct cs_collider *collider = cs_scene_collider_at(scene, b);
            if (collider && !collider->mesh
                    ? !search->system->collider_params
                    : !pairs || !cs_scene_bodies_collide(scene, a, b, &friction))
                continue;
            *at = (struct interface){.a = a, .b = b};
            measure_layer(search, at);
            if (at->energy > admitted(search, at))
                return true;
        }
    return false;
}

/* --- the way out --- */

/* A way of a whole body. */
struct way {
    uint32_t body;
    double along[3], length; /* unit vector; m */
};

static bool has_pins(const struct cs_system *system, uint32_t body) {
    bool pinned = false;
    for (uint32_t i = 0; i < system->bodies[body].count; i++)
        pinned = pinned || system->inv_mass[system->bodies[body].first + i] == 0;
    return pinned;
}

/* Moves a body by `length` along its way. */
static void move(struct cs_system *system, const struct way *way, double length) {
    const struct cs_body_range *body = system->bodies + way->body;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = body->first; i < (size_t)body->first + body->count; i++)
            system->state[c * system->view.n + i] += length * way->along[c];
}

/* N, weight of a body. */
static double weight_of(const struct search *search, uint32_t body) {
    const struct cs_body_range *range = search->system->bodies + body;
    double mass = 0;
    for (uint32_t i = 0; i < range->count; i++)
        mass += search->system->mass[range->first + i];
    return mass * search->gravity;
}

/* Returns whether the surfaces are at balance when the body has gone so far. */
static bool is_balanced(const struct search *search, const struct way *way, double length,
                        const struct interface *from) {
    struct cs_system *system = search->system;
    const size_t bytes = 3 * system->view.n * sizeof *system->state;
    struct interface at = *from;
    double *kept = search->f + 3 * (size_t)system->view.n;
    memcpy(kept, system->state, bytes);
    move(system, way, length);
    measure_layer(search, &at);
    memcpy(system->state, kept, bytes);
    double load = 0;
    for (int c = 0; c < 3; c++)
        load += (way->body == at.a ? 1 : -1) * at.force[c] * way->along[c];
    return at.energy <= admitted(search, &at) &&
           (search->gravity == 0 || load <= weight_of(search, way->body));
}

/* Chooses the body that moves: the one that is pushed up, else the later one; never one with
 * pinned particles. Returns false if both are held, or the forces have no direction. */
static bool choose(const struct search *search, const struct interface *at, struct way *way) {
    const struct cs_system *system = search->system;
    const double *g = system->scene->forces->gravity, *f = at->force;
    const double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    const bool single = at->b >= system->scene->bodies.n;
    const bool held[2] = {has_pins(system, at->a), single || has_pins(system, at->b)};
    if ((held[0] && held[1]) || !(length > 0))
        return false;
    // above 0: pushed against gravity
    const double up = -(f[0] * g[0] + f[1] * g[1] + f[2] * g[2]);
    const bool second = held[0] || (!held[1] && up <= 0);
    way->body = second ? at->b : at->a;
    for (int c = 0; c < 3; c++)
        way->along[c] = fabs(f[c]) > 1e-9 * length ? (second ? -1 : 1) * f[c] / length : 0;
    return true;
}

/* Sets the shortest way to balance, by doubling and halving. Returns false if there is none. */
static bool find_way(const struct search *search, const struct interface *at, struct way *way) {
    double low = 0, high = at->range / 64;
    if (!choose(search, at, way))
        return false;
    while (!is_balanced(search, way, high, at)) {
        low = high;
        high *= 2;
        if (high > WAY_MAX * at->range)
            return false;
    }
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = 0.5 * (low + high);
        if (is_balanced(search, way, middle, at))
            high = middle;
        else
            low = middle;
    }
    way->length = high;
    return true;
}

/* --- a smaller range --- */

/* Returns whether the scene leaves the range of two surfaces open. */
static bool is_open(const struct cs_scene *scene, const struct interface *at) {
    const struct cs_collider *collider = cs_scene_collider_at(scene, at->b);
    const struct cs_body *bodies = cs_scene_bodies(scene);
    return bodies[at->a].thickness == 0 &&
           (collider ? collider->mesh && collider->thickness == 0
                     : bodies[at->b].thickness == 0);
}

/* Returns whether two surfaces store nothing with a range in m, which is set. */
static bool is_free(const struct search *search, struct interface *at, double range) {
    cs_body_pair_table_set_range(search->system, &search->system->pairs->body_pairs, at->a,
                                 at->b, range);
    measure_layer(search, at);
    return at->energy == 0;
}

/* Shrinks the range of two surfaces that the scene leaves open, by halving, to the largest one
 * out of which they start. Returns false, with the range as before, if that is below
 * CS_RANGE_SHRINK_MIN of it. */
static bool shrink(const struct search *search, struct interface *at) {
    const double whole = at->range;
    double low = CS_RANGE_SHRINK_MIN * whole, high = whole;
    if (!is_open(search->system->scene, at))
        return false;
    if (!is_free(search, at, low)) {
        is_free(search, at, whole);
        return false;
    }
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = 0.5 * (low + high);
        if (is_free(search, at, middle))
            low = middle;
        else
            high = middle;
    }
    return is_free(search, at, low);
}

/* --- messages --- */

/* Reports two surfaces, what they store, and the move that would do. */
static enum cs_status refuse_layer(const struct search *search, const struct interface *at,
                                   struct cs_error *error) {
    const struct cs_scene *scene = search->system->scene;
    const bool asked = scene->contact->start == CS_CONTACT_START_MOVE_OUT;
    struct cs_text other = {0}, cure = {0};
    struct way way;
    cs_text_add(&other, at->b < scene->bodies.n ? "bodies[%u]" : "colliders[%u]",
                at->b < scene->bodies.n ? at->b : at->b - scene->bodies.n);
    if (find_way(search, at, &way))
        cs_text_add(&cure, "move bodies[%u] by %.3g m along (%.3g, %.3g, %.3g)%s", way.body,
                    way.length, way.along[0], way.along[1], way.along[2],
                    asked ? "" : ", or set contact.start to \"move-out\"");
    else
        cs_text_add(&cure, "move them apart by the range of contact, %.3g m", at->range);
    cs_fail(error, CS_ERR_SCENE,
            "%s: bodies[%u] starts within the contact range of %s: %.3g J are stored there, "
            "at most %.3g J at rest; %s",
            scene->path, at->a, cs_text_get(&other), at->energy, admitted(search, at),
            cs_text_get(&cure));
    cs_text_finish(&other);
    cs_text_finish(&cure);
    return error->status;
}

/* --- all of it --- */

/* J, all energy of contact. */
static double stored(const struct cs_system *system) {
    return cs_diagnostics_energy(system, 0, system->state,
                                 system->state + 3 * (size_t)system->view.n)
        .other;
}

/* Shrinks ranges, or moves bodies if the scene asks for that, until no two surfaces store too
 * much; or refuses. */
static enum cs_status balance(struct search *search, struct cs_initial_penetration *penetration,
                              struct cs_error *error) {
    const bool asked = search->system->scene->contact->start == CS_CONTACT_START_MOVE_OUT;
    const uint32_t most = MOVES * search->system->scene->bodies.n;
    struct interface at;
    struct way way;
    for (uint32_t k = 0; find_interface(search, &at); k++) {
        if (!asked && shrink(search, &at))
            continue;
        if (!asked || k == most || !find_way(search, &at, &way))
            return refuse_layer(search, &at, error);
        move(search->system, &way, way.length);
        penetration->n_moves++;
        penetration->shift = fmax(penetration->shift, way.length);
    }
    return CS_OK;
}

enum cs_status cs_initial_layer_resolve(struct cs_system *system,
                                        struct cs_initial_penetration *penetration,
                                        struct cs_error *error) {
    const double *g = system->scene->forces->gravity;
    const size_t n = system->view.n, n_bodies = system->pairs ? system->surfaces->n_bodies : 0;
    penetration->energy[0] = penetration->energy[1] = stored(system);
    if (!(penetration->energy[0] > 0))
        return CS_OK;
    if (system->pairs && cs_touching_surfaces_check(system, error))
        return error->status;
    struct search search = {.system = system,
                            .f = calloc(6 * n, sizeof(double)),
                            .k = calloc(n_bodies * n_bodies + 1, sizeof(double)),
                            .gravity = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2])};
    // of all bodies: more cannot rest on one interface
    for (size_t i = 0; i < n; i++)
        search.mass += system->mass[i];
    if (search.f && search.k)
        balance(&search, penetration, error);
    else
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the contact energy of %zu particles",
                n);
    free(search.f);
    free(search.k);
    penetration->energy[1] = stored(system);
    return error->status;
}
