/* Pressure in closed meshes: f = p dV/dx with the enclosed volume V. At a vertex dV/dx = N/6
 * with the sum N of the products (b - a) x (c - a) of its triangles, so that forces and moments
 * of a closed mesh add up to 0.
 *
 * As from a pump, p does not depend on V: it has no energy, but does work, and df/dx is not in
 * the solver's matrix.
 *
 * Gas that is shut in, at one temperature, has p = P V0/V - Q with P = Q + pressure, the
 * pressure Q outside and the volume V0 at the start (Boyle). With r = V/V0 its energy, over its
 * least value and with that of the air outside, is
 *
 *   U = V0 (Q r - P - P ln(Q r/P)),   with Q = 0   U = V0 P ln(ROOM/r)
 *
 * and df = p d2V dx - (P V0/V^2) (dV/dx . dx) dV/dx. Both are in the matrix, the first, which
 * is indefinite, unless that is clamped. V has no block of a vertex with itself. Below V0
 * CRUSHED p is that at V0 CRUSHED. */
#include "base/portable_sine.h"
#include "base/vec3.h"
#include "model/force/term.h"
#include "model/force/terms.h"
#include "scene/body_keys.h"
#include "scene/event_key.h"

#include <math.h>
#include <string.h>

/* V/V0 up to which U is at least 0 in a vacuum. */
#define ROOM 1000.0
/* V/V0 below which a body is crushed. */
#define CRUSHED 1e-3
/* Area over that at rest beyond which a balloon may be called a blow-up. */
#define GROWTH_MAX 100

/* Adds factor times N/6, or its change along at->dx, at the particles of the block. */
static void add_slope(const struct cs_system *system, const struct cs_eval *at,
                      const struct cs_body_range *body, double factor, double *f) {
    const uint32_t begin = at->block->begin > body->first ? at->block->begin : body->first;
    for (uint32_t i = begin; i < at->block->end && i < body->first + body->count; i++) {
        double product[3];
        cs_normal_product(system, body, i, at, product);
        for (size_t c = 0; c < 3; c++) {
            f[c * system->view.n + i] += factor / 6 * product[c];
            if (at->power && !at->dx)
                at->power[i] += factor / 6 * product[c] * at->v[c * system->view.n + i];
        }
    }
}

/* --- a pump --- */

static double pressure_of(const struct cs_scene *scene, uint32_t b) {
    const struct cs_body *body = cs_scene_bodies(scene) + b;
    return isnan(body->outer_pressure) ? body->pressure : 0;
}

static struct cs_plan_row pump_plan(const struct cs_scene *scene) {
    bool acts = cs_event_key_changes(scene, ".pressure");
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        acts |= pressure_of(scene, b) != 0;
    return (struct cs_plan_row){.built = acts,
                                .reason = acts ? "a body has an inner pressure" : NULL};
}

static uint32_t pump_uses(const struct cs_scene *scene) {
    (void)scene;
    return CS_USE_AREA;
}

static void add_pump(const struct cs_system *system, const struct cs_eval *at, double *f) {
    for (uint32_t b = 0; b < system->scene->bodies.n; b++)
        if (pressure_of(system->scene, b) != 0)
            add_slope(system, at, system->bodies + b, pressure_of(system->scene, b), f);
}

static void pump_jvp(const struct cs_system *system, const struct cs_eval *at, double *df) {
    if (at->dx)
        add_pump(system, at, df);
}

static double max_pump(const struct cs_system *system, size_t i) {
    uint32_t b = 0;
    while (i >= (size_t)system->bodies[b].first + system->bodies[b].count)
        b++;
    return GROWTH_MAX * pressure_of(system->scene, b) * system->area[i];
}

static const char *const pressure_ramps[] = {"bodies.pressure", NULL};

const struct cs_term cs_term_pressure = {
    .name = "pressure",
    .part_bits = CS_PART_WIND,
    .plan = pump_plan,
    .uses = pump_uses,
    .rampable_keys = pressure_ramps,
    .work_column = "wind",
    .add_force = add_pump,
    .add_jvp = pump_jvp,
    .max_acceleration = max_pump,
};

/* --- gas --- */

/* Gas in a body, at the state that was looked at last. */
struct enclosed {
    const struct cs_body_range *body;
    const struct cs_body *keys;
    double start, r;        /* m3, V0; V/V0 */
    double p, slope;        /* Pa, over Q; Pa/m3, dp/dV */
    double change, lengths; /* m3, of V along a direction; m2, sum of all |g| */
};

/* One state: of the last evaluation, or of the matrix. The system's arena owns the arrays. */
struct cs_gas {
    uint32_t n;
    struct enclosed *list;
    double *g, *x; /* (3,n) dV/dx in m2; positions in m, of the matrix alone */
    bool is_kept, is_clamped;
};
enum { NOW, KEPT };

static struct cs_plan_row gas_plan(const struct cs_scene *scene) {
    bool acts = false;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        acts |= !isnan(cs_scene_bodies(scene)[b].outer_pressure);
    return (struct cs_plan_row){.built = acts, .reason = acts ? "gas is shut in" : NULL};
}

/* Looks at the gas at x: its pressures and their slopes. Returns it. */
static struct cs_gas *look(const struct cs_system *system, int which, const double *x) {
    const size_t n = system->view.n;
    struct cs_gas *gas = system->gas + which;
    const struct cs_block all = {.end = system->view.n};
    const struct cs_eval at = {.x = x, .block = &all};
    memset(gas->g, 0, 3 * n * sizeof *x);
    for (struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        add_slope(system, &at, in->body, 1, gas->g);
        // V = sum g.x/3, from the first vertex on, which keeps digits far from the origin
        double volume = 0;
        for (size_t i = in->body->first; i < (size_t)in->body->first + in->body->count; i++)
            for (size_t c = 0; c < 3 * n; c += n)
                volume += gas->g[c + i] * (x[c + i] - x[c + in->body->first]) / 3;
        in->start = in->start > 0 ? in->start : volume;
        in->keys = cs_scene_bodies(system->scene) + (in->body - system->bodies);
        in->r = volume / in->start;
        const double inside =
            (in->keys->outer_pressure + in->keys->pressure) / fmax(in->r, CRUSHED);
        in->p = inside - in->keys->outer_pressure;
        in->slope = in->r > CRUSHED ? -inside / volume : 0;
    }
    return gas;
}

static enum cs_status gas_build(struct cs_system *system, struct cs_error *error) {
    struct cs_arena *arena = &system->arena;
    // one for evaluations, one for the matrix
    system->gas = cs_arena_alloc_array(arena, 2, sizeof *system->gas, error);
    for (int k = NOW; k <= KEPT && !error->status; k++) {
        struct cs_gas *gas = system->gas + k;
        CS_ARENA_ARRAY(arena, gas->list, system->scene->bodies.n, error);
        CS_ARENA_ARRAY(arena, gas->g, 3 * (size_t)system->view.n, error);
        CS_ARENA_ARRAY(arena, gas->x, k == KEPT ? 3 * (size_t)system->view.n : 0, error);
        for (uint32_t b = 0; b < system->scene->bodies.n && !error->status; b++)
            if (!isnan(cs_scene_bodies(system->scene)[b].outer_pressure))
                gas->list[gas->n++].body = system->bodies + b;
        if (!error->status)
            look(system, k, system->start);
    }
    return error->status;
}

static double length_at(const double *g, size_t n, size_t i) {
    return sqrt(g[i] * g[i] + g[n + i] * g[n + i] + g[2 * n + i] * g[2 * n + i]);
}

static double sum_lengths(const struct cs_gas *gas, const struct enclosed *in, size_t n) {
    double sum = 0;
    for (size_t i = in->body->first; i < (size_t)in->body->first + in->body->count; i++)
        sum += length_at(gas->g, n, i);
    return sum;
}

/* m3, change of V along d (3,n) */
static double change_along(const struct cs_gas *gas, const struct enclosed *in, size_t n,
                           const double *d) {
    double sum = 0;
    for (size_t i = in->body->first; i < (size_t)in->body->first + in->body->count; i++)
        for (size_t c = 0; c < 3 * n; c += n)
            sum += gas->g[c + i] * d[c + i];
    return sum;
}

static void gas_prepare(const struct cs_system *system, const struct cs_eval *at) {
    const struct cs_gas *gas = look(system, NOW, at->x);
    for (uint32_t k = 0; k < gas->n && at->dx; k++)
        gas->list[k].change = change_along(gas, gas->list + k, system->view.n, at->dx);
}

static void add_gas(const struct cs_system *system, const struct cs_eval *at, double *f) {
    const struct cs_gas *gas = system->gas + NOW;
    const struct cs_eval still = {.x = at->x, .block = at->block};
    for (const struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        if (at->dx || !at->dv)
            add_slope(system, at->dx ? at : &still, in->body, in->p, f);
        if (at->dx)
            add_slope(system, &still, in->body, in->slope * in->change, f);
    }
}

static double gas_energy(const struct cs_system *system, const struct cs_eval *at) {
    struct cs_gas *gas = look(system, NOW, at->x);
    double sum = 0;
    for (struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        const double r = in->r, most = fmax(r, CRUSHED);
        const double outside = in->keys->outer_pressure, inside = outside + in->keys->pressure;
        // the force below CRUSHED is constant
        const double log_r = cs_natural_log(most) + (r - most) / most;
        if (outside > 0)
            sum += in->start *
                   (outside * r - inside - inside * (log_r + cs_natural_log(outside / inside)));
        else
            sum += in->start * inside * (cs_natural_log(ROOM) - log_r);
    }
    return sum;
}

static void gas_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                               bool kept) {
    struct cs_gas *gas = look(system, KEPT, matrix->x);
    memcpy(gas->x, matrix->x, 3 * (size_t)system->view.n * sizeof *gas->x);
    gas->is_kept = kept;
    gas->is_clamped = matrix->psd;
    for (struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        in->p *= matrix->ck;
        in->slope *= matrix->ck;
        in->lengths = sum_lengths(gas, in, system->view.n);
    }
}

/* ck dp/dV g g' of each vertex; alone and as an upper bound of all entries (sum |g|)/|g| times
 * that, because |sum g.p|^2 <= sum |g| sum (g.p)^2/|g|. */
static void gas_blocks(const struct cs_system *system, const struct cs_matrix *matrix,
                       size_t begin, size_t end, double *blocks) {
    const struct cs_gas *gas = system->gas + KEPT;
    const size_t n = system->view.n;
    for (const struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        const size_t first = in->body->first, last = first + in->body->count;
        for (size_t i = begin > first ? begin : first; i < end && i < last; i++) {
            const double length = length_at(gas->g, n, i), *g = gas->g + i;
            const bool whole = matrix->bound && !gas->is_kept && length > 0;
            for (size_t m = 0; m < 6; m++)
                blocks[m * n + i] += in->slope * (whole ? in->lengths / length : 1) *
                                     g[cs_sym3_row[m] * n] * g[cs_sym3_column[m] * n];
        }
    }
}

/* y += ck df/dx p; apart: without the diagonal blocks. */
static void add_products(const struct cs_system *system, const double *p, bool apart,
                         double *y) {
    const struct cs_gas *gas = system->gas + KEPT;
    const double *g = gas->g;
    const size_t n = system->view.n;
    const struct cs_block all = {.end = system->view.n};
    const struct cs_eval along = {.x = gas->x, .dx = p, .block = &all};
    for (const struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        if (!gas->is_clamped)
            add_slope(system, &along, in->body, in->p, y);
        // the product of rank one
        const double change = change_along(gas, in, n, p);
        for (size_t i = in->body->first; i < (size_t)in->body->first + in->body->count; i++) {
            const double own = g[i] * p[i] + g[n + i] * p[n + i] + g[2 * n + i] * p[2 * n + i];
            for (size_t k = i; k < 3 * n; k += n)
                y[k] += in->slope * g[k] * (change - (apart ? own : 0));
        }
    }
}

static void gas_product(const struct cs_system *system, const double *p, double *y) {
    add_products(system, p, true, y);
}

static void gas_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                         double *y) {
    add_products(system, matrix->v, false, y);
}

/* |dp/dV| |g| times all |g|. What p d2V adds is left out, as that of a pump is: it is small
 * beside the stiffness of a skin that bears p. */
static void gas_bound(const struct cs_system *system, const struct cs_eval *at,
                      const struct cs_gershgorin *sums) {
    const struct cs_gas *gas = look(system, NOW, at->x);
    const size_t n = system->view.n;
    for (const struct enclosed *in = gas->list; in < gas->list + gas->n; in++) {
        const double rate = in->slope * sum_lengths(gas, in, n);
        for (size_t i = in->body->first; i < (size_t)in->body->first + in->body->count; i++)
            sums->stiffness[i] -= rate * length_at(gas->g, n, i);
    }
}

const struct cs_term cs_term_gas = {
    .name = "gas",
    .part_bits = CS_PART_POTENTIAL,
    .plan = gas_plan,
    .build = gas_build,
    .rampable_keys = pressure_ramps,
    .prepare = gas_prepare,
    .add_force = add_gas,
    .add_jvp = add_gas,
    .energy = gas_energy,
    .energy_kind = CS_ENERGY_ELASTIC,
    .energy_column = "other",
    .prepare_matrix = gas_prepare_matrix,
    .add_blocks = gas_blocks,
    .add_matrix_product = gas_product,
    .add_approach = gas_approach,
    .add_state_bound = gas_bound,
};
