/* Friction of stored contacts: forces, derivatives, blocks and potential, chunk by chunk.
 *
 * The set gathers by particles in the order of chunks, so that no sum depends on threads. Its
 * entries hold the forces, its parts the blocks of the matrix; weights are filled once. */
#include "model/contact/lagged_friction.h"

#include "base/pool.h"
#include "base/vec3.h"
#include "model/force/term.h"
#include "scene/contact_keys.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

/* One pass over all stored contacts. */
struct pass {
    struct cs_lagged_friction *lagged;
    const double *v, *dv;           /* (3,n) m/s; dv: the change of the force is wanted */
    const struct cs_matrix *matrix; /* blocks are wanted; NULL: forces */
};

/* Sliding velocity of a contact: T of the velocities v, and s = sqrt(T.T + ev^2). */
struct sliding {
    double t[3], speed;
};

/* out += sum of w_k v_k over the particles of a contact; points of colliders do not count */
static void interpolate(const struct pass *pass, uint32_t chunk,
                        const struct cs_contact *contact, const double *v, double out[3]) {
    const size_t n = pass->lagged->set.gather.n_particles;
    const uint32_t *points = cs_contact_points(&pass->lagged->set, chunk, contact);
    for (uint32_t k = 0; k < contact->n; k++)
        for (size_t c = 0; c < 3 && points[k] < n; c++)
            out[c] += contact->weights[k] * v[c * n + points[k]];
}

static struct sliding slide(const struct pass *pass, uint32_t chunk,
                            const struct cs_contact *contact) {
    const double ev = pass->lagged->system->scene->contact->friction_speed;
    struct sliding to;
    double v[3];
    memcpy(v, contact->obstacle, sizeof v);
    interpolate(pass, chunk, contact, pass->v, v);
    to.speed = cs_sliding_velocity(contact->normal, 1, v, ev, to.t);
    return to;
}

/* Stores the force of a contact, or its change along dv, and adds its potential. */
static void find_force(const struct pass *pass, uint32_t chunk, struct cs_contact *contact) {
    const struct sliding to = slide(pass, chunk, contact);
    const double rub = contact->load / to.speed;
    const double ev = pass->lagged->system->scene->contact->friction_speed;
    double along[3] = {to.t[0], to.t[1], to.t[2]};
    if (pass->dv) {
        double dv[3] = {0}, dt[3];
        interpolate(pass, chunk, contact, pass->dv, dv);
        cs_sliding_velocity(contact->normal, 1, dv, 0, dt);
        const double share = cs_vec3_dot(to.t, dt) / (to.speed * to.speed);
        for (int c = 0; c < 3; c++)
            along[c] = dt[c] - share * to.t[c];
    }
    // s - ev without cancellation
    pass->lagged->set.chunks[chunk].energy +=
        contact->load * cs_vec3_dot(to.t, to.t) / (to.speed + ev);
    contact->factor = -rub;
    memcpy(contact->vector, along, sizeof along);
}

/* B = -cd mu N / s (I - n n^T - T T^T / s^2), as in point_contact.h. matrix.bound leaves the
 * last part out, and matrix.psd what is subtracted. */
static void find_block(const struct pass *pass, uint32_t chunk, struct cs_contact *contact) {
    const double *n = contact->normal;
    const struct sliding to = slide(pass, chunk, contact);
    const double load = pass->matrix->psd && contact->load < 0 ? 0 : contact->load;
    const double rub = -pass->matrix->cd * load / to.speed;
    const double turn = pass->matrix->bound ? 0 : 1 / (to.speed * to.speed);
    for (int e = 0; e < 6; e++) {
        const int r = cs_sym3_row[e], s = cs_sym3_column[e];
        contact->block[e] = rub * ((r == s) - n[r] * n[s] - turn * to.t[r] * to.t[s]);
    }
}

static void do_chunk(void *arg, uint32_t chunk) {
    const struct pass *pass = arg;
    struct cs_contact_chunk *of = pass->lagged->set.chunks + chunk;
    of->energy = 0;
    for (size_t k = 0; k < of->n; k++)
        if (pass->matrix)
            find_block(pass, chunk, of->contacts + k);
        else
            find_force(pass, chunk, of->contacts + k);
}

static void run(struct pass *pass) {
    struct cs_contact_set *set = &pass->lagged->set;
    if (set->n)
        cs_pool_run(set->gather.n_chunks, do_chunk, pass);
    if (pass->matrix)
        cs_contact_set_write_blocks(set);
    else
        cs_contact_set_write_vectors(set);
}

/* --- storing --- */

void cs_lagged_friction_store(struct cs_lagged_friction *lagged, uint32_t chunk,
                              const struct cs_point_contact *contact, uint32_t n,
                              const uint32_t *particles, const double *weights) {
    const double length = sqrt(cs_vec3_dot(contact->g, contact->g));
    const double load = contact->friction * length *
                        cs_barrier_at(contact->d, contact->range, contact->k).force;
    struct cs_contact *to =
        load == 0 ? NULL : cs_contact_set_append(&lagged->set, chunk, n, particles, weights);
    if (!to)
        return;
    to->load = load;
    for (int c = 0; c < 3; c++) {
        to->normal[c] = contact->g[c] / length;
        to->obstacle[c] = contact->v[c];
    }
}

void cs_lagged_friction_begin(struct cs_lagged_friction *lagged, double t, const double *x) {
    const struct cs_system *system = lagged->system;
    uint32_t first = 0;
    lagged->is_active = false; // contacts give their friction only then
    for (uint32_t k = 0; k < lagged->set.gather.n_chunks; k++)
        cs_contact_set_clear(&lagged->set, k);
    for (uint32_t k = 0; k < system->n_terms; k++)
        if (system->terms[k]->store_friction) {
            system->terms[k]->store_friction(system, t, x, first);
            first += system->terms[k]->friction_chunks(system);
        }
    cs_contact_set_gather(&lagged->set);
    lagged->is_active = true;
}

void cs_lagged_friction_end(struct cs_lagged_friction *lagged) {
    lagged->is_active = false;
}

double cs_lagged_friction_potential(struct cs_lagged_friction *lagged, const double *v,
                                    double *f) {
    const struct cs_system *system = lagged->system;
    const size_t n = system->view.n;
    struct pass pass = {.lagged = lagged, .v = v};
    run(&pass);
    memset(f, 0, 3 * n * sizeof *f);
    cs_contact_set_add(&lagged->set, 0, n, f);
    for (size_t c = 0; c < 3; c++)
        for (uint32_t p = 0; p < system->n_pinned; p++)
            f[c * n + system->pinned[p]] = 0;
    return lagged->set.n ? cs_contact_set_energy(&lagged->set) : 0;
}

/* --- the term --- */

static void prepare(const struct cs_system *system, const struct cs_eval *at) {
    struct pass pass = {.lagged = system->lagged_friction, .v = at->v, .dv = at->dv};
    if (cs_lagged_friction_acts(system))
        run(&pass);
}

static void add_force(const struct cs_system *system, const struct cs_eval *at, double *f) {
    if (cs_lagged_friction_acts(system))
        cs_contact_set_add(&system->lagged_friction->set, at->block->begin, at->block->end, f);
}

/* Stored contacts do not depend on the positions. */
static void add_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    if (at->dv)
        add_force(system, at, df);
}

static void prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                           bool kept) {
    struct cs_lagged_friction *lagged = system->lagged_friction;
    struct pass pass = {.lagged = lagged, .v = matrix->v, .matrix = matrix};
    if (!cs_lagged_friction_acts(system))
        return;
    lagged->set.diagonal_bound = !kept && matrix->bound;
    if (kept)
        lagged->matrix = *matrix;
    lagged->is_overwritten = !kept;
    run(&pass);
}

static void add_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    (void)matrix;
    if (cs_lagged_friction_acts(system))
        cs_contact_set_add_blocks(&system->lagged_friction->set, begin, end, blocks);
}

static void add_product(const struct cs_system *system, const double *p, double *y) {
    if (!cs_lagged_friction_acts(system))
        return;
    if (system->lagged_friction->is_overwritten)
        prepare_matrix(system, &system->lagged_friction->matrix, true);
    cs_contact_set_multiply(&system->lagged_friction->set, p, y);
}

/* A row of w_k w_j B has the norm |w_k| sum |w_j| mu N / s. */
static void add_bound_at(const struct cs_system *system, const struct cs_eval *at,
                         const struct cs_gershgorin *sums) {
    struct pass pass = {.lagged = system->lagged_friction, .v = at->v};
    const struct cs_contact_set *set = &pass.lagged->set;
    for (uint32_t l = 0; l < set->gather.n_chunks && cs_lagged_friction_acts(system); l++)
        for (size_t p = 0; p < set->chunks[l].n && set->n; p++) {
            const struct cs_contact *contact = set->chunks[l].contacts + p;
            const uint32_t *points = cs_contact_points(set, l, contact);
            const double rub = fabs(contact->load) / slide(&pass, l, contact).speed;
            double sum = 0;
            for (uint32_t k = 0; k < contact->n; k++)
                sum += fabs(contact->weights[k]);
            for (uint32_t k = 0; k < contact->n; k++)
                if (points[k] < system->view.n)
                    sums->damping[points[k]] += fabs(contact->weights[k]) * sum * rub;
        }
}

static const struct cs_term term = {
    .name = "lagged friction",
    .part_bits = CS_PART_DISSIPATIVE,
    .prepare = prepare,
    .add_force = add_force,
    .add_jvp = add_jvp,
    .prepare_matrix = prepare_matrix,
    .add_blocks = add_blocks,
    .add_matrix_product = add_product,
    .add_state_bound = add_bound_at,
};

enum cs_status cs_lagged_friction_build(struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error) {
    struct cs_lagged_friction *lagged = cs_arena_alloc(arena, sizeof *lagged, error);
    uint32_t n_chunks = 0;
    for (uint32_t k = 0; k < system->n_terms; k++)
        n_chunks +=
            system->terms[k]->friction_chunks ? system->terms[k]->friction_chunks(system) : 0;
    if (!lagged || cs_contact_set_init(&lagged->set, system->view.n, n_chunks, arena, error))
        return error->status;
    lagged->system = system;
    system->lagged_friction = lagged;
    system->terms[system->n_terms++] = &term;
    return CS_OK;
}
