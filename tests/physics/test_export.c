/* A run that is exported in two parts leaves the bytes of one that was exported at once, and
 * what is not asked for takes nothing. What the files say is read back by tests/cli/exports.py.
 */
#include "../unit/unit.h"
#include "base/file.h"
#include "fixture.h"
#include "export/export.h"

enum { SAMPLES = 4, ALL = CS_EXPORT_OBJ | CS_EXPORT_PC2 | CS_EXPORT_VTP | CS_EXPORT_NPZ };

/* a sheet, a thread and a ball; colliders of every round kind, of which one moves */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 3]}, \"mass\": {\"total\": 0.2}}, "              \
    "{\"cloth\": {\"grid\": [1, 4]}, \"mass\": {\"total\": 0.1}}, "                            \
    "{\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"place\": {\"translate\": "            \
    "[3, 0, 0]}}, \"mass\": {\"total\": 1}}], \"colliders\": [{\"floor\": {\"height\": "       \
    "-3}}, {\"sphere\": {\"centre\": [0, -2, 0], \"radius\": 0.3}}, {\"box\": {\"centre\": "   \
    "[9, 0, 0], \"size\": [0.3, 0.2, 0.1]}}, {\"capsule\": {\"from\": [9, 2, 0], \"to\": "     \
    "[9, 3, 0], \"radius\": 0.1}}], \"events\": [{\"at\": 0, \"move\": {\"collider\": 2, "     \
    "\"spin\": [0, 9, 0]}}]}"

/* Samples from..to of the run into a folder, as one part of it. */
static void export_part(struct fixture *bodies, const char *folder, uint32_t from,
                        uint32_t to) {
    struct cs_error error = {0};
    struct cs_export export = {0};
    const struct cs_export_settings settings = {.folder = folder,
                                                .formats = ALL,
                                                .values = CS_EXPORT_FORCE | CS_EXPORT_STRAIN,
                                                .frame_interval = 2,
                                                .n_samples_before = from};
    const struct cs_run *run = &bodies->session.run;
    cs_export_open(&export, &settings, bodies->system, &error);
    for (uint32_t k = from; k < to && !error.status; k++) {
        if (k > 0)
            fixture_frames(bodies, 2);
        cs_export_write_sample(&export, run->frame, run->t, run->x, run->v, &error);
        ck_assert_uint_eq(export.n_samples, k + 1);
    }
    cs_export_finish(&export, to < SAMPLES, &error);
    UNIT_ASSERT_OK(&error);
    cs_export_close(&export);
}

static void assert_same(const char *one, const char *other, const char *name) {
    struct cs_error error = {0};
    char path[2][512], *bytes[2];
    size_t length[2];
    const char *const folders[2] = {one, other};
    for (int k = 0; k < 2; k++) {
        snprintf(path[k], sizeof path[k], "%s/%s", folders[k], name);
        cs_file_read(path[k], 1 << 24, bytes + k, length + k, &error);
        UNIT_ASSERT_OK(&error);
    }
    ck_assert_msg(length[0] == length[1] && !memcmp(bytes[0], bytes[1], length[0]),
                  "%s differs", name);
    free(bytes[0]);
    free(bytes[1]);
}

TEST(parts_make_the_whole) {
    struct fixture bodies;
    ck_assert(!mkdir("whole", 0777) && !mkdir("parts", 0777));
    fixture_open(&bodies, "symplectic-euler", SCENE);
    fixture_start(&bodies);
    export_part(&bodies, "whole", 0, SAMPLES);
    fixture_close(&bodies);
    fixture_open(&bodies, "symplectic-euler", SCENE);
    fixture_start(&bodies);
    export_part(&bodies, "parts", 0, 3);
    export_part(&bodies, "parts", 3, SAMPLES);
    fixture_close(&bodies);

    /* OBJ and VTP a sample of bodies and colliders, two caches, run.pvd and run.npz */
    ck_assert_int_eq(unit_count_files("whole"), 4 * SAMPLES + 4);
    ck_assert_int_eq(unit_count_files("parts"), 4 * SAMPLES + 4);
    DIR *entries = opendir("whole");
    for (const struct dirent *entry; (entry = readdir(entries));)
        if (*entry->d_name != '.')
            assert_same("whole", "parts", entry->d_name);
    closedir(entries);
}

/* A file that holds less than its run says is not gone on with. */
TEST(what_is_short_is_refused) {
    static const char *const files[] = {"bodies.pc2", "colliders.pc2", "run.npz.part"};
    struct fixture bodies;
    ck_assert(!mkdir("short", 0777));
    fixture_open(&bodies, "symplectic-euler", SCENE);
    fixture_start(&bodies);
    export_part(&bodies, "short", 0, 2);
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        struct cs_error error = {0};
        struct cs_export export = {0};
        const struct cs_export_settings settings = {.folder = "short",
                                                    .formats =
                                                        k < 2 ? CS_EXPORT_PC2 : CS_EXPORT_NPZ,
                                                    .frame_interval = 2,
                                                    .n_samples_before = 2};
        char path[64], part[128];
        snprintf(path, sizeof path, "short/%s", files[k]);
        ck_assert(!truncate(path, 40));
        snprintf(part, sizeof part, "cannot continue \"%s\": it has 40 bytes, expected ", path);
        cs_export_open(&export, &settings, bodies.system, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, part);
        cs_export_close(&export);
        ck_assert(!truncate(path, 1 << 20));
    }
    fixture_close(&bodies);
}

TEST(nothing_asked_for_takes_nothing) {
    struct fixture bodies;
    struct cs_export export = {0};
    struct cs_error error = {0};
    const struct cs_export_settings settings = {.folder = "none", .frame_interval = 1};
    ck_assert(!mkdir("none", 0777));
    fixture_open(&bodies, "symplectic-euler", SCENE);
    fixture_start(&bodies);
    const struct cs_run *run = &bodies.session.run;
    cs_export_open(&export, &settings, bodies.system, &error);
    cs_export_write_sample(&export, 0, 0, run->x, run->v, &error);
    cs_export_finish(&export, false, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(export.arena.used, 0);
    ck_assert_uint_eq(export.n_samples, 0);
    cs_export_close(&export);
    fixture_close(&bodies);
    ck_assert_int_eq(unit_count_files("none"), 0);
}
