/* Files are written whole or not at all, and read whole or refused. */
#include "base/file.h"
#include "unit.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/time.h>

static void assert_content(const char *path, const char *expected) {
    struct cs_error error = {0};
    char *bytes;
    size_t length;
    cs_file_read(path, 1000, &bytes, &length, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(length, strlen(expected));
    ck_assert_str_eq(bytes, expected);
    free(bytes);
}

TEST(written_file_reads_back) {
    struct cs_error error = {0};
    cs_folder_create("alone", &error);
    cs_file_write("alone/a.txt", "hello", 5, &error);
    UNIT_ASSERT_OK(&error);
    assert_content("alone/a.txt", "hello");
    cs_file_write("alone/a.txt", "", 0, &error);
    UNIT_ASSERT_OK(&error);
    assert_content("alone/a.txt", "");
    ck_assert_int_eq(unit_count_files("alone"), 1);
}

TEST(target_is_untouched_until_finish) {
    struct cs_error error = {0};
    struct cs_file_out out;
    cs_file_write("b.txt", "old", 3, &error);
    ck_assert_int_eq(cs_file_create(&out, "b.txt", &error), CS_OK);
    fputs("new", out.file);
    fflush(out.file);
    assert_content("b.txt", "old");
    ck_assert_int_eq(cs_file_finish(&out, &error), CS_OK);
    assert_content("b.txt", "new");
    ck_assert_int_ne(access(out.temporary, F_OK), 0);
    cs_file_abandon(&out);
    assert_content("b.txt", "new");
}

TEST(abandoned_file_leaves_nothing) {
    struct cs_error error = {0};
    struct cs_file_out out, empty = {0};
    ck_assert_int_eq(cs_file_create(&out, "c.txt", &error), CS_OK);
    ck_assert_int_eq(access(out.temporary, F_OK), 0);
    cs_file_abandon(&out);
    cs_file_abandon(&out);
    cs_file_abandon(&empty);
    ck_assert_int_ne(access(out.temporary, F_OK), 0);
    ck_assert_int_ne(access("c.txt", F_OK), 0);
}

/* A link that waits under the temporary's name must not lead the write elsewhere. */
TEST(temporary_follows_no_link) {
    struct cs_error error = {0};
    struct cs_file_out out;
    char temporary[64];
    snprintf(temporary, sizeof temporary, "d.txt.tmp.%ld", (long)getpid());
    cs_file_write("victim.txt", "safe", 4, &error);
    ck_assert_int_eq(symlink("victim.txt", temporary), 0);
    ck_assert_int_eq(cs_file_create(&out, "d.txt", &error), CS_OK);
    ck_assert_str_eq(out.temporary, temporary);
    fputs("data", out.file);
    ck_assert_int_eq(cs_file_finish(&out, &error), CS_OK);
    assert_content("victim.txt", "safe");
    assert_content("d.txt", "data");
}

TEST(places_that_cannot_be_written_are_refused) {
    char *too_long = malloc(6000);
    memset(too_long, 'x', 5999);
    too_long[5999] = 0;
    ck_assert_int_eq(mknod("socket", S_IFSOCK | 0600, 0), 0);
    const struct {
        const char *path, *message;
    } rows[] = {{"none/a.txt", "cannot write \"none/a.txt\": No such file"},
                {".", "it is a folder"},
                {"socket", "it is not a regular file"},
                {"/proc/clothsim.txt", "cannot write"},
                {"", "without a name"},
                {too_long, "too long"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct cs_error error = {0};
        struct cs_file_out out;
        cs_file_create(&out, rows[i].path, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, rows[i].message);
        ck_assert_ptr_null(out.file);
    }
    free(too_long);
}

/* root may write everywhere, so that only others can see this */
TEST(read_only_folder_is_refused) {
    struct cs_error error = {0};
    if (geteuid() == 0)
        return;
    ck_assert_int_eq(mkdir("closed", 0555), 0);
    cs_file_write("closed/a.txt", "a", 1, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "Permission denied");
}

/* A full disk shows as a failed write, or only when the buffer is written out. */
TEST(full_disk_leaves_no_file) {
    for (size_t length = 10; length <= 100000; length *= 100) {
        struct cs_error error = {0};
        struct cs_file_out out;
        char *bytes = calloc(1, length);
        ck_assert_int_eq(cs_file_create(&out, "full.bin", &error), CS_OK);
        out.file = freopen("/dev/full", "wb", out.file);
        ck_assert_ptr_nonnull(out.file);
        fwrite(bytes, 1, length, out.file);
        cs_file_finish(&out, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "cannot write \"full.bin\"");
        ck_assert_int_ne(access("full.bin", F_OK), 0);
        ck_assert_int_ne(access(out.temporary, F_OK), 0);
        free(bytes);
    }
}

TEST(size_limit_keeps_the_old_file) {
    struct cs_error error = {0};
    static const char bytes[20000];
    cs_folder_create("limit", &error);
    cs_file_write("limit/limit.bin", "old", 3, &error);
    signal(SIGXFSZ, SIG_IGN);
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &(struct rlimit){9000, 9000}), 0);
    cs_file_write("limit/limit.bin", bytes, sizeof bytes, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "File too large");
    assert_content("limit/limit.bin", "old");
    ck_assert_int_eq(unit_count_files("limit"), 1);
}

TEST(what_is_no_small_regular_file_is_not_read) {
    struct cs_error made = {0};
    cs_file_write("six.txt", "123456", 6, &made);
    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    const struct {
        const char *path;
        size_t max;
        const char *message;
    } rows[] = {{"none.txt", 10, "cannot read \"none.txt\": No such file"},
                {".", 10, "it is a folder"},
                {"pipe", 10, "it is not a regular file"},
                {"/dev/zero", 10, "it is not a regular file"},
                {"six.txt", 5, "it has 6 bytes, expected at most 5"}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct cs_error error = {0};
        char *bytes = (char *)1;
        size_t length;
        cs_file_read(rows[i].path, rows[i].max, &bytes, &length, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, rows[i].message);
        ck_assert_ptr_null(bytes);
    }
    assert_content("six.txt", "123456");
}

TEST(folders_are_made_with_parents) {
    struct cs_error error = {0};
    struct stat info;
    const char *const paths[] = {"p/q/r", "p/q/r", "p//q/s/", ".", "/", "/tmp", "p/../t"};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        cs_folder_create(paths[i], &error);
        UNIT_ASSERT_OK(&error);
        ck_assert_int_eq(stat(paths[i], &info), 0);
        ck_assert(S_ISDIR(info.st_mode));
    }
}

TEST(folder_over_a_file_is_refused) {
    const char *const paths[] = {"file", "file/below", ""};
    struct cs_error made = {0};
    cs_file_write("file", "x", 1, &made);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        struct cs_error error = {0};
        cs_folder_create(paths[i], &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "cannot make the folder");
    }
}

TEST(a_stream_is_written_and_a_link_replaced) {
    struct cs_error error = {0};
    struct stat info;
    char found[8] = "";
    ck_assert_int_eq(mkfifo("stream", 0600), 0);
    const int pipe = open("stream", O_RDWR);
    cs_file_write_durable("stream", "bytes", 5, &error);
    ck_assert_int_eq(read(pipe, found, sizeof found), 5);
    ck_assert_str_eq(found, "bytes");
    ck_assert(!stat("stream", &info) && S_ISFIFO(info.st_mode));
    close(pipe);
    cs_file_write("victim", "old", 3, &error);
    ck_assert_int_eq(symlink("victim", "link"), 0);
    cs_file_write("link", "new", 3, &error);
    UNIT_ASSERT_OK(&error);
    assert_content("victim", "old");
    assert_content("link", "new");
}

TEST(standard_output_is_not_replaced) {
    struct cs_error error = {0};
    const int file = open("output", O_RDWR | O_CREAT, 0600), before = dup(STDOUT_FILENO);
    dup2(file, STDOUT_FILENO);
    cs_file_write("output", "x", 1, &error);
    dup2(before, STDOUT_FILENO);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "it is standard output");
    close(before);
    close(file);
}

static void do_nothing(int number) {
    (void)number;
}

TEST(an_interrupt_ends_the_wait_for_a_reader) {
    struct cs_error error = {0};
    const struct itimerval soon = {.it_value.tv_usec = 1000, .it_interval.tv_usec = 1000};
    ck_assert_int_eq(mkfifo("unread", 0600), 0);
    struct sigaction action = {.sa_handler = do_nothing, .sa_flags = SA_RESTART};
    sigaction(SIGALRM, &action, NULL);
    setitimer(ITIMER_REAL, &soon, NULL);
    cs_file_write("unread", "x", 1, &error);
    setitimer(ITIMER_REAL, &(struct itimerval){0}, NULL);
    UNIT_ASSERT_FAILED(&error, CS_ERR_INTERRUPT, "cannot write \"unread\"");
}

static bool is_table(const char *name) {
    return !strcmp(name, "a.csv");
}

TEST(what_killed_processes_left_is_swept) {
    // no living process has the first; the second is being written; the others are not ours
    static const char *const names[] = {"s/a.csv.tmp.1", "s/b.csv.tmp.1", "s/a.csv.tmp.1x",
                                        "s/a.csv.tmp."};
    struct cs_error error = {0};
    struct cs_file_out out = {0};
    cs_folder_create("s", &error);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        fclose(fopen(names[k], "w"));
    cs_file_create(&out, "s/a.csv", &error);
    cs_file_sweep("s", is_table);
    ck_assert_int_eq(unit_count_files("s"), 4);
    ck_assert(access(names[0], F_OK));
    cs_file_finish(&out, &error);
    cs_file_sweep("s/b.csv", NULL);
    ck_assert(access(names[1], F_OK));
    UNIT_ASSERT_OK(&error);
    ck_assert_int_eq(unit_count_files("s"), 3);
}
