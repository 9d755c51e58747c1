/* tableau.c - Runge-Kutta methods whose coefficients clothsim has read from a file, by the
 * engines of dopri5 (nystrom.c) and esdirk (esdirk.c).
 *
 * Both need a first stage at the begin of a step and a last one at the new state, which is the
 * first of the next step. A tableau without one gets it: a row of zeros, or the row b. With a
 * pair steps are of the length that its error allows, or all of dt; without one they are of dt,
 * shorter only where contact or an iteration that does not converge asks for that. */
#include "esdirk.h"

/* Bound of the sums in which coefficients rounded to doubles satisfy a condition. */
#define ROUNDING 1e-12

/* step_root takes powers up to 12 */
enum { POWER_MAX = 12 };

/* A method without a pair has a step, and no error that could choose it. */
#define STEP_ROW CS_OPTION(struct esdirk_options, dt, "s", 0.001, 1e-9, 1, "step")
static const struct cs_option step_rows[] = {STEP_ROW}, pair_rows[] = {ESDIRK_EXPLICIT_ROWS},
                              implicit_pair_rows[] = {ESDIRK_ROWS},
                              implicit_step_rows[] = {
                                  STEP_ROW,
                                  CS_OPTION(struct esdirk_options, rtol, "", 1e-6, 1e-14, 0.1,
                                            "residual of Newton's iteration, relative to the "
                                            "impulse of a stage"),
                                  ESDIRK_ITERATIONS_ROW};

/* The coefficients in the form of the engines. */
struct stages {
    struct nystrom_pair pair;
    double nodes[NYSTROM_STAGES], table[NYSTROM_STAGES][NYSTROM_STAGES],
        difference[NYSTROM_STAGES];
};

static bool is_implicit(const struct cs_tableau *tableau) {
    bool found = false;
    for (int i = 0; i < tableau->stages; i++)
        found |= tableau->a[i][i] > 0;
    return found;
}

/* True if the last stage stands at the new state. */
static bool ends_at_new_state(const struct cs_tableau *tableau) {
    const int last = tableau->stages - 1;
    bool same = true;
    for (int j = 0; j <= last; j++)
        same &= tableau->a[last][j] == tableau->b[j];
    return same;
}

/* True if sum_i b_i a_ij = b_j (1 - c_j), the last row being b. */
static bool has_short_sum(const struct nystrom_pair *pair) {
    const double *b = pair->table[pair->stages - 1];
    bool holds = true;
    for (int j = 0; j < pair->stages; j++) {
        double sum = 0;
        for (int i = j; i < pair->stages; i++)
            sum += b[i] * pair->table[i][j];
        holds &= fabs(sum - b[j] * (1 - pair->nodes[j])) < ROUNDING;
    }
    return holds;
}

/* Copies a tableau, with the stages that it lacks at both ends. */
static void fill(struct stages *out, const struct cs_tableau *tableau) {
    const int n = tableau->stages, first = tableau->a[0][0] > 0;
    const int stages = first + n + !ends_at_new_state(tableau);
    for (int j = 0; j < n; j++) {
        out->nodes[first + j] = tableau->c[j];
        out->difference[first + j] = tableau->difference[j];
        out->table[stages - 1][first + j] = tableau->b[j];
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++)
            out->table[first + i][first + j] = tableau->a[i][j];
    out->nodes[stages - 1] = 1;
    out->pair = (struct nystrom_pair){.stages = stages,
                                      .power = tableau->order,
                                      .nodes = out->nodes,
                                      .table = (const double(*)[NYSTROM_STAGES])out->table,
                                      .difference = out->difference};
    if (out->pair.power > POWER_MAX)
        out->pair.power = POWER_MAX;
    out->pair.by_table = !has_short_sum(&out->pair);
}

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    const struct cs_tableau_channel *channel = options;
    struct esdirk_options asked = *(const struct esdirk_options *)channel->options;
    struct stages *stages = host->alloc(host->ctx, sizeof *stages);
    if (!stages)
        return CS_STEP_FAIL;
    fill(stages, channel->tableau);
    if (!asked.max_steps) // of steps without a pair, which have no such option
        asked.max_steps = INT64_MAX;
    if (is_implicit(channel->tableau))
        return esdirk_create(host, &asked, &stages->pair, out);
    const struct adaptive_options adaptive = esdirk_adaptive_options(&asked);
    return nystrom_create(host, &adaptive, &stages->pair, NULL, out);
}

/* clothsim puts name, source and order of the file in place of these. */
#define TEXTS                                                                                  \
    .name = "tableau", .summary = "Runge-Kutta method by a tableau",                           \
    .source = "clothsim-program(7)", .create = create
static const struct cs_integrator step = {NYSTROM_METHOD(struct esdirk_options, step_rows),
                                          TEXTS};
static const struct cs_integrator pair = {NYSTROM_METHOD(struct esdirk_options, pair_rows),
                                          TEXTS, .traits = CS_ADAPTIVE};
static const struct cs_integrator implicit_step = {ESDIRK_METHOD(implicit_step_rows), TEXTS,
                                                   .traits = CS_IMPLICIT};
static const struct cs_integrator implicit_pair = {ESDIRK_METHOD(implicit_pair_rows), TEXTS,
                                                   .traits = CS_IMPLICIT | CS_ADAPTIVE};
static const struct cs_integrator *const integrators[] = {&step, &pair, &implicit_step,
                                                          &implicit_pair};

CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI, .size = sizeof(struct cs_integrator), .n = 4, .integrators = integrators};
