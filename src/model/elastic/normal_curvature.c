/* Curvatures along normals: first the forces on the points of each stencil, by all threads,
 * then at each particle their sum in one order. */
#include "base/vec3.h"
#include "model/elastic/normal_stencil.h"

#include "base/pool.h"
#include "model/elastic/membranes.h"
#include "scene/elastic_keys.h"

#include <string.h>

/* Stencils per block of a loop. */
enum { PIECE = 128 };

/* Arguments of a loop over all stencils. */
struct job {
    const struct cs_system *system;
    const double *x, *v, *dx, *dv;
    struct cs_normal_factors elastic, damping; /* the latter per second of damping */
    bool is_change;                            /* a derivative, or a product */
};

static const struct cs_elastic *elastic_of(const struct cs_system *system,
                                           const struct cs_bending *bending) {
    return cs_scene_elastic(system->scene, bending->body);
}

/* The factors of one body: only a curved one has its energy here. */
static struct cs_normal_factors factors_of(const struct job *job,
                                           const struct cs_bending *bending) {
    const double elastic = bending->rest ? 1 : 0;
    const double damping = elastic_of(job->system, bending)->bending.damping;
    const struct cs_normal_factors *e = &job->elastic, *d = &job->damping;
    return (struct cs_normal_factors){elastic * e->kappa + damping * d->kappa,
                                      elastic * e->rate + damping * d->rate,
                                      elastic * e->change + damping * d->change,
                                      elastic * e->change_rate + damping * d->change_rate};
}

/* The factors of a matrix cd df/dv + ck df/dx without the position derivative of the damping;
 * with psd without the change of the gradients of kappa. */
static void set_matrix_factors(struct job *job, double ck, double cd, bool psd) {
    job->elastic = (struct cs_normal_factors){.kappa = psd ? 0 : -ck, .change = -ck};
    job->damping = (struct cs_normal_factors){.change = -cd};
}

/* The forces on the points of one stencil, times -1. */
static void find_forces(const struct job *job, const struct cs_bending_stencil *of,
                        struct cs_normal_factors by, double out[CS_NORMAL_FORCES]) {
    const size_t n = job->system->view.n;
    struct cs_normal_state state;
    struct cs_normal_sums dx, dv;
    memset(out, 0, CS_NORMAL_FORCES * sizeof *out);
    if (of->n == 0)
        return;
    cs_normal_stencil_state(of, n, job->x, job->v, &state);
    if (!job->is_change) {
        cs_normal_stencil_force(of, &state, by, out);
        return;
    }
    cs_normal_stencil_sums(of, n, job->dx, &dx);
    cs_normal_stencil_sums(of, n, job->dv, &dv);
    cs_normal_stencil_derivative(of, &state, by, &dx, &dv, out);
}

static uint32_t pieces_of(const struct cs_bending *bending) {
    return bending->forces ? (bending->n + PIECE - 1) / PIECE : 0;
}

static void find_piece(void *arg, uint32_t number) {
    const struct job *job = arg;
    for (uint32_t b = 0, first = 0; b < job->system->bendings->n; b++) {
        const struct cs_bending *bending = job->system->bendings->bodies + b;
        const uint32_t pieces = pieces_of(bending);
        // a piece is of one body
        if (number >= first && number < first + pieces) {
            const struct cs_moduli D = cs_bending_moduli(elastic_of(job->system, bending));
            const struct cs_normal_factors by = factors_of(job, bending);
            for (uint32_t s = (number - first) * PIECE;
                 s < bending->n && s < (number - first + 1) * PIECE; s++) {
                struct cs_bending_stencil stencil;
                cs_bending_stencil_at(bending, &D, s, &stencil);
                find_forces(job, &stencil, by, bending->forces + CS_NORMAL_FORCES * (size_t)s);
            }
        }
        first += pieces;
    }
}

static void find_all(struct job *job) {
    uint32_t pieces = 0;
    for (uint32_t b = 0; b < job->system->bendings->n; b++)
        pieces += pieces_of(job->system->bendings->bodies + b);
    cs_pool_run(pieces, find_piece, job);
}

void cs_normal_curvature_prepare(const struct cs_system *system, const struct cs_eval *at) {
    struct job job = {.system = system,
                      .x = at->x,
                      .v = at->v,
                      .dx = at->dx,
                      .dv = at->dv,
                      .is_change = at->dx || at->dv};
    if (at->parts & CS_PART_ELASTIC)
        job.elastic = (struct cs_normal_factors){.kappa = 1, .change = 1};
    if (at->parts & CS_PART_ELASTIC_DAMPING)
        job.damping = (struct cs_normal_factors){.rate = 1, .change_rate = 1};
    find_all(&job);
}

void cs_normal_curvature_prepare_product(const struct cs_system *system, const double *p,
                                         bool elastic) {
    const struct cs_normal_matrix *kept = &system->bendings->normal;
    struct job job = {.system = system, .x = kept->x, .dx = p, .is_change = true};
    set_matrix_factors(&job, kept->ck, elastic ? 0 : kept->cd, kept->psd);
    find_all(&job);
}

void cs_normal_curvature_add(const struct cs_system *system, const struct cs_block *block,
                             double factor, double *y) {
    const size_t n = system->view.n;
    for (uint32_t b = 0; b < system->bendings->n; b++) {
        const struct cs_bending *bending = system->bendings->bodies + b;
        for (uint32_t i = 0; bending->forces && i < bending->count; i++) {
            const size_t at = bending->first + i;
            if (at < block->begin || at >= block->end)
                continue;
            // ascending by stencil: one order whatever the threads
            double sum[3] = {0, 0, 0};
            for (uint32_t k = bending->incident_begin[i]; k < bending->incident_begin[i + 1];
                 k++)
                for (size_t c = 0; c < 3; c++)
                    sum[c] +=
                        bending->forces[CS_NORMAL_FORCES * (size_t)(bending->incident[k] / 8) +
                                        3 * (size_t)(bending->incident[k] % 8) + c];
            for (size_t c = 0; c < 3; c++)
                y[c * n + at] += factor * sum[c];
        }
    }
}

/* Energy in J of the bodies that are curved at rest. */
static double curvature_energy(const struct cs_system *system, const double *x) {
    double sum = 0;
    for (uint32_t b = 0; b < system->bendings->n; b++) {
        const struct cs_bending *bending = system->bendings->bodies + b;
        const struct cs_moduli D = cs_bending_moduli(elastic_of(system, bending));
        for (uint32_t s = 0; bending->rest && s < bending->n; s++) {
            struct cs_bending_stencil of;
            struct cs_normal_state state;
            double M[3];
            cs_bending_stencil_at(bending, &D, s, &of);
            cs_normal_stencil_state(&of, system->view.n, x, NULL, &state);
            cs_normal_stencil_moments(&of, &state, (struct cs_normal_factors){.kappa = 1}, M);
            for (int a = 0; a < 3; a++)
                sum += 0.5 * M[a] * (state.kappa[a] - of.rest[a]);
        }
    }
    return sum;
}

/* --- entries: bounds and diagonal blocks --- */

/* The matrix of a stencil, column by column: a product for each number of its points. */
static void find_entries(const struct job *job, const struct cs_bending_stencil *of,
                         struct cs_normal_factors by,
                         double K[CS_NORMAL_FORCES][CS_NORMAL_FORCES]) {
    struct cs_normal_state state;
    memset(K, 0, CS_NORMAL_FORCES * sizeof *K);
    if (of->n == 0)
        return;
    cs_normal_stencil_state(of, job->system->view.n, job->x, NULL, &state);
    for (size_t column = 0; column < 3 * (size_t)of->n; column++) {
        const size_t j = column / 3, c = column % 3;
        // a unit displacement of one number
        struct cs_normal_sums dx = {0};
        for (size_t a = 0; a < 3; a++)
            dx.k[a][c] = of->weights[a][j];
        for (size_t k = 0; k < 2; k++)
            dx.d[k][c] = (of->ends[2 * k + 1] == j) - (of->ends[2 * k] == j);
        cs_normal_stencil_derivative(of, &state, by, &dx, &(struct cs_normal_sums){0},
                                     K[column]);
    }
}

/* Norm of the 3x3 block of points i and j. */
static double block_norm(double K[CS_NORMAL_FORCES][CS_NORMAL_FORCES], size_t i, size_t j) {
    double squares = 0;
    for (size_t c = 0; c < 3; c++)
        for (size_t d = 0; d < 3; d++)
            squares += K[3 * i + c][3 * j + d] * K[3 * i + c][3 * j + d];
    return sqrt(squares);
}

/* Walks the stencils of the bodies that have forces by normals. */
struct walk {
    const struct cs_bending *bending;
    struct cs_bending_stencil stencil;
    struct cs_moduli D;
    uint32_t body, s;
};

static bool next_stencil(const struct cs_system *system, struct walk *walk) {
    const struct cs_bendings *bendings = system->bendings;
    while (walk->body < bendings->n && (!bendings->bodies[walk->body].forces ||
                                        walk->s == bendings->bodies[walk->body].n)) {
        walk->body++;
        walk->s = 0;
    }
    if (walk->body == bendings->n)
        return false;
    walk->bending = bendings->bodies + walk->body;
    walk->D = cs_bending_moduli(elastic_of(system, walk->bending));
    cs_bending_stencil_at(walk->bending, &walk->D, walk->s++, &walk->stencil);
    return true;
}

/* Adds row sums at a state. */
static void add_curvature_bound(const struct cs_system *system, const double *x,
                                double *stiffness, double *damping) {
    struct walk walk = {0};
    while (next_stencil(system, &walk))
        for (int damped = 0; damped < 2; damped++) {
            struct job job = {.system = system, .x = x};
            double K[CS_NORMAL_FORCES][CS_NORMAL_FORCES], *sums = damped ? damping : stiffness;
            set_matrix_factors(&job, damped ? 0 : -1, damped ? -1 : 0, false);
            find_entries(&job, &walk.stencil, factors_of(&job, walk.bending), K);
            for (uint32_t i = 0; i < walk.stencil.n; i++)
                for (uint32_t j = 0; j < walk.stencil.n; j++)
                    sums[walk.stencil.at[i]] += block_norm(K, i, j);
        }
}

/* Adds the block of a particle with itself; a particle may stand at two points. */
static void add_own_blocks(const struct cs_bending_stencil *of,
                           double K[CS_NORMAL_FORCES][CS_NORMAL_FORCES], double factor,
                           size_t n, double *blocks) {
    for (size_t i = 0; i < of->n; i++)
        for (size_t j = 0; j < of->n; j++)
            for (size_t c = 0; of->at[i] == of->at[j] && c < 6; c++)
                blocks[c * n + of->at[i]] +=
                    factor * K[3 * i + cs_sym3_row[c]][3 * j + cs_sym3_column[c]];
}

void cs_normal_curvature_prepare_matrix(const struct cs_system *system,
                                        const struct cs_matrix *matrix, bool kept) {
    struct cs_normal_matrix *own = &system->bendings->normal;
    const size_t n = system->view.n;
    struct job job = {.system = system, .x = matrix->x};
    struct walk walk = {0};
    set_matrix_factors(&job, matrix->ck, matrix->cd, matrix->psd);
    memset(own->blocks, 0, 6 * n * sizeof *own->blocks);
    while (next_stencil(system, &walk)) {
        double K[CS_NORMAL_FORCES][CS_NORMAL_FORCES];
        find_entries(&job, &walk.stencil, factors_of(&job, walk.bending), K);
        add_own_blocks(&walk.stencil, K, matrix->bound && !kept ? CS_BENDING_POINTS : 1, n,
                       own->blocks);
    }
    if (!kept)
        return;
    memcpy(own->kept, own->blocks, 6 * n * sizeof *own->kept);
    memcpy(own->x, matrix->x, 3 * n * sizeof *own->x);
    own->ck = matrix->ck;
    own->cd = matrix->cd;
    own->psd = matrix->psd;
}

enum cs_status cs_normal_curvature_build(struct cs_system *system, struct cs_error *error) {
    struct cs_bendings *bendings = system->bendings;
    const size_t n = system->view.n;
    bool any = false;
    for (uint32_t b = 0; b < bendings->n && !error->status; b++) {
        struct cs_bending *bending = bendings->bodies + b;
        if (!bending->rest && !bending->damped)
            continue;
        // flat bodies without damping need nothing
        any = true;
        bending->forces = cs_arena_alloc_array(&system->arena, bending->n,
                                               CS_NORMAL_FORCES * sizeof(double), error);
    }
    if (!any)
        return error->status;
    bendings->normal.x = cs_arena_alloc_array(&system->arena, 3 * n, sizeof(double), error);
    CS_ARENA_ARRAY(&system->arena, bendings->normal.blocks, 6 * n, error);
    bendings->normal.kept = cs_arena_alloc_array(&system->arena, 6 * n, sizeof(double), error);
    return error->status;
}

/* Sums over the stencils of bending: their energy, and the rows of their matrix. */

static double stencil_energy(const struct cs_bending_stencil *stencil, size_t n,
                             const double *x) {
    double energy = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *p = x + c * n;
        double k[3] = {0, 0, 0}, M[3];
        for (uint32_t j = 1; j < stencil->n; j++)
            for (int a = 0; a < 3; a++)
                k[a] += stencil->weights[a][j] * (p[stencil->at[j]] - p[stencil->at[0]]);
        cs_moduli_multiply(&stencil->moduli, k, M);
        energy += 0.5 * (k[0] * M[0] + k[1] * M[1] + k[2] * M[2]);
    }
    return energy;
}

double cs_bendings_energy(const struct cs_system *system, const double *x) {
    double sum = 0;
    for (uint32_t b = 0; b < system->bendings->n; b++) {
        const struct cs_bending *bending = system->bendings->bodies + b;
        const struct cs_moduli moduli =
            cs_bending_moduli(cs_scene_elastic(system->scene, bending->body));
        for (uint32_t s = 0; !bending->rest && s < bending->n; s++) {
            struct cs_bending_stencil stencil;
            cs_bending_stencil_at(bending, &moduli, s, &stencil);
            sum += stencil_energy(&stencil, system->view.n, x);
        }
    }
    return sum + curvature_energy(system, x);
}

/* Adds rows of a stencil's matrix: its diagonal, or the sum of magnitudes. */
static void add_rows(const struct cs_bending_stencil *stencil, bool diagonal, double *sums) {
    for (uint32_t i = 0; i < stencil->n; i++)
        for (uint32_t j = diagonal ? i : 0; j < (diagonal ? i + 1 : stencil->n); j++) {
            const double(*b)[CS_BENDING_POINTS] = stencil->weights;
            double M[3];
            cs_moduli_multiply(&stencil->moduli, (const double[3]){b[0][j], b[1][j], b[2][j]},
                               M);
            sums[stencil->at[i]] += fabs(b[0][i] * M[0] + b[1][i] * M[1] + b[2][i] * M[2]);
        }
}

static void add_body_rows(const struct cs_bending *bending, const struct cs_moduli *moduli,
                          bool diagonal, double *sums) {
    for (uint32_t s = 0; s < bending->n; s++) {
        struct cs_bending_stencil stencil;
        cs_bending_stencil_at(bending, moduli, s, &stencil);
        add_rows(&stencil, diagonal, sums);
    }
}

void cs_bendings_update_rows(const struct cs_system *system) {
    struct cs_bendings *bendings = system->bendings;
    for (uint32_t b = 0; b < bendings->n; b++) {
        const struct cs_bending *bending = bendings->bodies + b;
        const struct cs_moduli moduli =
            cs_bending_moduli(cs_scene_elastic(system->scene, bending->body));
        const struct cs_moduli *of = bendings->moduli + b;
        if (bending->rest)
            continue;
        if (of->warp == moduli.warp && of->weft == moduli.weft &&
            of->coupling == moduli.coupling && of->shear == moduli.shear)
            continue;
        memset(bendings->diagonal + bending->first, 0,
               bending->count * sizeof *bendings->diagonal);
        memset(bendings->row_sums + bending->first, 0,
               bending->count * sizeof *bendings->row_sums);
        add_body_rows(bending, &moduli, true, bendings->diagonal);
        add_body_rows(bending, &moduli, false, bendings->row_sums);
        bendings->moduli[b] = moduli;
    }
}

void cs_bendings_add_bound(const struct cs_system *system, const double *x, double *stiffness,
                           double *damping) {
    cs_bendings_update_rows(system);
    for (uint32_t i = 0; i < system->view.n; i++)
        stiffness[i] += system->bendings->row_sums[i];
    if (system->bendings->normal.x)
        add_curvature_bound(system, x, stiffness, damping);
}
