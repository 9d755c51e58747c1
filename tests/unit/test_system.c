/* A scene made into arrays: masses, pins, velocities, spring list, and what is left out. */
#include "sheet.h"

#define BODY(mass, more)                                                                       \
    "{\"cloth\": {\"grid\": [3, 2], \"size\": [2, 1], \"velocity\": [1, 2, 3]}, \"mass\": "    \
    "{" mass "}" more "}"
#define SCENE(mass, more) "{\"bodies\": [" BODY(mass, more) "]}"

/* the four kinds, by particle of a grid of 3 x 2 and size 2 x 1 */
TEST(mass_is_by_particle_area_total_or_degree) {
    static const struct {
        const char *scene;
        double mass[6];
    } rows[] = {{SCENE("\"particle\": 0.3", ""), {0.3, 0.3, 0.3, 0.3, 0.3, 0.3}},
                {SCENE("\"total\": 0.3", ""), {0.05, 0.05, 0.05, 0.05, 0.05, 0.05}},
                {SCENE("\"areal_density\": 0.4", ""), {0.1, 0.2, 0.1, 0.1, 0.2, 0.1}},
                {SCENE("\"degree\": 0.1", ""), {0.4, 0.5, 0.4, 0.4, 0.5, 0.4}}};
    for (size_t k = 0; k < 4; k++) {
        struct sheet sheet;
        sheet_open(&sheet, 0, "%s", rows[k].scene);
        for (size_t i = 0; i < 6; i++) {
            ck_assert_double_eq_tol(sheet.system.mass[i], rows[k].mass[i], 1e-15);
            ck_assert_double_eq(sheet.system.inv_mass[i], 1 / sheet.system.mass[i]);
        }
        sheet_close(&sheet);
    }
}

/* a pinned particle keeps its mass, and has no inverse mass and no velocity */
TEST(pinned_particles_rest) {
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE("\"particle\": 0.5", ", \"pins\": [5, 1, 5]"));
    ck_assert_uint_eq(sheet.system.n_pinned, 2);
    ck_assert_uint_eq(sheet.system.pinned[0], 1);
    ck_assert_uint_eq(sheet.system.pinned[1], 5);
    for (size_t i = 0; i < 6; i++) {
        const bool pinned = i == 1 || i == 5;
        ck_assert_double_eq(sheet.system.mass[i], 0.5);
        ck_assert_double_eq(sheet.system.inv_mass[i], pinned ? 0 : 2);
        SHEET_ASSERT_AT(&sheet, sheet.v, i, pinned ? 0 : 1, pinned ? 0 : 2, pinned ? 0 : 3, 0);
    }
    sheet_close(&sheet);
}

TEST(view_shows_the_arrays) {
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE("\"particle\": 0.5", ""));
    const struct cs_view *view = &sheet.system.view;
    ck_assert_uint_eq(view->size, sizeof *view);
    ck_assert_uint_eq(view->n, 6);
    ck_assert_ptr_eq(view->mass, sheet.system.mass);
    ck_assert_ptr_eq(view->inv_mass, sheet.system.inv_mass);
    ck_assert_ptr_ne(view->start, sheet.x);
    ck_assert_int_eq(memcmp(view->start, sheet.x, 18 * sizeof(double)), 0);
    sheet_close(&sheet);
}

TEST(bodies_follow_each_other) {
    struct sheet sheet;
    sheet_open(&sheet, 0,
               "{\"bodies\": [" BODY("\"particle\": 1",
                                     "") ", {\"cloth\": {\"grid\": [2, 4]},"
                                         " \"mass\": {\"particle\": 2}, \"pins\": [0]}]}");
    const struct cs_body_range *second = sheet.system.bodies + 1;
    ck_assert_uint_eq(sheet.n, 14);
    ck_assert_uint_eq(second->first, 6);
    ck_assert_uint_eq(second->count, 8);
    ck_assert_uint_eq(second->columns, 2);
    ck_assert_uint_eq(second->rows, 4);
    ck_assert_double_eq(sheet.system.mass[5], 1);
    ck_assert_double_eq(sheet.system.mass[6], 2);
    ck_assert_uint_eq(sheet.system.n_pinned, 1);
    ck_assert_uint_eq(sheet.system.pinned[0], 6);
    sheet_close(&sheet);
}

/* the list says what the runs say, spring by spring */
TEST(spring_list_is_the_runs) {
    struct sheet sheet;
    sheet_open(
        &sheet, CS_NEED_SPRINGS,
        "{\"bodies\": [" BODY(
            "\"particle\": 1",
            "") ", {\"cloth\": {\"grid\": [4, 4]},"
                " \"mass\": {\"particle\": 2}, \"springs\": {\"stretch\": 7, \"damping\": 0.3,"
                " \"damping_model\": \"relative\"}}]}");
    const struct cs_view *view = &sheet.system.view;
    ck_assert_uint_eq(view->n_springs, sheet.system.springs.n);
    for (uint32_t r = 0; r < sheet.system.springs.n_runs; r++) {
        const struct cs_spring_run *run = sheet.system.springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const size_t s = run->first + i;
            ck_assert_uint_eq(view->ends[2 * s], run->first_a + i);
            ck_assert_uint_eq(view->ends[2 * s + 1], run->first_b + i);
            ck_assert_double_eq(view->length[s], run->length);
            ck_assert_double_eq(view->stiffness[s], run->stiffness);
            ck_assert_double_eq(view->damping[s], run->damping);
            ck_assert_uint_eq(view->kind[s], CS_PART_STRETCH << run->kind);
            ck_assert_uint_eq(view->axial[s], run->axial);
        }
    }
    sheet_close(&sheet);
}

/* no spring joins particles of one colour; the lists have each particle and each end once */
TEST(colours_part_the_springs) {
    struct sheet sheet;
    sheet_open(&sheet, CS_NEED_SPRINGS | CS_NEED_COLOURS,
               "{\"bodies\": [" BODY(
                   "\"particle\": 1",
                   "") ", {\"cloth\": {\"grid\": [7, 5]}, \"mass\": {\"particle\": 1}}]}");
    const struct cs_view *view = &sheet.system.view;
    uint32_t colour[64] = {0}, seen = 0, ends = 0;
    ck_assert_uint_le(view->n, 64);
    for (uint32_t c = 0; c < view->n_colours; c++)
        for (uint32_t k = view->colour_begin[c]; k < view->colour_begin[c + 1]; k++, seen++) {
            ck_assert(k == view->colour_begin[c] ||
                      view->colour_items[k - 1] < view->colour_items[k]);
            colour[view->colour_items[k]] = c + 1;
        }
    ck_assert_uint_eq(seen, view->n);
    for (uint32_t i = 0; i < view->n; i++)
        ck_assert_uint_gt(colour[i], 0);
    for (uint32_t s = 0; s < view->n_springs; s++)
        ck_assert_uint_ne(colour[view->ends[2 * s]], colour[view->ends[2 * s + 1]]);
    for (uint32_t i = 0; i < view->n; i++)
        for (uint32_t k = view->spring_begin[i]; k < view->spring_begin[i + 1]; k++, ends++) {
            const uint32_t s = view->spring_items[k];
            ck_assert(view->ends[2 * s] == i || view->ends[2 * s + 1] == i);
            ck_assert(k == view->spring_begin[i] || view->spring_items[k - 1] < s);
        }
    ck_assert_uint_eq(ends, 2 * view->n_springs);
    // a grid with stretch, shear and bend springs needs six at least; greedily few more
    ck_assert_uint_le(view->n_colours, 12);
    sheet_close(&sheet);

    sheet_open(&sheet, CS_NEED_SPRINGS, SCENE("\"particle\": 1", ""));
    ck_assert_ptr_null(sheet.system.view.colour_begin);
    sheet_close(&sheet);
}

/* no wind, no area law, no need for springs: no arrays */
TEST(what_is_not_needed_is_not_there) {
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE("\"particle\": 1", ""));
    ck_assert_ptr_null(sheet.system.normals);
    ck_assert_ptr_null(sheet.system.area);
    ck_assert_ptr_null(sheet.system.view.ends);
    ck_assert_ptr_null(sheet.system.view.length);
    ck_assert_ptr_null(sheet.system.view.stiffness);
    ck_assert_ptr_null(sheet.system.view.damping);
    ck_assert_uint_eq(sheet.system.view.n_springs, 0);
    ck_assert_uint_eq(sheet.system.n_terms, 2);
    const size_t least = sheet.system.arena.used;
    sheet_close(&sheet);

    sheet_open(&sheet, 0,
               "{\"bodies\": [" BODY("\"particle\": 1",
                                     "") "], \"forces\": {\"wind\": "
                                         "{\"direction\": [0, 0, 1], \"strength\": 3}}}");
    ck_assert_ptr_nonnull(sheet.system.normals);
    ck_assert_ptr_nonnull(sheet.system.area);
    ck_assert_double_eq(sheet.system.area[1], 0.5);
    ck_assert_uint_eq(sheet.system.n_terms, 3);
    ck_assert_uint_eq(sheet.system.arena.used, least + 4 * 6 * sizeof(double));
    sheet_close(&sheet);
}
