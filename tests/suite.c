/* The main of every test program: runs its tests, each in a process of its own, in an empty
 * folder that is removed at the end. */
#include "suite.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

char **suite_args;
bool suite_all;
const char *suite_test = "";
static Suite *suite;
static TCase *tcase;

#ifdef CS_SANITIZED
static const bool is_sanitized = true;
#else
static const bool is_sanitized = false;
#endif

bool suite_takes(size_t k, size_t n) {
    size_t offset = 0;
    for (const char *c = suite_test; *c; c++)
        offset = 31 * offset + (unsigned char)*c;
    return !is_sanitized || getenv("SANITIZE_ALL") || k % n == offset % n;
}

void suite_add(const TTest *test) {
    if (!suite) {
        const char *slash = strrchr(test->file, '/'), *name = slash ? slash + 1 : test->file;
        suite = suite_create(name);
        tcase = tcase_create(name);
        tcase_set_timeout(tcase, 0); // the build has one, longer where a sanitizer is at work
        suite_add_tcase(suite, tcase);
    }
    tcase_add_test(tcase, test);
}

/* Removes a folder with all that is in it; the working directory is then inside it. */
static void remove_folder(const char *folder) {
    DIR *entries = chdir(folder) ? NULL : opendir(".");
    if (!entries)
        return;
    for (const struct dirent *entry; (entry = readdir(entries));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
            unlink(entry->d_name)) {
            remove_folder(entry->d_name);
            if (chdir("..") || rmdir(entry->d_name))
                perror(entry->d_name);
        }
    closedir(entries);
}

int main(int argc, char **argv) {
    char folder[] = "/tmp/clothsim-test-XXXXXX";
    suite_args = argv + 1;
    suite_all = argc > 1 && !strcmp(argv[1], "all");
    if (!mkdtemp(folder) || chdir(folder)) {
        perror(folder);
        return EXIT_FAILURE;
    }
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    remove_folder(folder);
    rmdir(folder);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
