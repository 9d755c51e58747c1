/* Particle normals of grids. */
#include "model/force/terms.h"
#include "sheet.h"

#define WIND "\"forces\": {\"wind\": {\"direction\": [1, 0, 0], \"strength\": 1}}"
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"size\": [3, 2]%s}, \"mass\": "           \
    "{\"total\": 1}}], " WIND "}"

/* a plane has one normal, at its border too: +z hanging, +y flat, and turned with the cloth */
TEST(plane_has_one_normal) {
    static const struct {
        const char *more;
        double normal[3];
    } rows[] = {{"", {0, 0, 1}},
                {", \"start\": \"flat\"", {0, 1, 0}},
                {", \"place\": {\"rotate\": [1, 1, 1, 1]}", {1, 0, 0}}};
    for (size_t k = 0; k < 3; k++) {
        struct sheet sheet;
        sheet_open(&sheet, 0, SCENE, 4, 3, rows[k].more);
        cs_normals_update(&sheet.system, sheet.x);
        for (size_t i = 0; i < 12; i++)
            SHEET_ASSERT_AT(&sheet, sheet.system.normals, i, rows[k].normal[0],
                            rows[k].normal[1], rows[k].normal[2], 1e-15);
        sheet_close(&sheet);
    }
}

/* (right - left) x (up - down) of a stirred sheet, the particle itself where there is no
 * neighbour (cloth thesis, eq. 4.6-4.9) */
TEST(normal_is_the_product_of_the_neighbours) {
    enum { COLUMNS = 5, ROWS = 4, N = COLUMNS * ROWS };
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE, COLUMNS, ROWS, "");
    sheet_stir(&sheet, 0.4, 0);
    cs_normals_update(&sheet.system, sheet.x);
    for (int i = 0; i < N; i++) {
        const int row = i / COLUMNS, column = i % COLUMNS;
        const int left = i - (column > 0), right = i + (column < COLUMNS - 1);
        const int up = i - COLUMNS * (row > 0), down = i + COLUMNS * (row < ROWS - 1);
        double a[3], b[3], n[3], length = 0;
        for (int c = 0; c < 3; c++) {
            a[c] = sheet.x[c * N + right] - sheet.x[c * N + left];
            b[c] = sheet.x[c * N + up] - sheet.x[c * N + down];
        }
        for (int c = 0; c < 3; c++) {
            n[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
            length += n[c] * n[c];
        }
        length = sqrt(length);
        SHEET_ASSERT_AT(&sheet, sheet.system.normals, i, n[0] / length, n[1] / length,
                        n[2] / length, 1e-14);
    }
    sheet_close(&sheet);
}

/* a row of particles spans nothing, nor does a sheet in one place: 0, not NAN */
TEST(nothing_spanned_is_no_normal) {
    struct sheet sheet;
    sheet_open(&sheet, 0, SCENE, 5, 1, "");
    cs_normals_update(&sheet.system, sheet.x);
    for (size_t i = 0; i < 5; i++)
        SHEET_ASSERT_AT(&sheet, sheet.system.normals, i, 0, 0, 0, 0);
    sheet_close(&sheet);
    sheet_open(&sheet, 0, SCENE, 3, 3, "");
    memset(sheet.x, 0, 27 * sizeof *sheet.x);
    cs_normals_update(&sheet.system, sheet.x);
    for (size_t i = 0; i < 9; i++)
        SHEET_ASSERT_AT(&sheet, sheet.system.normals, i, 0, 0, 0, 0);
    sheet_close(&sheet);
}

/* the second body's border is no neighbour of the first's */
TEST(bodies_are_apart) {
    struct sheet sheet;
    sheet_open(&sheet, 0,
               "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"total\": 1}},"
               " {\"cloth\": {\"grid\": [3, 2], \"start\": \"flat\", \"place\": {\"translate\":"
               " [9, 9, 9]}}, \"mass\": {\"total\": 1}}], " WIND "}");
    cs_normals_update(&sheet.system, sheet.x);
    for (size_t i = 0; i < 10; i++)
        SHEET_ASSERT_AT(&sheet, sheet.system.normals, i, 0, i < 4 ? 0 : 1, i < 4 ? 1 : 0,
                        1e-15);
    sheet_close(&sheet);
}

/* central differences with a step of 1e-6: truncation near 1e-11, rounding near 1e-10 */
TEST(derivative_is_that_of_the_normal) {
    enum { N = 12 };
    struct sheet sheet;
    double dx[3 * N], x[3 * N], slope[3 * N], dn[3];
    sheet_open(&sheet, 0, SCENE, 4, 3, "");
    sheet_stir(&sheet, 0.3, 0);
    for (size_t i = 0; i < 3 * N; i++)
        dx[i] = cos(1.3 * (double)i);
    for (int sign = 1; sign >= -1; sign -= 2) {
        for (size_t i = 0; i < 3 * N; i++)
            x[i] = sheet.x[i] + sign * 1e-6 * dx[i];
        cs_normals_update(&sheet.system, x);
        for (size_t i = 0; i < 3 * N; i++)
            slope[i] = sign > 0 ? sheet.system.normals[i]
                                : (slope[i] - sheet.system.normals[i]) / 2e-6;
    }
    cs_normals_update(&sheet.system, sheet.x);
    for (uint32_t i = 0; i < N; i++) {
        cs_normal_derivative(&sheet.system, sheet.system.bodies, i,
                             &(struct cs_eval){.x = sheet.x, .dx = dx}, dn);
        SHEET_ASSERT_AT(&sheet, slope, i, dn[0], dn[1], dn[2], 1e-8);
    }
    sheet_close(&sheet);
}
