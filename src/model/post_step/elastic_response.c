/* elastic_response.c - solves A u = 0 at the particles that were not pushed, by conjugate
 * gradients restricted to them: residuals and directions are 0 elsewhere (Baraff, Witkin 1998,
 * sec. 5.3). */
#include "model/post_step/elastic_response.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Relative residual, and the largest number of iterations. The response shapes a correction
 * whose energy is checked afterwards, so that few digits suffice. Chosen by trial. */
#define RTOL 1e-2
enum { ITERATIONS_MAX = 300 };

enum cs_status cs_elastic_response_init(struct cs_elastic_response *response,
                                        struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error) {
    *response = (struct cs_elastic_response){0};
    if (system->springs.n == 0 || cs_temporary_pins_init(&response->pins, system, arena, error))
        return error->status;
    return cs_linear_init(&response->linear, system, arena, error);
}

bool cs_elastic_response_is_needed(const struct cs_elastic_response *response, double dt) {
    const struct cs_system *system = response->linear.system;
    return system && dt * system->view.omega > 1;
}

/* Sets a vector to 0 at pinned particles; pushed ones are pinned at that time. */
static void clear_pinned(const struct cs_system *system, double *p) {
    const size_t n = system->view.n;
    for (uint32_t k = 0; k < system->n_pinned; k++)
        for (size_t c = 0; c < 3; c++)
            p[c * n + system->pinned[k]] = 0;
}

/* Sets u to 0 at particles that were not pushed: the start of the iteration. */
static void clear_free(const struct cs_system *system, const bool *pushed, double *u) {
    const size_t n = system->view.n;
    for (size_t i = 0; i < n; i++)
        if (!pushed[i])
            u[i] = u[n + i] = u[2 * n + i] = 0;
}

/* Preconditioned conjugate gradients (Saad 2003) from the pushes in u. The first residual -A u
 * is not 0 at pushed particles either. The preconditioned one is, because clear_pinned follows
 * the preconditioner; all directions are therefore 0 there too. */
static void solve(struct cs_elastic_response *response, double *u) {
    struct cs_linear *linear = &response->linear;
    const struct cs_system *system = linear->system;
    const size_t n3 = 3 * (size_t)system->view.n;
    double *r = linear->r, *z = linear->z, *p = linear->p, *q = linear->q;
    cs_linear_mul(linear, u, q);
    cs_vector_kernels.linear_sum(n3, -1, q, 0, q, r);
    double norm = sqrt(cs_vector_dot(n3, r, r)), before = 0;
    const double goal = RTOL * norm;
    for (int k = 0; k < ITERATIONS_MAX && norm > goal; k++) {
        cs_linear_precondition(linear, r, norm, z);
        clear_pinned(system, z);
        const double now = cs_vector_dot(n3, r, z);
        if (!(now > 0))
            break;
        cs_vector_kernels.linear_sum(n3, 1, z, k > 0 ? now / before : 0, k > 0 ? p : z, p);
        before = now;
        cs_linear_mul(linear, p, q);
        const double curvature = cs_vector_dot(n3, p, q);
        if (!(curvature > 0))
            break;
        cs_vector_kernels.linear_sum(n3, 1, u, now / curvature, p, u);
        cs_vector_kernels.linear_sum(n3, 1, r, -now / curvature, q, r);
        norm = sqrt(cs_vector_dot(n3, r, r));
        response->iterations++;
    }
}

void cs_elastic_response_solve(struct cs_elastic_response *response,
                               const struct cs_matrix *matrix, const bool *pushed, double *u) {
    cs_temporary_pins_set(&response->pins, pushed);
    cs_linear_setup(&response->linear, matrix);
    response->solves++;
    clear_free(response->linear.system, pushed, u);
    solve(response, u);
    cs_temporary_pins_clear(&response->pins, pushed);
}
