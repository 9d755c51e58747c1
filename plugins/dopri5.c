/* dopri5.c - the explicit pair 5(4) of Dormand and Prince with error control.
 *
 * The last stage is evaluated at the new state: it is the first of the next step, unless the
 * state was changed. The error is the distance from the method of order 4.
 *
 * Coefficients: Dormand, Prince 1980; Hairer, Norsett, Wanner 1993, table II.5.2. */
#include "high_order_methods.h"

enum { STAGES = 7 };

// clang-format off
static const double nodes[STAGES] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
static const double table[STAGES][NYSTROM_STAGES] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double difference[STAGES] = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
// clang-format on

const struct nystrom_pair dopri5_pair = {
    .stages = STAGES, .power = 5, .nodes = nodes, .table = table, .difference = difference};

static const struct cs_option rows[] = {ADAPTIVE_ROWS(struct adaptive_options, 1e-4)};

static enum cs_step create(const struct cs_host *host, const void *options, void **out) {
    return nystrom_create(host, options, &dopri5_pair, NULL, out);
}

const struct cs_integrator dopri5 = {
    NYSTROM_METHOD(struct adaptive_options, rows),
    .name = "dopri5",
    .summary = "explicit pair 5(4) with error control",
    .source = "Dormand, Prince 1980; Hairer, Norsett, Wanner 1993, sec. II.5",
    .order = 5,
    .order_damped = 5,
    .traits = CS_ADAPTIVE,
    .create = create,
};
