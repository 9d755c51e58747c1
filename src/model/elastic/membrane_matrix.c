/* Energies and bounds of membranes, and their part of the solver's matrix.
 *
 * With u the differences of a vector p over the edges, a triangle's part of A p pulls at the
 * ends of edge i with
 *
 *   r_i = kappa (K 2 d.u)_i d_i + s_i u_i,   kappa = -ck - cd tau,   s = -ck t
 *
 * The first part is positive semi-definite. The second is A_0 (grad u) S (grad u)^T in the
 * stress S; with psd, S is replaced by its positive part, the nearest such (Teran et al. 2005
 * clamp the whole 6x6 matrix instead). The position derivative of the damping, which is not
 * symmetric, is left out, as with springs. */
#include "model/elastic/membrane_forces.h"

#include "base/pool.h"
#include "base/vec3.h"

#include <math.h>
#include <string.h>

/* Index in K of the entry i, j. */
static const int entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/* One triangle at a state. */
struct triangle {
    uint32_t corners[3];
    double d[3][3], w[3][3]; /* m, m/s: differences over the edges */
    double q[3];             /* m2 */
    const double *rest;
    size_t stride; /* of rest */
};

/* Differences of an array (3,n) over the edges; NULL: 0. */
static void find_edges(const uint32_t corners[3], size_t n, const double *p, double d[3][3]) {
    for (size_t k = 0; k < 3; k++)
        for (size_t c = 0; c < 3; c++)
            d[k][c] = p ? p[c * n + corners[(k + 1) % 3]] - p[c * n + corners[k]] : 0;
}

static void find_triangle(const struct cs_membrane *membrane, uint32_t t, size_t n,
                          const double *x, const double *v, struct triangle *triangle) {
    triangle->stride = membrane->columns ? 1 : membrane->n;
    triangle->rest = membrane->rest + (membrane->columns ? 0 : t);
    cs_membrane_corners(membrane, t, triangle->corners);
    find_edges(triangle->corners, n, x, triangle->d);
    find_edges(triangle->corners, n, v, triangle->w);
    for (size_t k = 0; k < 3; k++)
        triangle->q[k] = cs_vec3_dot(triangle->d[k], triangle->d[k]) -
                         triangle->rest[(CS_MEMBRANE_P + k) * triangle->stride];
}

/* K of a triangle: of a grid all have that of the law. */
static void find_stiffness(const struct cs_membrane *membrane, const struct membrane_law *law,
                           uint32_t t, double K[6]) {
    if (membrane->columns)
        memcpy(K, law->K, sizeof law->K);
    else
        cs_membrane_stiffness(membrane, t, &law->moduli, K);
}

/* --- energies --- */

/* The moduli of a body now. */
static struct cs_moduli moduli_of(const struct cs_system *system,
                                  const struct cs_membrane *membrane) {
    return cs_membrane_moduli(cs_scene_elastic(system->scene, membrane->body));
}

/* W = 1/4 z.C z of q. */
static double energy_of(const struct cs_moduli *moduli, const struct triangle *at) {
    double s[3], t[3];
    membrane_stress(moduli, at->rest, at->stride, at->q, s);
    membrane_tension_of_stress(at->rest, at->stride, s, t);
    return 0.25 * cs_vec3_dot(t, at->q);
}

double cs_membranes_energy(const struct cs_system *system, const struct cs_eval *state) {
    const struct cs_membranes *membranes = system->membranes;
    double sum = 0;
    for (uint32_t b = 0; membranes && b < membranes->n; b++) {
        const struct cs_membrane *membrane = membranes->bodies + b;
        const struct cs_moduli moduli = moduli_of(system, membrane);
        for (uint32_t t = 0; t < membrane->n; t++) {
            struct triangle at;
            find_triangle(membrane, t, system->view.n, state ? state->x : NULL, NULL, &at);
            for (size_t k = 0; !state && k < 3; k++)
                at.q[k] = 3 * at.rest[(CS_MEMBRANE_P + k) * at.stride];
            sum += energy_of(&moduli, &at);
        }
    }
    return sum;
}

/* --- bounds --- */

/* Products d_i.d_j at rest, from the lengths: d_0 + d_1 + d_2 = 0. */
static void rest_products(const struct triangle *at, double G[3][3]) {
    const double *squared = at->rest + CS_MEMBRANE_P * at->stride;
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            G[i][j] = i == j ? squared[i * at->stride]
                             : (squared[(3 - i - j) * at->stride] - squared[i * at->stride] -
                                squared[j * at->stride]) /
                                   2;
}

/* Square of a bound on the frequency of one triangle alone, with a mass s at each corner: the
 * norm of 2 K G, where G has the products of the gradients g of its edges over the masses.
 * g_i is -d_i at corner i and d_i at corner i + 1; two edges share one corner. */
static double frequency_of(const double K[6], double dots[3][3], const double s[3]) {
    double G[3][3], P[3][3] = {{0}}, norm = 0;
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) {
            const size_t shared = j == (i + 1) % 3 ? j : i;
            G[i][j] =
                i == j ? dots[i][i] * (1 / s[i] + 1 / s[(i + 1) % 3]) : -dots[i][j] / s[shared];
        }
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            for (size_t l = 0; l < 3; l++)
                P[i][j] += 2 * K[entry[i][l]] * G[l][j];
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            norm += P[i][j] * P[j][i];
    return sqrt(norm);
}

/* A triangle in the sums of bounds. */
struct bounded {
    struct triangle at;
    double K[6], masses[3]; /* kg, of its corners divided among their triangles */
    bool has_state;
};

/* Adds the row sums of one triangle: the stiffness along its edges is at most `square` times
 * its masses. */
static void add_triangle_bound(const struct membrane_law *law, const struct bounded *bounded,
                               double *stiffness, double *damping) {
    const struct triangle *at = &bounded->at;
    double dots[3][3], q[3], t[3] = {0, 0, 0};
    rest_products(at, dots);
    for (size_t i = 0; bounded->has_state && i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            dots[i][j] = cs_vec3_dot(at->d[i], at->d[j]);
    for (size_t k = 0; bounded->has_state && k < 3; k++)
        q[k] = at->q[k] + law->damping * 2 * cs_vec3_dot(at->d[k], at->w[k]);
    if (bounded->has_state)
        membrane_tension_by_k(bounded->K, q, t);
    const double square = frequency_of(bounded->K, dots, bounded->masses);
    for (size_t k = 0; k < 3; k++) {
        const double norm = bounded->masses[k] * square;
        stiffness[at->corners[k]] += norm + 2 * (fabs(t[k]) + fabs(t[(k + 2) % 3]));
        damping[at->corners[k]] += law->damping * norm;
    }
}

void cs_membranes_add_bound(const struct cs_system *system, const struct cs_eval *at,
                            double *stiffness, double *damping) {
    const struct membrane_job job = {.system = system, .elastic = 1, .damping = 1};
    const struct cs_membranes *membranes = system->membranes;
    for (uint32_t b = 0; b < membranes->n; b++) {
        const struct cs_membrane *membrane = membranes->bodies + b;
        const struct membrane_law law = cs_membrane_law_of(&job, membrane);
        for (uint32_t t = 0; t < membrane->n; t++) {
            struct bounded bounded = {.has_state = at};
            find_stiffness(membrane, &law, t, bounded.K);
            find_triangle(membrane, t, system->view.n, at ? at->x : NULL, at ? at->v : NULL,
                          &bounded.at);
            for (size_t k = 0; k < 3; k++) {
                const uint32_t corner = bounded.at.corners[k];
                bounded.masses[k] = system->mass[corner] / membranes->n_around[corner];
            }
            add_triangle_bound(&law, &bounded, stiffness, damping);
        }
    }
}

/* --- the matrix --- */

/* The positive part of a 2x2 stress XX, YY, XY. Its eigenvalues are mid +- r. */
static void clamp_stress(double s[3]) {
    const double mid = (s[0] + s[1]) / 2, half = (s[0] - s[1]) / 2;
    const double r = sqrt(half * half + s[2] * s[2]);
    const double high = fmax(mid + r, 0), low = fmax(mid - r, 0);
    const double share = r > 0 ? (high - low) / (2 * r) : 0;
    s[0] = (high + low) / 2 + share * half;
    s[1] = (high + low) / 2 - share * half;
    s[2] = share * s[2];
}

/* Tensions of a triangle in the matrix, -ck t. */
static void matrix_tensions(const struct triangle *at, const struct cs_moduli *moduli,
                            const struct cs_matrix *matrix, double t[3]) {
    double s[3];
    membrane_stress(moduli, at->rest, at->stride, at->q, s);
    if (matrix->psd)
        clamp_stress(s);
    membrane_tension_of_stress(at->rest, at->stride, s, t);
    for (int k = 0; k < 3; k++)
        t[k] *= -matrix->ck;
}

/* Adds the diagonal block of a corner, where edge k leaves and edge m arrives:
 *
 *   2 kappa (K_kk d_k d_k^T + K_mm d_m d_m^T - K_km (d_k d_m^T + d_m d_k^T)) + (s_k + s_m) I */
static void add_corner_block(const struct triangle *at, const double K[6], const double s[3],
                             double kappa, size_t corner, double block[6]) {
    const size_t k = corner, m = (corner + 2) % 3;
    const double *u = at->d[k], *w = at->d[m];
    const double uu = 2 * kappa * K[entry[k][k]], ww = 2 * kappa * K[entry[m][m]],
                 uw = 2 * kappa * K[entry[k][m]];
    for (int c = 0; c < 6; c++) {
        const int a = cs_sym3_row[c], b = cs_sym3_column[c];
        block[c] += uu * u[a] * u[b] + ww * w[a] * w[b] - uw * (u[a] * w[b] + w[a] * u[b]) +
                    (a == b ? s[k] + s[m] : 0);
    }
}

/* Arguments of the loops that set the matrix up. */
struct setup {
    const struct cs_system *system;
    const struct cs_matrix *matrix;
    bool kept;
};

/* Sets the blocks of particles [begin, end) of a membrane, and if the matrix is kept the
 * tensions of the triangles whose first corner they are. */
static void set_blocks(const struct setup *setup, const struct cs_membrane *membrane,
                       uint32_t begin, uint32_t end) {
    const struct cs_system *system = setup->system;
    const struct cs_matrix *matrix = setup->matrix;
    const struct membrane_job job = {.system = system, .damping = 1};
    const struct membrane_law law = cs_membrane_law_of(&job, membrane);
    struct cs_membranes *membranes = system->membranes;
    const size_t n = system->view.n;
    const double kappa = -matrix->ck - matrix->cd * law.damping;
    const double factor = matrix->bound && !setup->kept ? 3 : 1;
    for (uint32_t i = begin; i < end; i++) {
        uint32_t grid[6];
        const uint32_t *around;
        const uint32_t count = cs_membrane_incident(membrane, i, grid, &around);
        double block[6] = {0};
        for (uint32_t k = 0; k < count; k++) {
            const uint32_t t = around[k] / 4, corner = around[k] % 4;
            struct triangle at;
            double K[6], s[3];
            // computed for each corner again: threads share no particle
            find_triangle(membrane, t, n, matrix->x, NULL, &at);
            find_stiffness(membrane, &law, t, K);
            matrix_tensions(&at, &law.moduli, matrix, s);
            add_corner_block(&at, K, s, kappa, corner, block);
            for (size_t e = 0; setup->kept && corner == 0 && e < 3; e++)
                membranes->tensions[e * membranes->n_triangles + membrane->begin + t] = s[e];
        }
        for (size_t c = 0; c < 6; c++)
            membranes->blocks[c * n + membrane->first + i] = factor * block[c];
    }
}

/* Calls set_blocks for the particles of each body in a block. */
static void set_block(void *arg, uint32_t number) {
    const struct setup *setup = arg;
    const struct cs_system *system = setup->system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    for (uint32_t b = 0; b < system->membranes->n; b++) {
        const struct cs_membrane *membrane = system->membranes->bodies + b;
        const uint32_t first = membrane->first, after = first + membrane->count;
        const uint32_t begin = block.begin > first ? block.begin : first;
        const uint32_t end = block.end < after ? block.end : after;
        if (begin < end)
            set_blocks(setup, membrane, begin - first, end - first);
    }
}

/* A positive semi-definite matrix of m blocks a side is at most m times its diagonal blocks: 3
 * for a triangle, which is what matrix->bound asks for. */
void cs_membranes_prepare_matrix(const struct cs_system *system, const struct cs_matrix *matrix,
                                 bool kept) {
    struct cs_membranes *membranes = system->membranes;
    struct setup setup = {system, matrix, kept};
    cs_pool_run(system->springs.n_blocks, set_block, &setup);
    if (!kept)
        return;
    memcpy(membranes->kept, membranes->blocks, 6 * sizeof *membranes->kept * system->view.n);
    memcpy(membranes->x, matrix->x, 3 * sizeof *membranes->x * system->view.n);
    membranes->cd = matrix->cd;
    membranes->ck = matrix->ck;
}

/* Arguments of a product. */
struct product {
    struct membrane_job job;
    const double *p;
    double *y;
    bool apart; /* without the diagonal blocks */
};

static void product_block(void *arg, uint32_t number) {
    const struct product *product = arg;
    const struct cs_system *system = product->job.system;
    const struct cs_block block = cs_springs_block(&system->springs, system->view.n, number);
    const size_t n = system->view.n;
    const double *b = system->membranes->kept, *p = product->p;
    double *y = product->y;
    cs_membrane_job_add(&product->job, &block);
    for (size_t i = block.begin; product->apart && i < block.end; i++) {
        const double px = p[i], py = p[n + i], pz = p[2 * n + i];
        y[i] -= b[i] * px + b[n + i] * py + b[2 * n + i] * pz;
        y[n + i] -= b[n + i] * px + b[3 * n + i] * py + b[4 * n + i] * pz;
        y[2 * n + i] -= b[2 * n + i] * px + b[4 * n + i] * py + b[5 * n + i] * pz;
    }
}

/* y += A p of the matrix kept last; damped: with its damping. */
static void add_product(const struct cs_system *system, const double *p, bool damped,
                        double *y) {
    const struct cs_membranes *membranes = system->membranes;
    struct product product = {.job = {.system = system,
                                      .kind = MEMBRANE_PRODUCT,
                                      .x = membranes->x,
                                      .dx = p,
                                      .tensions = membranes->tensions,
                                      .elastic = -membranes->ck,
                                      .per_damping = damped ? -membranes->cd : 0,
                                      .to = y},
                              .p = p,
                              .y = y,
                              .apart = damped};
    cs_membrane_job_prepare(&product.job);
    cs_pool_run(system->springs.n_blocks, product_block, &product);
}

void cs_membranes_add_product(const struct cs_system *system, const double *p, double *y) {
    add_product(system, p, true, y);
}

void cs_membranes_add_approach(const struct cs_system *system, const struct cs_matrix *matrix,
                               double *y) {
    add_product(system, matrix->v, false, y);
}
