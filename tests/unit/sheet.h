/* sheet.h - a scene in JSON made into a system, for the tests of the model. */
#ifndef SHEET_H
#define SHEET_H

#include "model/plan.h"
#include "scene/file/scene_read.h"
#include "scene/scene.h"
#include "unit.h"

#include <math.h>
#include <stdarg.h>

/* Must stay where it is between open and close: the system borrows the scene. */
struct sheet {
    struct cs_scene scene;
    struct cs_system system;
    size_t n;      /* particles */
    double *x, *v; /* (3,n) each: the state */
};

/* Reads the scene and builds its system for a method with these needs (enum cs_need). */
__attribute__((format(printf, 3, 4))) static inline void
sheet_open(struct sheet *sheet, uint32_t needs, const char *format, ...) {
    char text[16384];
    struct cs_error error = {0};
    struct cs_plan plan;
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    ck_assert_int_lt(length, (int)sizeof text);
    cs_scene_read_text(&sheet->scene, "scene.json", text, (size_t)length, NULL, 0, &error);
    UNIT_ASSERT_OK(&error);
    cs_plan_make(&plan, &sheet->scene, needs, false);
    cs_system_build(&sheet->system, &sheet->scene, &plan, &error);
    UNIT_ASSERT_OK(&error);
    sheet->n = sheet->system.view.n;
    sheet->x = sheet->system.state;
    sheet->v = sheet->x + 3 * sheet->n;
}

static inline void sheet_close(struct sheet *sheet) {
    cs_system_finish(&sheet->system);
    cs_scene_finish(&sheet->scene);
}

/* Moves the free particles smoothly, up to `place` m and `speed` m/s. */
static inline void sheet_stir(struct sheet *sheet, double place, double speed) {
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < sheet->n; i++) {
            const double free = sheet->system.inv_mass[i] > 0;
            const double phase = 1.7 * (double)i + 2.3 * (double)c;
            sheet->x[c * sheet->n + i] += free * place * sin(phase);
            sheet->v[c * sheet->n + i] += free * speed * cos(2.1 * phase);
        }
}

/* Puts particle i at (x, y, z) with velocity (vx, vy, vz). */
static inline void sheet_put(struct sheet *sheet, size_t i, double x, double y, double z,
                             double vx, double vy, double vz) {
    const double values[6] = {x, y, z, vx, vy, vz};
    for (size_t c = 0; c < 6; c++)
        sheet->x[c * sheet->n + i] = values[c];
}

/* fails unless particle i of an array (3,n) is within bound of (x, y, z) */
#define SHEET_ASSERT_AT(sheet, array, i, x_, y_, z_, bound)                                    \
    do {                                                                                       \
        const double *at_ = (array) + (i), expected_[3] = {x_, y_, z_};                        \
        for (size_t c_ = 0; c_ < 3; c_++)                                                      \
            ck_assert_msg(fabs(at_[c_ * (sheet)->n] - expected_[c_]) <= (bound),               \
                          "component %zu: found %.17g, expected %.17g", c_,                    \
                          at_[c_ * (sheet)->n], expected_[c_]);                                \
    } while (0)

#endif
