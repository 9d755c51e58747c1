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
#include "model/contact/collider_params.h"
#include "model/contact/contact_samples.h"
#include "model/contact/posed_collider.h"

#include <math.h>

/* m, depth up to which a particle counts as on the surface: scenes give positions in decimals
 */
#define TOLERANCE 1e-9
/* passes after which a particle counts as caught between colliders; chosen by trial */
enum { PASSES = 16 };

/* Sets *collider, n and *depth to the collider that p is deepest in; returns false if none. */
static bool find_penetration(const struct cs_system *system, const double p[3],
                             uint32_t *collider, double n[3], double *depth) {
    *depth = TOLERANCE;
    bool found = false;
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        struct cs_posed_collider posed;
        double normal[3];
        cs_posed_collider_at(system, k, 0, &posed);
        const double gap = system->scene->contact.law == CS_CONTACT_PROJECT
                               ? cs_posed_collider_signed_distance(&posed, p, normal)
                               : cs_posed_collider_distance(&posed, p, normal);
        if (!(-gap > *depth))
            continue;
        *depth = -gap;
        *collider = k;
        for (int c = 0; c < 3; c++)
            n[c] = normal[c];
        found = true;
    }
    return found;
}

/* Reports particle i with its depth. */
static enum cs_status refuse_penetration(const struct cs_system *system, uint32_t i,
                                         uint32_t collider, double depth,
                                         struct cs_error *error) {
    struct cs_text text = {0};
    const bool asked = system->scene->contact.start == CS_CONTACT_START_MOVE_OUT;
    cs_system_print_particle(system, i, &text);
    cs_fail(error, CS_ERR_SCENE, "%s: %s starts %.3g m inside colliders[%u]%s",
            system->scene->path, cs_text_get(&text), depth, collider,
            asked ? ", and another collider blocks its way out"
                  : ": move it outside, or set contact.start to \"move-out\"");
    cs_text_finish(&text);
    return error->status;
}

/* m in front of the bare surface of a collider to which a particle is moved: by contact by
 * force where it carries its own weight. */
static double way_beyond(const struct cs_system *system, uint32_t i, uint32_t collider) {
    const double *g = system->scene->forces.gravity;
    const double weight = system->mass[i] * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return system->collider_params
               ? cs_barrier_loaded_distance(system->collider_params[collider].range,
                                            system->collider_params[collider].k, weight)
               : 0;
}

/* Moves particle i out of all colliders, or refuses it. */
static enum cs_status clear(struct cs_system *system, uint32_t i,
                            struct cs_initial_penetration *penetration,
                            struct cs_error *error) {
    const size_t size = system->view.n;
    double *x = system->state;
    double p[3] = {x[i], x[size + i], x[2 * size + i]}, n[3] = {0}, depth, moved = 0;
    uint32_t collider = 0;
    for (int pass = 0; find_penetration(system, p, &collider, n, &depth); pass++) {
        if (pass == PASSES || system->scene->contact.start == CS_CONTACT_START_REFUSE)
            return refuse_penetration(system, i, collider, depth, error);
        // one that is moved by contact by force carries its weight where it comes to lie
        depth += way_beyond(system, i, collider);
        for (int c = 0; c < 3; c++)
            p[c] += depth * n[c];
        moved += depth;
    }
    if (moved == 0)
        return CS_OK;
    for (size_t c = 0; c < 3; c++)
        x[c * size + i] = p[c];
    penetration->n++;
    penetration->depth = fmax(penetration->depth, moved);
    return CS_OK;
}

/* Refuses samples of an edge or triangle that are inside the collider of their chunk. */
static enum cs_status check_between_particles(const struct cs_system *system,
                                              const struct cs_contact_sample_chunk *chunk,
                                              uint32_t item, struct cs_error *error) {
    struct cs_posed_collider collider;
    struct cs_contact_sample_point point;
    cs_posed_collider_at(system, chunk->collider, 0, &collider);
    for (cs_contact_sample_first(chunk, item, &point); cs_contact_sample_next(&point);) {
        double p[3], n[3];
        cs_contact_sample_interpolate(&point, system->view.n, system->state, p);
        const double depth = -cs_posed_collider_distance(&collider, p, n);
        if (!(depth > TOLERANCE) || cs_contact_sample_mass(system, &point) == HUGE_VAL)
            continue;
        struct cs_text first = {0}, second = {0};
        cs_system_print_particle(system, point.particles[0], &first);
        cs_system_print_particle(system, point.particles[1], &second);
        cs_fail(error, CS_ERR_SCENE,
                "%s: between %s and %s the surface starts %.3g m inside colliders[%u]: move it "
                "outside",
                system->scene->path, cs_text_get(&first), cs_text_get(&second), depth,
                chunk->collider);
        cs_text_finish(&first);
        cs_text_finish(&second);
        return error->status;
    }
    return CS_OK;
}

/* Checks the samples of all chunks. */
static enum cs_status check_between(const struct cs_system *system, struct cs_error *error) {
    for (uint32_t l = 0; l < system->contact_samples->n_chunks; l++) {
        const struct cs_contact_sample_chunk *chunk = system->contact_samples->chunks + l;
        for (uint32_t i = chunk->begin; i < chunk->end; i++)
            if (check_between_particles(system, chunk, i, error))
                return error->status;
    }
    return CS_OK;
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
                "%s: at the start %s: separate the bodies, or set crossings to \"ignore\"",
                system->scene->path, cs_text_get(&text));
    }
    cs_text_finish(&text);
    return error->status;
}

/* Particles first, then samples, whose vertices may have been moved, then crossings. */
static enum cs_status check_inside(struct cs_system *system,
                                   struct cs_initial_penetration *penetration,
                                   struct cs_error *error) {
    for (uint32_t i = 0; i < system->view.n && system->scene->colliders.n && !error->status;
         i++)
        if (system->inv_mass[i] > 0)
            clear(system, i, penetration, error);
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
    if (system->scene->contact.law == CS_CONTACT_FORCE &&
        cs_initial_layer_resolve(system, penetration, error))
        return error->status;
    return penetration->n_moves ? check_inside(system, penetration, error) : CS_OK;
}

enum cs_status cs_initial_penetration_resolve(struct cs_system *system,
                                              struct cs_initial_penetration *penetration,
                                              struct cs_error *error) {
    *penetration = (struct cs_initial_penetration){0};
    return system->scene->contact.start == CS_CONTACT_START_ALLOW
               ? check_crossings(system, error)
               : resolve(system, penetration, error);
}

void cs_initial_penetration_print(const struct cs_initial_penetration *penetration,
                                  struct cs_text *out) {
    if (penetration->n)
        cs_text_add(out, "%u particle%s started inside colliders, moved out by at most %.3g m",
                    penetration->n, penetration->n == 1 ? "" : "s", penetration->depth);
    if (penetration->n_moves)
        cs_text_add(out,
                    "%sbodies moved to balance by at most %.3g m: contact energy at the start "
                    "%.3g J, now %.3g J",
                    penetration->n ? "; " : "", penetration->shift, penetration->energy[0],
                    penetration->energy[1]);
}
