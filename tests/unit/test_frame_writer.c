/* Frames are written in order, each with its own pixels, and a failure stops them. */
#include "cli/run/frame_writer.h"
#include "unit.h"

enum { WIDTH = 40, HEIGHT = 30 };

static void draw(struct cs_image *image, uint32_t number) {
    ck_assert_uint_eq(image->width, WIDTH);
    ck_assert_uint_eq(image->height, HEIGHT);
    for (uint32_t i = 0; i < 3 * WIDTH * HEIGHT; i++)
        image->rgb[i] = (uint8_t)(i * number + number);
}

static void assert_frame(const char *path, uint32_t number) {
    struct cs_error error = {0};
    struct cs_image image;
    cs_png_read(path, &image, &error);
    UNIT_ASSERT_OK(&error);
    for (uint32_t i = 0; i < 3 * WIDTH * HEIGHT; i++)
        UNIT_ASSERT_OFTEN(image.rgb[i] == (uint8_t)(i * number + number));
    free(image.rgb);
}

/* Gives frames first..last; returns the number of the one whose giving failed, or 0. */
static uint32_t give(struct cs_frame_writer *frames, uint32_t first, uint32_t last,
                     struct cs_error *error) {
    for (uint32_t k = first; k <= last; k++) {
        char value[16];
        snprintf(value, sizeof value, "%u", k);
        const struct cs_png_text text = {"frame", value};
        draw(cs_frame_writer_acquire(frames), k);
        if (cs_frame_writer_submit(frames, k, &text, 1, error))
            return k;
        memset(value, 'x', sizeof value);
    }
    return 0;
}

static void write_and_compare(const char *folder, bool threaded) {
    struct cs_error error = {0};
    struct cs_frame_writer *frames;
    double seconds = -1;
    ck_assert_int_eq(mkdir(folder, 0777), 0);
    cs_frame_writer_create(
        folder, &(struct cs_frame_writer_settings){WIDTH, HEIGHT, false, 1, threaded}, &frames,
        &error);
    ck_assert_uint_eq(give(frames, 1, 20, &error), 0);
    ck_assert_int_eq(cs_frame_writer_finish(frames, &seconds, &error), CS_OK);
    ck_assert_double_gt(seconds, 0);
    ck_assert_int_eq(unit_count_files(folder), 20);
    for (uint32_t k = 1; k <= 20; k++) {
        char path[64];
        snprintf(path, sizeof path, "%s/frame_%05u.png", folder, k);
        assert_frame(path, k);
    }
    cs_frame_writer_destroy(frames);
}

TEST(frames_are_written_inline) {
    write_and_compare("inline", false);
}

TEST(frames_are_written_by_the_worker) {
    write_and_compare("worker", true);
}

TEST(destroy_writes_what_is_queued) {
    struct cs_error error = {0};
    struct cs_frame_writer *frames;
    ck_assert_int_eq(mkdir("queued", 0777), 0);
    cs_frame_writer_create("queued",
                           &(struct cs_frame_writer_settings){WIDTH, HEIGHT, false, 1, true},
                           &frames, &error);
    ck_assert_uint_eq(give(frames, 99998, 100001, &error), 0);
    cs_frame_writer_destroy(frames);
    ck_assert_int_eq(unit_count_files("queued"), 4);
    assert_frame("queued/frame_99998.png", 99998);
    assert_frame("queued/frame_100001.png", 100001);
    cs_frame_writer_destroy(NULL);
}

/* Frame 3 cannot be written: 1 and 2 are there, none after it, and the caller hears of it. */
static void fail_at_third(const char *folder, bool threaded) {
    struct cs_error given = {0}, finished = {0};
    struct cs_frame_writer *frames;
    char path[64];
    double seconds;
    ck_assert_int_eq(mkdir(folder, 0777), 0);
    snprintf(path, sizeof path, "%s/frame_00003.png", folder);
    ck_assert_int_eq(mkdir(path, 0777), 0);
    cs_frame_writer_create(
        folder, &(struct cs_frame_writer_settings){WIDTH, HEIGHT, false, 1, threaded}, &frames,
        &given);
    const uint32_t failed = give(frames, 1, 50, &given);
    /* the worker is at most two frames behind */
    ck_assert_uint_ge(failed, 3);
    ck_assert_uint_le(failed, threaded ? 5 : 3);
    UNIT_ASSERT_FAILED(&given, CS_ERR_FILE, "frame_00003.png\": it is a folder");
    cs_frame_writer_finish(frames, &seconds, &finished);
    UNIT_ASSERT_FAILED(&finished, CS_ERR_FILE, "frame_00003.png\": it is a folder");
    cs_frame_writer_destroy(frames);
    ck_assert_int_eq(unit_count_files(folder), 3);
}

TEST(failure_stops_frames) {
    fail_at_third("bad-inline", false);
    fail_at_third("bad-worker", true);
}

/* the last frame has no later give that could tell */
TEST(finish_tells_of_the_last_frame) {
    struct cs_error error = {0};
    struct cs_frame_writer *frames;
    double seconds;
    cs_frame_writer_create("no-such-folder",
                           &(struct cs_frame_writer_settings){WIDTH, HEIGHT, false, 1, true},
                           &frames, &error);
    give(frames, 1, 1, &error);
    error = (struct cs_error){0};
    cs_frame_writer_finish(frames, &seconds, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "cannot write \"no-such-folder/frame_00001.png\"");
    cs_frame_writer_destroy(frames);
}
