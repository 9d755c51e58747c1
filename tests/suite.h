/* suite.h - the tests of one program. suite.c is its main: it runs them in an empty folder.
 *
 *   TEST(momentum_is_kept) { ... }
 *
 * A test lists itself by its definition, before main begins. */
#ifndef SUITE_H
#define SUITE_H

#include <check.h>
#include <stdbool.h>

#define LENGTH(array) (sizeof(array) / sizeof *(array))

/* The arguments of the command line, closed by NULL; and whether the first one is "all", which
 * asks a program that knows it for its long form. */
extern char **suite_args;
extern bool suite_all;

/* The name of the test that runs. */
extern const char *suite_test;

/* Whether a test takes row k of what it repeats with methods, seeds or sizes. A sanitizer needs
 * each branch of the code once, not once a row: a build with one takes every n-th row, from an
 * offset that the test's name gives, unless SANITIZE_ALL is set in the environment. Any other
 * build takes all. */
bool suite_takes(size_t k, size_t n);

/* Adds a test to the list; it is borrowed. */
void suite_add(const TTest *test);

#define TEST(name)                                                                             \
    static void name(int);                                                                     \
    static void run_##name(int i) {                                                            \
        suite_test = #name;                                                                    \
        name(i);                                                                               \
    }                                                                                          \
    __attribute__((constructor)) static void add_##name(void) {                                \
        static const TTest test = {#name, run_##name, __FILE__, __LINE__};                     \
        suite_add(&test);                                                                      \
    }                                                                                          \
    static void name(int _i CK_ATTRIBUTE_UNUSED)

#endif
