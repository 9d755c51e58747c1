/* Sweeps over groups of springs against a loop over springs one by one, to the bit: a grid, a
 * chain, whose springs share all their ends, and springs in any order between any particles. */
#include "../../plugins/spring_groups.h"
#include "base/arena.h"
#include "unit.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SIDE = 9, N = SIDE * SIDE, SPRINGS = 600 };

static const double h = 1 / 60.0;

struct net {
    uint32_t ends[2 * SPRINGS];
    double length[SPRINGS], stiffness[SPRINGS], damping[SPRINGS];
    uint8_t axial[SPRINGS];
    double inv_mass[N], x[3 * N], old[3 * N];
    struct cs_view view;
    struct cs_arena arena;
};

static uint32_t pick(uint64_t *state, uint32_t n) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((*state >> 33) % n);
}

static double draw(uint64_t *state) {
    return pick(state, 1u << 30) * 0x1p-30;
}

static void *take(void *arena, size_t bytes) {
    struct cs_error error = {0};
    return cs_arena_alloc_array(arena, bytes, 1, &error);
}

static void join(struct net *net, uint32_t a, uint32_t b) {
    net->ends[2 * net->view.n_springs] = a;
    net->ends[2 * net->view.n_springs++ + 1] = b;
}

static void join_grid(struct net *net) {
    for (uint32_t i = 0; i < N; i++) {
        if (i % SIDE + 1 < SIDE)
            join(net, i, i + 1);
        if (i + SIDE < N)
            join(net, i, i + SIDE);
        if (i % SIDE > 0 && i + SIDE < N)
            join(net, i, i + SIDE - 1);
    }
}

static void join_chain(struct net *net) {
    for (uint32_t i = 0; i + 1 < N; i++)
        join(net, i, i + 1);
}

static void join_any(struct net *net) {
    uint64_t state = 3;
    while (net->view.n_springs < SPRINGS) {
        const uint32_t a = pick(&state, N), b = pick(&state, N);
        if (a != b)
            join(net, a, b);
    }
}

/* `axial` of 4 springs have an axial damper and as many `relative` the other; two particles are
 * in one place, and every seventh is pinned */
static void make(struct net *net, void (*joined)(struct net *), uint32_t axial,
                 uint32_t relative) {
    uint64_t state = 7;
    memset(net, 0, sizeof *net);
    net->view = (struct cs_view){.size = sizeof net->view, .n = N, .inv_mass = net->inv_mass};
    net->view.ends = net->ends, net->view.length = net->length, net->view.axial = net->axial;
    net->view.stiffness = net->stiffness, net->view.damping = net->damping;
    joined(net);
    for (uint32_t s = 0; s < net->view.n_springs; s++) {
        const uint32_t kind = pick(&state, 4);
        net->length[s] = 0.1 + draw(&state);
        net->stiffness[s] = 100 * (0.1 + draw(&state));
        net->axial[s] = kind < axial;
        net->damping[s] = kind < axial + relative ? draw(&state) : 0;
    }
    for (uint32_t k = 0; k < 3 * N; k++) {
        net->old[k] = draw(&state);
        net->x[k] = net->old[k] + 0.1 * draw(&state);
    }
    for (uint32_t c = 0; c < 3; c++)
        net->x[c * N + 1] = net->x[c * N];
    for (uint32_t i = 0; i < N; i++)
        net->inv_mass[i] = i % 7 == 0 ? 0 : 1 + draw(&state);
}

/* d of spring s in p */
static void across(const struct net *net, uint32_t s, const double *p, double d[3]) {
    for (int c = 0; c < 3; c++)
        d[c] = p[c * N + net->ends[2 * s + 1]] - p[c * N + net->ends[2 * s]];
}

static void push_apart(const struct net *net, uint32_t s, const double push[3], double *x) {
    const uint32_t a = net->ends[2 * s], b = net->ends[2 * s + 1];
    for (int c = 0; c < 3; c++) {
        x[c * N + a] -= net->inv_mass[a] * push[c];
        x[c * N + b] += net->inv_mass[b] * push[c];
    }
}

/* the law of xpbd.c, spring after spring; `spring` and `damper` are the multipliers */
static void sweep_one_by_one(const struct net *net, double *spring, double (*damper)[3],
                             double *x) {
    for (uint32_t s = 0; s < net->view.n_springs; s++) {
        const double weight =
            net->inv_mass[net->ends[2 * s]] + net->inv_mass[net->ends[2 * s + 1]];
        const double k = net->stiffness[s], a = 1 / (k * h * h);
        const double g = net->axial[s] ? net->damping[s] / (k * h) : 0;
        double d[3], old[3], moved = 0, squared = DBL_MIN;
        across(net, s, x, d);
        across(net, s, net->old, old);
        for (int c = 0; c < 3; c++)
            squared += d[c] * d[c];
        const double length = sqrt(squared);
        for (int c = 0; c < 3; c++)
            moved += d[c] / length * (d[c] - old[c]);
        const double change =
            (net->length[s] - length - a * spring[s] - g * moved) / ((1 + g) * weight + a);
        spring[s] += change;
        for (int c = 0; c < 3; c++)
            d[c] *= change / length;
        push_apart(net, s, d, x);
        if (net->axial[s] || !(net->damping[s] > 0))
            continue;
        const double soft = 1 / (net->damping[s] * h);
        across(net, s, x, d);
        for (int c = 0; c < 3; c++) {
            d[c] = (old[c] - d[c] - soft * damper[s][c]) / (weight + soft);
            damper[s][c] += d[c];
        }
        push_apart(net, s, d, x);
    }
}

static void compare(const struct spring_sweeps *sweeps, void (*joined)(struct net *),
                    uint32_t axial, uint32_t relative) {
    static struct net net;
    static double spring[SPRINGS], damper[SPRINGS][3];
    double x[3 * N];
    make(&net, joined, axial, relative);
    struct spring_groups groups = {0};
    const struct cs_host host = {
        .size = sizeof host, .ctx = &net.arena, .view = &net.view, .alloc = take};
    ck_assert_int_eq(spring_groups_init(&groups, &host), CS_STEP_OK);
    spring_groups_read_constants(&groups, &net.view, h);
    spring_groups_gather(&groups, &net.view, net.old);
    sweeps->note_old(&groups);
    memcpy(x, net.x, sizeof x);
    spring_groups_gather(&groups, &net.view, x);
    memset(spring, 0, sizeof spring);
    memset(damper, 0, sizeof damper);
    for (int pass = 0; pass < 3; pass++) {
        sweeps->sweep(&groups, pass == 0);
        sweep_one_by_one(&net, spring, damper, net.x);
    }
    spring_groups_scatter(&groups, &net.view, x);
    ck_assert_mem_eq(x, net.x, sizeof x);
    cs_arena_finish(&net.arena);
}

TEST(sweeps_are_those_of_a_loop) {
    static void (*const nets[])(struct net *) = {join_grid, join_chain, join_any};
    for (size_t k = 0; k < sizeof nets / sizeof *nets; k++)
        for (uint32_t axial = 0; axial <= 2; axial++)
            for (uint32_t relative = 0; relative <= 2; relative++) {
                compare(&spring_sweeps_2, nets[k], axial, relative);
                compare(&spring_sweeps_4, nets[k], axial, relative);
                compare(&spring_sweeps_8, nets[k], axial, relative);
            }
}

/* no two springs of a group share a particle, and no spring is left out or named twice */
TEST(groups_share_no_particle) {
    static struct net net;
    bool seen[SPRINGS] = {0};
    uint32_t n = 0;
    make(&net, join_any, 1, 1);
    struct spring_groups groups = {0};
    const struct cs_host host = {
        .size = sizeof host, .ctx = &net.arena, .view = &net.view, .alloc = take};
    ck_assert_int_eq(spring_groups_init(&groups, &host), CS_STEP_OK);
    for (uint32_t g = 0; g < groups.n; g++) {
        bool used[N + 1] = {0};
        for (uint32_t l = 0; l < LANES; l++) {
            const uint32_t a = groups.groups[g].a[l] / 4, b = groups.groups[g].b[l] / 4;
            if (a == N)
                continue;
            ck_assert(!used[a] && !used[b] && !seen[groups.spring[LANES * g + l]]);
            used[a] = used[b] = seen[groups.spring[LANES * g + l]] = true;
            n++;
        }
    }
    ck_assert_uint_eq(n, SPRINGS);
    cs_arena_finish(&net.arena);
}
