/* Tables of calls from which one is left out: what may be NULL is not called, and what may not
 * is told where the table is taken up. */
#include "../unit/unit.h"
#include "draw/render.h"
#include "fixture.h"
#include "export/export.h"
#include "scene/collider.h"

static unsigned added;

static enum cs_status add(void *state, const struct cs_export_source *source,
                          const struct cs_export_sample *sample, struct cs_error *error) {
    (void)state, (void)source, (void)sample;
    added++;
    return error->status;
}

/* A format with the one call that it must have, in the place of OBJ in the program's own loops.
 */
static struct cs_export_writer bare = {.ending = "obj", .size = 1, .add = add};
#define cs_export_obj bare
#include "../../src/export/export.c"
#include "scene/collider_keys.h"

#define SCENE "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3]}, \"mass\": {\"total\": 0.2}}]}"

static void export_two(void) {
    const struct cs_export_settings settings = {
        .folder = ".", .formats = CS_EXPORT_OBJ, .frame_interval = 1};
    struct cs_error error = {0};
    struct cs_export export;
    struct fixture sheet;
    fixture_open(&sheet, "symplectic-euler", SCENE);
    fixture_start(&sheet);
    const struct cs_run *run = &sheet.session.run;
    cs_export_open(&export, &settings, sheet.system, &error);
    for (uint32_t k = 0; k < 2; k++)
        cs_export_write_sample(&export, k, run->t, run->x, run->v, &error);
    cs_export_sync(&export, &error);
    cs_export_finish(&export, false, &error);
    cs_export_close(&export);
    fixture_close(&sheet);
    UNIT_ASSERT_OK(&error);
}

TEST(a_writer_needs_no_call_but_add) {
    export_two();
    ck_assert_uint_eq(added, 2);
    bare.add = NULL;
    UNIT_ASSERT_ABORTS(export_two());
}

TEST(a_shape_without_a_call_aborts) {
    static const struct cs_shape *const shapes[] = {
#define X(name, keys, text) &cs_shape_##name,
        CS_SHAPE_LIST(X)
#undef X
    };
    static const size_t calls[] = {
        offsetof(struct cs_shape, pose), offsetof(struct cs_shape, distance),
        offsetof(struct cs_shape, smooth), offsetof(struct cs_shape, meets_line),
        offsetof(struct cs_shape, triangles)};
    for (size_t k = 0; k < LENGTH(shapes); k++)
        for (size_t c = 0; c < LENGTH(calls); c++) {
            struct cs_shape shape = *shapes[k];
            memset((char *)&shape + calls[c], 0, sizeof shape.pose);
            UNIT_ASSERT_ABORTS(cs_shape_assert(&shape));
        }
}

/* The folder has a render-osmesa.so without `paint`. */
TEST(a_renderer_without_a_call_is_refused) {
    const struct cs_renderer *renderer;
    struct cs_error error = {0};
    cs_renderer_open(getenv("HALF_RENDERER"), CS_RENDERER_OSMESA, &renderer, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_MODULE, "lacks a call");
    ck_assert_ptr_null(renderer);
}
