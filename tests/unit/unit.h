/* unit.h - the frame of a unit test: runs tests in an empty folder of their own. */
#ifndef UNIT_H
#define UNIT_H

#include <check.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Removes a folder with all that is in it; the working directory is then inside it. */
static inline void unit_remove(const char *folder) {
    DIR *entries = chdir(folder) ? NULL : opendir(".");
    if (!entries)
        return;
    for (const struct dirent *entry; (entry = readdir(entries));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
            unlink(entry->d_name)) {
            unit_remove(entry->d_name);
            if (chdir("..") || rmdir(entry->d_name))
                perror(entry->d_name);
        }
    closedir(entries);
}

/* For loops of very many rounds: Check writes to a file at every assertion that holds. */
#define UNIT_ASSERT_OFTEN(condition)                                                           \
    do {                                                                                       \
        if (!(condition))                                                                      \
            ck_abort_msg("%s", #condition);                                                    \
    } while (0)

/* Runs each test in a process of its own, in a folder that is removed at the end; returns the
 * program's exit code. */
static inline int unit_run(const char *name, const TTest *const *tests, size_t n_tests) {
    char folder[] = "/tmp/clothsim-unit-XXXXXX";
    if (!mkdtemp(folder) || chdir(folder)) {
        perror(folder);
        return 1;
    }
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 0); // the build has one, longer where a sanitizer is at work
    for (size_t i = 0; i < n_tests; i++)
        tcase_add_test(tcase, tests[i]);
    Suite *suite = suite_create(name);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    unit_remove(folder);
    rmdir(folder);
    return failed != 0;
}

/* Files in a folder, without . and .. */
static inline int unit_count_files(const char *folder) {
    int n = 0;
    DIR *entries = opendir(folder);
    ck_assert_ptr_nonnull(entries);
    for (const struct dirent *entry; (entry = readdir(entries));)
        n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(entries);
    return n;
}

/* fails unless the call failed so, with a message that has all of part in it */
#define UNIT_ASSERT_FAILED(error, status_, part)                                               \
    ck_assert_msg((error)->status == (status_) && strstr((error)->message, part),              \
                  "found %d \"%s\", expected %d \"%s\"", (int)(error)->status,                 \
                  (error)->message, (int)(status_), part)
#define UNIT_ASSERT_OK(error) ck_assert_msg(!(error)->status, "%s", (error)->message)

#endif
