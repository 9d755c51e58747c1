/* suite.h - the tests of one program. suite.c is its main: it runs them in an empty folder.
 *
 *   TEST(momentum_is_kept) { ... }      one check
 *   TEST_LOOP(rows_agree, 5) { ... }    five, each with its number as _i
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

/* Adds a test that is run n times; test is borrowed. */
void suite_add(const TTest *test, int n);

#define TEST_LOOP(name, n)                                                                     \
    static void name(int);                                                                     \
    __attribute__((constructor)) static void add_##name(void) {                                \
        static const TTest test = {#name, name, __FILE__, __LINE__};                           \
        suite_add(&test, n);                                                                   \
    }                                                                                          \
    static void name(int _i CK_ATTRIBUTE_UNUSED)
#define TEST(name) TEST_LOOP(name, 1)

#endif
