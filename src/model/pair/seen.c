/* The energy of pairs that a step does not see, pair by pair. */
#include "model/pair/seen.h"

#include "base/vector.h"
#include "model/contact/points.h"
#include "model/contact/share.h"
#include "model/pair/nearness.h"

/* points of one move, at most */
enum { POINTS_MOST = 64 };

struct job {
    const struct cs_pairs *pairs;
    const double *x0, *x1; /* (3, n_points) */
    double h;
};

/* One pair on its way. */
struct way {
    enum cs_stencil_kind kind;
    double from[4][3], move[4][3];
    double inverse_mass[4];
};

static void read_way(const struct job *job, enum cs_stencil_kind kind, const uint32_t at[4],
                     struct way *way) {
    const size_t n = job->pairs->system->surfaces->n_points;
    way->kind = kind;
    for (size_t k = 0; k < 4; k++) {
        way->inverse_mass[k] = cs_points_inverse_mass(job->pairs->system, at[k]);
        for (size_t c = 0; c < 3; c++) {
            way->from[k][c] = job->x0[c * n + at[k]];
            way->move[k][c] = job->x1[c * n + at[k]] - way->from[k][c];
        }
    }
}

/* the most that a point of one side moves by against one of the other */
static double largest_move(const struct way *way) {
    const int first = way->kind == CS_STENCIL_EDGES ? 2 : 1;
    double most = 0;
    for (int i = 0; i < first; i++)
        for (int j = first; j < 4; j++) {
            double squared = 0;
            for (int c = 0; c < 3; c++)
                squared +=
                    (way->move[i][c] - way->move[j][c]) * (way->move[i][c] - way->move[j][c]);
            most = squared > most ? squared : most;
        }
    return sqrt(most);
}

static void set_at(const struct way *way, double share, struct cs_stencil *s) {
    double p[4][3];
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            p[k][c] = way->from[k][c] + share * way->move[k][c];
    cs_stencil_set(s, way->kind, p);
}

/* kinetic energy in J of the contact points against each other, and by how much the gradient
 * says that they come nearer over the whole move */
static double kinetic(const struct way *way, const struct cs_stencil *s, double h,
                      double *approach) {
    double weight[4], g[4][3], v[3] = {0}, inverse = 0;
    cs_stencil_weights(s, weight);
    cs_stencil_gradient(s, g);
    *approach = 0;
    for (int k = 0; k < 4; k++) {
        inverse += weight[k] * weight[k] * way->inverse_mass[k];
        *approach -= cs_vec3_dot(g[k], way->move[k]);
        for (int c = 0; c < 3; c++)
            v[c] += weight[k] * way->move[k][c] / h;
    }
    return inverse > 0 ? 0.5 * cs_vec3_dot(v, v) / inverse : HUGE_VAL;
}

static bool is_unseen(const struct job *job, struct way *way,
                      const struct cs_meeting *meeting) {
    const double range = meeting->range, k = meeting->k, move = largest_move(way);
    const int points =
        move < 0.5 * range * POINTS_MOST ? 1 + (int)(move / (0.5 * range)) : POINTS_MOST;
    struct cs_stencil start, s;
    if (cs_nearness_is_apart(way->kind, way->from, range + move))
        return false;
    double approach, unseen = 0;
    bool near = false;
    set_at(way, 0, &start);
    const struct cs_law law = cs_law_at(start.d, range, k);
    const double held = cs_law_energy(start.d, range, k);
    const double has =
        kinetic(way, &start, job->h, &approach) + held + cs_law_energy(0.5 * range, range, k);
    for (int j = 1; j <= points; j++) {
        const double share = j / (double)points, come = share * approach;
        set_at(way, share, &s);
        near = near || s.d < range;
        const double seen = held + law.force * come + 0.5 * law.stiffness * come * come;
        unseen = fmax(unseen, fabs(cs_law_energy(s.d, range, k) - seen));
    }
    return (near || start.d < range) && unseen > CS_SHARE_UNSEEN * has;
}

static double count_unseen(const void *arg, size_t begin, size_t end) {
    const struct job *job = arg;
    const struct cs_search *search = &job->pairs->search;
    double unseen = 0;
    for (size_t l = begin; l < end; l++)
        for (size_t p = 0; p < search->lots[l].n; p++) {
            uint32_t at[4];
            struct way way;
            cs_search_corners(job->pairs->system->surfaces, search->lots[l].kind,
                              search->lots[l].pairs + 2 * p, at);
            read_way(job, search->lots[l].kind, at, &way);
            unseen += is_unseen(
                job, &way,
                cs_meeting_of(&job->pairs->meetings, search->body[at[0]], search->body[at[2]]));
        }
    return unseen;
}

bool cs_pairs_are_seen(struct cs_pairs *pairs, double t0, const double *x0, double t1,
                       const double *x1) {
    const struct job job = {pairs, cs_points_places(pairs->system, CS_POINTS_BEGIN, t0, x0),
                            cs_points_places(pairs->system, CS_POINTS_END, t1, x1), t1 - t0};
    return cs_search_cover(&pairs->search, job.x0, job.x1) &&
           cs_vector_sum(pairs->search.n_lots, count_unseen, &job) == 0;
}
