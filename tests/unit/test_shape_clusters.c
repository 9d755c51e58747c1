/* Parts of matched bodies: every particle in one at least, boxes, no dependence on placement.
 */
#include "mesh/trimesh.h"
#include "model/system/shape_clusters.h"
#include "scene/body_keys.h"
#include "sheet.h"

static void read_body(struct cs_scene *scene, const char *shape, const char *matching) {
    char text[1024];
    struct cs_error error = {0};
    snprintf(text, sizeof text,
             "{\"bodies\": [{%s, \"mass\": {\"total\": 1}, \"shape_matching\": {%s}}]}", shape,
             matching);
    cs_scene_read_text(scene, "scene.json", text, strlen(text), NULL, 0, &error);
    UNIT_ASSERT_OK(&error);
}

static const struct cs_shape_clusters *parts_of(const struct cs_scene *scene) {
    return cs_scene_bodies(scene)->shape_matching.parts;
}

TEST(one_part_is_the_body) {
    struct cs_scene scene;
    read_body(&scene, "\"cloth\": {\"grid\": [3, 2]}", "");
    const struct cs_shape_clusters *parts = parts_of(&scene);
    ck_assert_uint_eq(parts->n, 1);
    ck_assert_uint_eq(parts->begin[0], 0);
    ck_assert_uint_eq(parts->begin[1], 6);
    for (uint32_t i = 0; i < 6; i++)
        ck_assert_uint_eq(parts->items[i], i);
    cs_scene_finish(&scene);
}

/* a strip of 8 in two parts of four: the boxes have sides of 3 cells, and a third of that on
 * either side takes one more column in */
TEST(parts_overlap_by_a_share_of_their_side) {
    static const struct {
        const char *overlap;
        uint32_t items[2][8], n[2];
    } rows[] = {
        {"0", {{0, 1, 2, 3}, {4, 5, 6, 7}}, {4, 4}},
        {"0.32", {{0, 1, 2, 3}, {4, 5, 6, 7}}, {4, 4}},
        {"0.34", {{0, 1, 2, 3, 4}, {3, 4, 5, 6, 7}}, {5, 5}},
        {"2", {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}}, {8, 8}},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        struct cs_scene scene;
        char matching[64];
        snprintf(matching, sizeof matching, "\"clusters\": 2, \"overlap\": %s",
                 rows[r].overlap);
        read_body(&scene, "\"cloth\": {\"grid\": [8, 1], \"size\": [7, 1]}", matching);
        const struct cs_shape_clusters *parts = parts_of(&scene);
        for (uint32_t k = 0; k < 2; k++) {
            ck_assert_uint_eq(parts->begin[k + 1] - parts->begin[k], rows[r].n[k]);
            for (uint32_t i = 0; i < rows[r].n[k]; i++)
                ck_assert_uint_eq(parts->items[parts->begin[k] + i], rows[r].items[k][i]);
        }
        cs_scene_finish(&scene);
    }
}

/* Without overlap the parts of a mesh part it: sizes as even as the number allows. Particles on
 * the plane of a cut lie in both boxes. */
TEST(every_particle_has_a_part) {
    for (int64_t clusters = 1; clusters <= 9; clusters++) {
        struct cs_scene scene;
        char matching[64];
        snprintf(matching, sizeof matching, "\"clusters\": %d, \"overlap\": 0", (int)clusters);
        read_body(&scene, "\"mesh\": {\"shape\": \"sphere\", \"detail\": 6}", matching);
        const struct cs_shape_clusters *parts = parts_of(&scene);
        uint32_t seen[1024] = {0}, n = 0;
        ck_assert_uint_eq(parts->n, clusters);
        for (uint32_t k = 0; k < parts->n; k++)
            for (uint32_t i = parts->begin[k]; i < parts->begin[k + 1]; i++) {
                ck_assert(i == parts->begin[k] || parts->items[i] > parts->items[i - 1]);
                ck_assert_uint_lt(parts->items[i], 1024);
                n += seen[parts->items[i]]++ == 0;
            }
        ck_assert_uint_eq(n, cs_scene_bodies(&scene)->geometry->n);
        for (uint32_t k = 0; k < parts->n; k++)
            ck_assert_uint_ge(parts->begin[k + 1] - parts->begin[k], n / clusters);
        cs_scene_finish(&scene);
    }
}

TEST(placement_does_not_matter) {
    struct cs_scene here, there;
    const char *matching = "\"clusters\": 5";
    read_body(&here, "\"mesh\": {\"shape\": \"limbs\", \"detail\": 10}", matching);
    read_body(
        &there,
        "\"mesh\": {\"shape\": \"limbs\", \"detail\": 10, \"place\": {\"translate\": [9, 1, "
        "2], \"rotate\": [1, 2, 3, 4]}}",
        matching);
    const struct cs_shape_clusters *a = parts_of(&here), *b = parts_of(&there);
    ck_assert_mem_eq(a->begin, b->begin, 6 * sizeof *a->begin);
    ck_assert_mem_eq(a->items, b->items, a->begin[5] * sizeof *a->items);
    cs_scene_finish(&here);
    cs_scene_finish(&there);
}

/* in the view, behind the particles of other bodies; only where they are asked for */
TEST(view_has_what_was_asked_for) {
    static const char scene[] =
        "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"total\": 1}},"
        " {\"cloth\": {\"grid\": [3, 1]}, \"mass\": {\"total\": 1}, \"shape_matching\":"
        " {\"alpha\": 0.25, \"beta\": 0.75, \"alpha_step\": 0.5}}]}";
    struct sheet without, with;
    sheet_open(&without, CS_NEED_SPRINGS, "%s", scene);
    ck_assert_ptr_null(without.system.view.cluster_begin);
    ck_assert_uint_eq(without.system.view.n_clusters, 0);
    ck_assert(!without.system.plan.rows[CS_FEATURE_CLUSTERS].built);
    sheet_close(&without);

    sheet_open(&with, CS_NEED_CLUSTERS, "%s", scene);
    const struct cs_view *view = &with.system.view;
    ck_assert_uint_eq(view->n_clusters, 1);
    ck_assert_uint_eq(view->cluster_begin[1], 3);
    for (uint32_t i = 0; i < 3; i++)
        ck_assert_uint_eq(view->cluster_items[i], 4 + i);
    ck_assert_double_eq(view->cluster_alpha[0], 0.25);
    ck_assert_double_eq(view->cluster_beta[0], 0.75);
    ck_assert_double_eq(view->cluster_step[0], 0.5);
    ck_assert_uint_eq(with.system.plan.rows[CS_FEATURE_CLUSTERS].bytes, 5 * 4 + 3 * 8);
    // the matched body's springs are left out, the other's are there
    ck_assert_uint_eq(with.system.springs.n, 6);
    // three in a row, 1/3 kg each, half a metre apart: m q^2 = 2 * 0.25/3
    ck_assert_double_eq_tol(cs_shape_clusters_energy(&with.system),
                            0.5 * 0.25 / 0.25 * (2 * 0.25 / 3), 1e-15);
    sheet_close(&with);
}
