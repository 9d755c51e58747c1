/* What a pair in range does to its four particles, with friction and damping, over pairs at
 * random of which many are at hard places: force against the slope of the energy, its change
 * against differences, and nothing pushed or turned as a whole. A tenth of the pairs by
 * default; "all" for 1e5. */
#include "model/contact/narrow_phase/pair_contact.h"
#include "pair_positions.h"
#include "scene/contact_keys.h"
#include "unit.h"

static int n_pairs(void) {
    return suite_all ? 100000 : 10000;
}

static const struct cs_contact_keys keys = {
    .damping = 0.05, .friction_speed = 0.5, .loss = 0.6};
static const struct cs_feature_kind forms[] = {{1, 1, 0.2}, {0, 1, 0.2}, {0, 0, 0.2}};

/* A pair at one state and a direction to move in. */
struct place {
    enum cs_pair_kind kind;
    struct cs_feature_kind form;
    struct cs_body_pair_params params;
    double p[4][3], v[4][3], dp[4][3], dv[4][3];
};

static void react(const struct place *place, double p[4][3], double v[4][3],
                  struct cs_pair_contact *contact) {
    cs_pair_contact_measure(contact, place->kind, place->form, place->params.range, p);
    cs_pair_contact_set(contact, &place->params, &keys, v);
    contact->contact.rate = 15;
}

static void draw_four(uint64_t *state, double to[4][3]) {
    for (int k = 0; k < 12; k++)
        to[k / 3][k % 3] = draw(state);
}

/* in a range that it is anywhere in, but for the innermost tenth; false: not to be measured */
static bool put(uint64_t *state, int pair, struct place *place,
                struct cs_pair_contact *contact) {
    place->kind = pair % 2 ? CS_PAIR_EDGE_EDGE : CS_PAIR_POINT_TRIANGLE;
    place->form = forms[pair / 2 % 3];
    if (place->kind == CS_PAIR_EDGE_EDGE)
        place_stencil(state, pair / 2, place->kind, place->p);
    else
        place_facet(state, pair / 2, place->p);
    draw_four(state, place->v);
    draw_four(state, place->dp);
    draw_four(state, place->dv);
    const double y = 0.54 + 0.44 * draw(state);
    place->params = (struct cs_body_pair_params){.range = 1, .k = 10, .friction = 0.4};
    const bool edges = place->kind == CS_PAIR_EDGE_EDGE;
    // the distance of edges depends on their range a little
    for (int round = 0; round < 8; round++) {
        react(place, place->p, place->v, contact);
        place->params.range = (edges ? contact->distance.d : contact->feature.d) / y;
    }
    react(place, place->p, place->v, contact);
    const double at = contact->contact.d / place->params.range;
    return !edges || (place_is_good(&contact->distance) && at > 0.1 && at < 0.98);
}

static double energy(const struct cs_pair_contact *reaction) {
    const struct cs_point_contact *touch = &reaction->contact;
    return cs_barrier_energy(touch->d, touch->range, touch->k);
}

/* by the best of several steps: of the energy against the elastic force, and of the whole force
 * against its change; relative to these */
static void differ(const struct place *place, const struct cs_pair_contact *contact,
                   double best[2]) {
    struct cs_pair_contact_motion motion;
    double f[4][3], push[4][3], df[4][3], along = 0;
    memcpy(motion.p, place->p, sizeof motion.p);
    memcpy(motion.v, place->v, sizeof motion.v);
    memcpy(motion.dp, place->dp, sizeof motion.dp);
    memcpy(motion.dv, place->dv, sizeof motion.dv);
    cs_pair_contact_force(contact, (struct cs_contact_force_parts){1, 1}, f);
    cs_pair_contact_force(contact, (struct cs_contact_force_parts){1, 0}, push);
    cs_pair_contact_jvp(contact, (struct cs_contact_force_parts){1, 1}, &motion, df);
    for (int k = 0; k < 4; k++)
        along += cs_vec3_dot(push[k], motion.dp[k]);
    for (int i = 0; i < PLACE_STEPS; i++) {
        double slope = 0, off[4][3] = {{0}}, p[4][3], v[4][3], there[4][3];
        place_add(off, -1, df);
        for (int j = 0; j < PLACE_AT; j++) {
            const double by = place_at[j] * place_steps[i];
            const double share = place_share[j] / place_steps[i];
            struct cs_pair_contact moved;
            place_move(motion.p, by, motion.dp, p);
            place_move(motion.v, by, motion.dv, v);
            react(place, p, v, &moved);
            cs_pair_contact_force(&moved, (struct cs_contact_force_parts){1, 1}, there);
            slope += share * energy(&moved);
            place_add(off, share, there);
        }
        best[0] = fmin(best[0], fabs(slope + along) / place_size(push));
        best[1] = fmin(best[1], place_size(off) / (place_size(df) + place_size(f)));
    }
}

TEST(derivatives_are_those_of_differences) {
    uint64_t state = 11;
    double worst[2] = {0};
    int tried = 0;
    for (int pair = 0; pair < n_pairs(); pair++) {
        struct place place;
        struct cs_pair_contact contact;
        double best[2] = {HUGE_VAL, HUGE_VAL};
        if (!put(&state, pair, &place, &contact))
            continue;
        differ(&place, &contact, best);
        for (int k = 0; k < 2; k++)
            worst[k] = fmax(worst[k], best[k]);
        tried++;
    }
    ck_assert_msg(worst[0] < 1e-6 && worst[1] < 1e-6, "%g %g", worst[0], worst[1]);
    ck_assert_int_gt(tried, n_pairs() / 2);
}

/* friction acts at two points and turns the pair: it pushes nothing all the same */
TEST(nothing_is_pushed_as_a_whole) {
    uint64_t state = 12;
    double worst[2] = {0};
    for (int pair = 0; pair < n_pairs(); pair++) {
        struct place place;
        struct cs_pair_contact contact;
        double f[4][3], here[4][3] = {{0}};
        put(&state, pair, &place, &contact);
        cs_pair_contact_force(&contact, (struct cs_contact_force_parts){1, 1}, f);
        worst[0] = fmax(worst[0], place_whole(here, f) / place_size(f));
        cs_pair_contact_force(&contact, (struct cs_contact_force_parts){1, 0}, f);
        worst[1] = fmax(worst[1], place_whole(place.p, f) / place_size(f));
    }
    ck_assert_msg(worst[0] < 1e-12 && worst[1] < 1e-12, "%g %g", worst[0], worst[1]);
}

/* Points that coincide have no direction. With friction and damping everything is finite
 * there: a point on a triangle, on its edge, on its vertex, and edges that cross. */
TEST(all_is_finite_at_distance_zero) {
    static const double triangle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const double on[][3] = {{0.25, 0.25, 0}, {0.5, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 12; k++) {
        struct place place = {.kind = k < 9 ? CS_PAIR_POINT_TRIANGLE : CS_PAIR_EDGE_EDGE,
                              .form = forms[k / 3 % 3],
                              .params = {.range = 1, .k = 2, .friction = 0.5},
                              .v = {{0.3, -0.2, 0.1}},
                              .dp = {{-0.1, 0.3, 0.2}},
                              .dv = {{0.2, 0.1, -0.3}}};
        struct cs_pair_contact contact;
        struct cs_pair_contact_motion motion;
        double f[4][3], df[4][3], stiffness[4], damping[4], sum = 0;
        for (int c = 0; c < 9; c++)
            place.p[1 + c / 3][c % 3] = triangle[c / 3][c % 3];
        memcpy(place.p[0], on[k % 3], sizeof place.p[0]);
        if (k >= 9) // edges that cross, from a vertex, in one line
            for (int c = 0; c < 3; c++)
                place.p[1][c] = on[k % 3][c] + (k == 11 ? c == 0 : c == 2);
        react(&place, place.p, place.v, &contact);
        memcpy(motion.p, place.p, sizeof motion.p);
        memcpy(motion.v, place.v, sizeof motion.v);
        memcpy(motion.dp, place.dp, sizeof motion.dp);
        memcpy(motion.dv, place.dv, sizeof motion.dv);
        const struct cs_contact_force_parts parts = {1, 1};
        cs_pair_contact_force(&contact, parts, f);
        cs_pair_contact_jvp(&contact, parts, &motion, df);
        cs_pair_contact_bound(&contact, stiffness, damping);
        for (int j = 0; j < 4; j++) {
            sum += stiffness[j] + damping[j];
            for (int c = 0; c < 3; c++)
                sum += f[j][c] + df[j][c] + contact.g[j][c];
        }
        ck_assert_msg(isfinite(sum), "case %d: %g", k, sum);
    }
}
