/* Triangles and edges of all bodies: counted by Euler's formula, each edge once, its triangles
 * those that have both its ends. */
#include "model/system/surfaces.h"
#include "sheet.h"

#define GRID "{\"cloth\": {\"grid\": [%d, %d]}, \"mass\": {\"total\": 1}}"
#define MESH                                                                                   \
    "{\"mesh\": {\"shape\": \"%s\", \"detail\": 4, \"place\": {\"translate\": [3, 0, 0]}}, "   \
    "\"mass\": {\"total\": 1}}"

static const struct cs_surfaces *open(struct sheet *sheet, const char *bodies) {
    struct cs_error error = {0};
    sheet_open(sheet, 0, "{\"bodies\": [%s]}", bodies);
    ck_assert_ptr_null(sheet->system.surfaces);
    cs_surfaces_build(&sheet->system, &error);
    UNIT_ASSERT_OK(&error);
    return sheet->system.surfaces;
}

static bool has(const uint32_t *corners, uint32_t i) {
    return corners[0] == i || corners[1] == i || corners[2] == i;
}

/* owners of each edge are all triangles with both ends, ascending */
static void check_owners(const struct cs_surfaces *s) {
    for (uint32_t e = 0; e < s->n_edges; e++) {
        uint32_t n = 0, expected[2] = {CS_NO_TRIANGLE, CS_NO_TRIANGLE};
        for (uint32_t t = 0; t < s->n_triangles; t++)
            if (has(s->triangles + 3 * t, s->edges[2 * e]) &&
                has(s->triangles + 3 * t, s->edges[2 * e + 1])) {
                UNIT_ASSERT_OFTEN(n < 2);
                expected[n++] = t;
            }
        UNIT_ASSERT_OFTEN(!memcmp(expected, s->edge_triangles + 2 * e, sizeof expected));
    }
}

/* ascending: so none is there twice */
static void check_order(const struct cs_surfaces *s) {
    for (uint32_t e = 0; e < s->n_edges; e++) {
        const uint32_t *edge = s->edges + 2 * e;
        ck_assert_uint_lt(edge[0], edge[1]);
        if (e && cs_surfaces_body(s->first_edge, s->n_bodies, e) ==
                     cs_surfaces_body(s->first_edge, s->n_bodies, e - 1))
            ck_assert(edge[-2] < edge[0] || (edge[-2] == edge[0] && edge[-1] < edge[1]));
    }
}

/* vertices - edges + triangles: 1 of a disc, 2 of a sphere, 0 of a torus */
TEST(surfaces_obey_euler) {
    struct sheet sheet;
    char bodies[1024];
    snprintf(bodies, sizeof bodies, GRID ", " MESH ", " MESH ", " GRID, 5, 4, "sphere", "torus",
             2, 2);
    const struct cs_surfaces *s = open(&sheet, bodies);
    static const int64_t euler[4] = {1, 2, 0, 1};
    ck_assert_uint_eq(s->n_bodies, 4);
    for (uint32_t b = 0; b < 4; b++)
        ck_assert_int_eq((int64_t)sheet.system.bodies[b].count -
                             (s->first_edge[b + 1] - s->first_edge[b]) +
                             (s->first_triangle[b + 1] - s->first_triangle[b]),
                         euler[b]);
    check_owners(s);
    check_order(s);
    sheet_close(&sheet);
}

/* a rope has edges in no triangle, a particle has nothing; numbers are those of the system */
TEST(ropes_have_edges_alone) {
    struct sheet sheet;
    char bodies[1024];
    snprintf(bodies, sizeof bodies, GRID ", " GRID ", " GRID, 1, 1, 4, 1, 1, 3);
    const struct cs_surfaces *s = open(&sheet, bodies);
    static const uint32_t edges[] = {1, 2, 2, 3, 3, 4, 5, 6, 6, 7};
    ck_assert_uint_eq(s->n_triangles, 0);
    ck_assert_uint_eq(s->n_edges, 5);
    ck_assert_mem_eq(s->edges, edges, sizeof edges);
    check_owners(s);
    for (uint32_t e = 0; e < 5; e++)
        ck_assert_uint_eq(cs_surfaces_body(s->first_edge, 3, e), e < 3 ? 1 : 2);
    sheet_close(&sheet);
}
