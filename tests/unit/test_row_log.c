/* A log of rows goes on where a record was made, and not after other rows. */
#include "base/file.h"
#include "cli/run/row_log.h"
#include "unit.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void add(struct cs_row_log *log, const char *row, struct cs_error *error) {
    struct cs_text text = {0};
    cs_text_add(&text, "%s", row);
    cs_row_log_add(log, &text, error);
}

static void assert_file(const char *path, const char *expected) {
    struct cs_error error = {0};
    char *bytes;
    size_t length;
    ck_assert(!cs_file_read(path, 1000, &bytes, &length, &error));
    ck_assert_str_eq(bytes, expected);
    free(bytes);
}

/* Writes two rows, a record, and a third row; the log stays open. */
static void write_three(struct cs_row_log *log, struct cs_serialiser *serialiser) {
    struct cs_error error = {0};
    cs_row_log_create(log, "log", &error);
    add(log, "a\n", &error);
    add(log, "bc\n", &error);
    cs_row_log_record(log, serialiser);
    add(log, "d\n", &error);
    UNIT_ASSERT_OK(&error);
    // a row is there before the file is closed
    assert_file("log.part", "a\nbc\nd\n");
}

/* Loads the record, and resumes. */
static enum cs_status resume(struct cs_row_log *log, struct cs_serialiser *serialiser,
                             struct cs_error *error) {
    *log = (struct cs_row_log){0};
    serialiser->is_reading = true;
    serialiser->position = 0;
    cs_row_log_record(log, serialiser);
    ck_assert(!serialiser->failed);
    return cs_row_log_resume(log, "log", error);
}

TEST(a_killed_log_is_cut_to_its_record) {
    struct cs_row_log killed, log;
    struct cs_serialiser serialiser = {0};
    struct cs_error error = {0};
    write_three(&killed, &serialiser);
    fclose(killed.file);
    resume(&log, &serialiser, &error);
    add(&log, "e\n", &error);
    cs_row_log_finish(&log, &error);
    UNIT_ASSERT_OK(&error);
    assert_file("log", "a\nbc\ne\n");
    ck_assert(access("log.part", F_OK));
    cs_serialiser_finish(&serialiser);
}

TEST(a_whole_log_stays_until_the_end) {
    struct cs_row_log log;
    struct cs_serialiser serialiser = {0};
    struct cs_error error = {0};
    write_three(&log, &serialiser);
    cs_row_log_finish(&log, &error);
    resume(&log, &serialiser, &error);
    add(&log, "f\n", &error);
    assert_file("log", "a\nbc\nd\n");
    cs_row_log_finish(&log, &error);
    UNIT_ASSERT_OK(&error);
    assert_file("log", "a\nbc\nf\n");
    cs_serialiser_finish(&serialiser);
}

TEST(changed_rows_are_refused) {
    static const char *const changed[] = {"a\nbd\n", "a\nb", "ab\nc\n", ""};
    struct cs_row_log log;
    struct cs_serialiser serialiser = {0};
    write_three(&log, &serialiser);
    ck_assert(!cs_row_log_remove(&log, &(struct cs_error){0}));
    ck_assert(access("log.part", F_OK));
    for (size_t k = 0; k < sizeof changed / sizeof *changed; k++) {
        struct cs_error error = {0};
        cs_file_write("log", changed[k], strlen(changed[k]), &error);
        UNIT_ASSERT_OK(&error);
        ck_assert_int_eq(resume(&log, &serialiser, &error), CS_ERR_FILE);
        assert_file("log", changed[k]);
    }
    cs_serialiser_finish(&serialiser);
}

TEST(rows_are_copied) {
    struct cs_row_log log;
    struct cs_error error = {0};
    char *bytes;
    size_t length;
    cs_row_log_create(&log, NULL, &error);
    for (int k = 0; k < 5000; k++)
        add(&log, "0123456789\n", &error);
    FILE *out = open_memstream(&bytes, &length);
    cs_row_log_copy(&log, log.length - 2, out, &error);
    fclose(out);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(length, 5000 * 11 - 2);
    ck_assert(!strncmp(bytes + length - 10, "\n012345678", 10));
    free(bytes);
    ck_assert(!cs_row_log_remove(&log, &error));
}

TEST(a_file_that_is_not_its_own_is_not_written) {
    struct cs_row_log first, log;
    struct cs_error error = {0}, refused = {0};
    cs_file_write("victim", "old\n", 4, &error);
    ck_assert_int_eq(symlink("victim", "log.part"), 0);
    cs_row_log_create(&log, "log", &refused);
    UNIT_ASSERT_FAILED(&refused, CS_ERR_FILE, "\"log.part\": it is a link");
    ck_assert_int_eq(unlink("log.part"), 0);
    ck_assert_int_eq(link("victim", "log.part"), 0);
    refused = (struct cs_error){0};
    cs_row_log_create(&log, "log", &refused);
    UNIT_ASSERT_FAILED(&refused, CS_ERR_FILE, "it has 2 names, expected one");
    ck_assert_int_eq(unlink("log.part"), 0);
    // the lock belongs to an open file, so that one process can play both
    cs_row_log_create(&first, "log", &error);
    add(&first, "a\n", &error);
    refused = (struct cs_error){0};
    cs_row_log_create(&log, "log", &refused);
    UNIT_ASSERT_FAILED(&refused, CS_ERR_FILE, "another process is writing it");
    cs_row_log_finish(&first, &error);
    UNIT_ASSERT_OK(&error);
    assert_file("log", "a\n");
    assert_file("victim", "old\n");
}

TEST(a_stream_gets_rows_and_stays) {
    struct cs_row_log log;
    struct cs_error error = {0};
    struct stat info;
    char found[8] = "";
    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    // opened for both, so that it has a reader
    const int pipe = open("pipe", O_RDWR);
    cs_row_log_create(&log, "pipe", &error);
    add(&log, "a\n", &error);
    ck_assert_int_eq(read(pipe, found, sizeof found), 2);
    ck_assert_str_eq(found, "a\n");
    cs_row_log_finish(&log, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert(!stat("pipe", &info) && S_ISFIFO(info.st_mode) && access("pipe.part", F_OK));
    close(pipe);
}
