/* What is seen from a viewpoint, against a ray test over every triangle and obstacle. */
#include "rays.h"
#include "scene/force_keys.h"

static uint64_t state = 88172645463325252u;

/* from -1 to 1 */
static double draw(void) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) / 4503599627370496.0 - 1;
}

struct looker {
    struct sheet sheet;
    struct cs_arena arena;
    struct cs_visibility_scratch work;
    bool *seen;
};

static void looker_open(struct looker *looker, const char *scene) {
    struct cs_error error = {0};
    *looker = (struct looker){0};
    sheet_open(&looker->sheet, 0, "%s", scene);
    const uint32_t n = (uint32_t)looker->sheet.n;
    ck_assert_int_eq(cs_visibility_scratch_init(&looker->work, n, &looker->arena, &error),
                     CS_OK);
    looker->seen = cs_arena_alloc_array(&looker->arena, n, sizeof *looker->seen, &error);
}

static uint32_t look(struct looker *looker, const struct cs_viewpoint_force *viewpoint_force) {
    struct cs_visibility_query visibility;
    uint32_t count = 0;
    cs_visibility_query_make(&visibility, viewpoint_force);
    cs_visibility_query_run(&visibility, &looker->sheet.system, 0, looker->sheet.x,
                            viewpoint_force->body, &looker->work, looker->seen);
    for (size_t i = 0; i < looker->sheet.n; i++)
        count += looker->seen[i];
    return count;
}

static void looker_close(struct looker *looker) {
    cs_arena_finish(&looker->arena);
    sheet_close(&looker->sheet);
}

static void draw_viewpoint_force(struct cs_viewpoint_force *viewpoint_force, double distance) {
    *viewpoint_force = (struct cs_viewpoint_force){
        .viewpoint = {.fov = 70 + 60 * draw(), .aspect = 1.5 + draw()}, .body = -1};
    for (int c = 0; c < 3; c++) {
        viewpoint_force->viewpoint.eye[c] = distance * draw();
        viewpoint_force->viewpoint.target[c] = 0.3 * draw();
        viewpoint_force->viewpoint.up[c] = draw();
    }
    for (int c = 0; c < 2; c++) {
        viewpoint_force->rectangle[c] = 0.25 + 0.25 * draw();
        viewpoint_force->rectangle[2 + c] = 0.75 + 0.25 * draw();
    }
}

/* Random views of crumpled bodies, from afar and from their middle. */
TEST(same_as_by_brute_force) {
    struct looker looker;
    uint32_t seen = 0, hidden = 0, unclear = 0;
    looker_open(&looker, SCENE);
    const size_t n = looker.sheet.n;
    for (int k = 0; k < 60; k++) {
        struct cs_viewpoint_force viewpoint_force;
        memcpy(looker.sheet.x, looker.sheet.system.start, 3 * n * sizeof(double));
        for (size_t i = 0; i < 3 * n; i++)
            looker.sheet.x[i] += 0.02 * (1 + k % 5) * draw();
        draw_viewpoint_force(&viewpoint_force, k % 3 ? 3 : 0.5);
        look(&looker, &viewpoint_force);
        for (uint32_t i = 0; i < n; i++) {
            const struct verdict expected = look_at(&looker.sheet, &viewpoint_force, i);
            if (expected.margin < 1e-8) {
                unclear++;
                continue;
            }
            ck_assert_msg(looker.seen[i] == expected.seen, "view %d, particle %u: %d", k, i,
                          looker.seen[i]);
            seen += expected.seen;
            hidden += !expected.seen;
        }
    }
    ck_assert_msg(seen > 1000 && hidden > 1000 && unclear < 10, "%u seen, %u not, %u unclear",
                  seen, hidden, unclear);
    looker_close(&looker);
}

/* One body at a time: the others still hide it. */
TEST(bodies_are_looked_at_alone) {
    struct looker looker;
    struct cs_viewpoint_force viewpoint_force;
    looker_open(&looker, SCENE);
    draw_viewpoint_force(&viewpoint_force, 0);
    viewpoint_force.viewpoint.eye[1] = viewpoint_force.viewpoint.eye[2] = 2;
    const uint32_t all = look(&looker, &viewpoint_force);
    uint32_t sum = 0, most = 0;
    for (viewpoint_force.body = 0; viewpoint_force.body < 3; viewpoint_force.body++) {
        const uint32_t alone = look(&looker, &viewpoint_force);
        sum += alone;
        most = alone > most ? alone : most;
        for (uint32_t i = 0; i < looker.sheet.n; i++) {
            const struct cs_body_range *body =
                looker.sheet.system.bodies + viewpoint_force.body;
            const bool is_its = i >= body->first && i < body->first + body->count;
            ck_assert(!looker.seen[i] || is_its);
        }
    }
    ck_assert_uint_eq(sum, all);
    ck_assert_uint_lt(most, all);
    looker_close(&looker);
}

/* a cloth of 9 x 9 in the plane z = 0; another one at z = -2; %s: the obstacles */
#define PAIR(size, colliders)                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9]}, \"mass\": {\"total\": 1}},"                 \
    " {\"cloth\": {\"grid\": [9, 9], \"size\": " size ", \"place\": {\"translate\":"           \
    " [0, 0, -2]}}, \"mass\": {\"total\": 1}}], \"colliders\": [" colliders "]}"

static const struct cs_viewpoint_force front = {.viewpoint = {.eye = {0, 0, 2},
                                                              .target = {0, 0, 0},
                                                              .up = {0, 1, 0},
                                                              .fov = 90,
                                                              .aspect = 1},
                                                .rectangle = {0, 0, 1, 1},
                                                .body = -1};

/* The second cloth is twice as large and twice as far away, so that every line to it goes
 * through a corner of the first: nothing is seen through seams, and of a third as large what
 * stands out. */
TEST(nothing_is_seen_through_seams) {
    static const struct {
        const char *scene;
        uint32_t seen;
    } rows[] = {{PAIR("[2, 2]", ""), 81},
                {PAIR("[4, 4]", ""), 81 + 81 - 25},
                {PAIR("[4, 2]", ""), 81 + 81 - 45}};
    for (size_t k = 0; k < 3; k++) {
        struct looker looker;
        looker_open(&looker, rows[k].scene);
        ck_assert_uint_eq(look(&looker, &front), rows[k].seen);
        looker_close(&looker);
    }
}

/* Behind points on edges, from anywhere: lines along the planes between two triangles. */
TEST(edges_are_tight) {
    struct looker looker;
    looker_open(&looker, PAIR("[1, 1]", ""));
    const size_t n = looker.sheet.n;
    for (int k = 0; k < 50; k++) {
        struct cs_viewpoint_force viewpoint_force = front;
        for (int c = 0; c < 3; c++)
            viewpoint_force.viewpoint.eye[c] += draw();
        for (size_t i = 81; i < n; i++) {
            /* inside an edge between two particles, across, down or diagonal */
            const size_t row = 1 + i % 6, column = 1 + i / 6 % 6, from = 9 * row + column;
            const size_t to = from + (size_t[]){1, 9, 8}[(i + (size_t)k) % 3];
            const double share = 0.5 + 0.4 * draw(), depth = 1.5 + 0.4 * draw();
            for (size_t c = 0; c < 3; c++) {
                const double *x = looker.sheet.x + c * n,
                             eye = viewpoint_force.viewpoint.eye[c];
                const double point = x[from] + share * (x[to] - x[from]);
                looker.sheet.x[c * n + i] = eye + depth * (point - eye);
            }
        }
        viewpoint_force.body = 1;
        ck_assert_uint_eq(look(&looker, &viewpoint_force), 0);
    }
    looker_close(&looker);
}

/* What touches an obstacle is seen on the near side and hidden on the far one. */
TEST(obstacles_hide_what_is_behind) {
    static const struct {
        const char *scene;
        uint32_t seen;
    } rows[] = {
        {PAIR("[1, 1]", "{\"sphere\": {\"centre\": [0, 0, 1], \"radius\": 0.01}}"), 80},
        {PAIR("[1, 1]", "{\"sphere\": {\"centre\": [0, 0, -0.5], \"radius\": 0.5}}"), 81},
        {PAIR("[1, 1]", "{\"sphere\": {\"centre\": [0, 0, 1], \"radius\": 0.9}}"), 0},
        {PAIR("[1, 1]",
              "{\"sphere\": {\"centre\": [0, 0, 1], \"radius\": 0.9}, \"visible\": false}"),
         81},
        {PAIR("[1, 1]", "{\"sphere\": {\"centre\": [0, 0, 3], \"radius\": 0.9}}"), 81},
        {PAIR("[1, 1]", "{\"sphere\": {\"centre\": [0, 0, 2], \"radius\": 0.1}}"), 0},
        {PAIR("[1, 1]", "{\"plane\": {\"point\": [0, 0, 0], \"normal\": [0, 0, 1]}}"), 81},
        {PAIR("[1, 1]", "{\"plane\": {\"point\": [0, 0, 0], \"normal\": [0, 0, -1]}}"), 0},
        {PAIR("[1, 1]", "{\"plane\": {\"point\": [0, 0, 1], \"normal\": [0, 0, 1]}}"), 0},
        {PAIR("[1, 1]", "{\"floor\": {\"height\": 0}}"), 45},
        {PAIR("[1, 1]", "{\"floor\": {\"height\": 0.01}}"), 0},
        {PAIR("[1, 1]", "{\"box\": {\"centre\": [0, 0, 1], \"size\": [0.01, 0.01, 1]}}"), 80},
        {PAIR("[1, 1]", "{\"box\": {\"centre\": [0, 0, -1], \"size\": [2, 2, 2]}}"), 81},
        {PAIR("[1, 1]", "{\"box\": {\"centre\": [0, 0, 1], \"size\": [3, 3, 0.1]}}"), 0},
        {PAIR("[1, 1]", "{\"capsule\": {\"from\": [-2, 0, 1], \"to\": [2, 0, 1],"
                        " \"radius\": 0.01}}"),
         72},
    };
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct looker looker;
        struct cs_viewpoint_force viewpoint_force = front;
        viewpoint_force.body = 0;
        looker_open(&looker, rows[k].scene);
        ck_assert_msg(look(&looker, &viewpoint_force) == rows[k].seen, "obstacle %zu", k);
        looker_close(&looker);
    }
}

/* What lies on a triangle, of another body at that, is seen on it from either side. */
TEST(what_lies_on_a_surface_is_seen) {
    struct looker looker;
    looker_open(&looker, PAIR("[1, 1]", ""));
    for (int k = 0; k < 50; k++) {
        struct cs_viewpoint_force viewpoint_force = front;
        viewpoint_force.viewpoint.eye[2] *= k % 2 ? 1 : -1;
        for (size_t i = 0; i < looker.sheet.n; i++) {
            const double x = 0.4 * draw(), y = 0.4 * draw();
            const double at[3] = {x, y, 0.3 * x - 0.2 * y};
            for (size_t c = 0; c < 3 && i >= 81; c++)
                looker.sheet.x[c * looker.sheet.n + i] = at[c];
            if (i < 81)
                looker.sheet.x[2 * looker.sheet.n + i] =
                    0.3 * looker.sheet.x[i] - 0.2 * looker.sheet.x[looker.sheet.n + i];
        }
        for (int c = 0; c < 3; c++)
            viewpoint_force.viewpoint.eye[c] += draw();
        viewpoint_force.body = 1;
        ck_assert_uint_eq(look(&looker, &viewpoint_force), 81);
    }
    looker_close(&looker);
}

/* A ground of two triangles that go on behind the eye hides what is below it. */
TEST(ground_reaches_behind_the_eye) {
    struct looker looker;
    struct cs_viewpoint_force viewpoint_force = front;
    looker_open(&looker, "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [20, 20],"
                         " \"start\": \"flat\", \"place\": {\"translate\": [0, -0.5, 0]}},"
                         " \"mass\": {\"total\": 1}},"
                         " {\"cloth\": {\"grid\": [9, 9], \"size\": [2, 2], \"place\":"
                         " {\"translate\": [0, 0, -2]}}, \"mass\": {\"total\": 1}}]}");
    viewpoint_force.viewpoint.eye[2] = 0;
    viewpoint_force.viewpoint.target[2] = -1;
    viewpoint_force.body = 1;
    ck_assert_uint_eq(look(&looker, &viewpoint_force), 7 * 9);
    looker_close(&looker);
}

/* Rectangles are closed; left and top are where the picture has them; a picture twice as wide
 * shows twice as much. */
TEST(rectangle_is_of_the_picture) {
    static const struct {
        double rectangle[4], aspect, fov;
        uint32_t seen;
    } rows[] = {{{0.375, 0.375, 0.625, 0.625}, 1, 90, 81},
                {{0.5, 0.375, 0.625, 0.625}, 1, 90, 45},
                {{0.5, 0.375, 0.625, 0.5}, 1, 90, 25},
                {{0.5, 0.5, 0.53125, 0.625}, 1, 90, 10},
                {{0.5, 0, 0.5625, 0.5}, 2, 90, 25},
                {{0, 0, 0.4, 1}, 2, 90, 0},
                {{0, 0, 0.3, 1}, 1, 90, 0},
                {{0, 0, 0.3, 1}, 1, 40, 18}};
    struct looker looker;
    looker_open(&looker, PAIR("[1, 1]", ""));
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct cs_viewpoint_force viewpoint_force = front;
        memcpy(viewpoint_force.rectangle, rows[k].rectangle, sizeof viewpoint_force.rectangle);
        viewpoint_force.viewpoint.aspect = rows[k].aspect;
        viewpoint_force.viewpoint.fov = rows[k].fov;
        const uint32_t seen = look(&looker, &viewpoint_force);
        ck_assert_msg(seen == rows[k].seen, "%zu: %u", k, seen);
        /* the ones to the right and above */
        ck_assert(k != 2 || (looker.seen[4] && looker.seen[8] && !looker.seen[3]));
    }
    looker_close(&looker);
}

TEST(view_is_a_tangent) {
    for (double fov = 1; fov <= 170; fov += 0.5) {
        struct cs_viewpoint_force viewpoint_force = front;
        struct cs_visibility_query visibility;
        viewpoint_force.viewpoint.fov = fov;
        cs_visibility_query_make(&visibility, &viewpoint_force);
        const double slope = tan(fov * (3.14159265358979323846 / 360));
        ck_assert_msg(fabs(visibility.high[1] / slope - 1) < 1e-14, "%g degrees", fov);
        ck_assert(visibility.low[1] == -visibility.high[1] &&
                  visibility.high[0] == visibility.high[1]);
        ck_assert(visibility.axes[0][0] == 1 && visibility.axes[1][1] == 1 &&
                  visibility.axes[2][2] == -1);
    }
}

/* After a blow-up: what is not finite is not seen, and hides nothing. */
TEST(places_that_are_not_finite) {
    struct looker looker;
    looker_open(&looker, PAIR("[2, 2]", ""));
    for (size_t i = 0; i < 81; i++)
        looker.sheet.x[i % 3 * looker.sheet.n + i] = i % 2 ? (double)NAN : (double)INFINITY;
    looker.sheet.x[90] = -1e308;
    ck_assert_uint_eq(look(&looker, &front), 80);
    looker_close(&looker);
}
