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

/* Adds a test to the list; it is borrowed. */
void suite_add(const TTest *test);

#define TEST(name)                                                                             \
    static void name(int);                                                                     \
    __attribute__((constructor)) static void add_##name(void) {                                \
        static const TTest test = {#name, name, __FILE__, __LINE__};                           \
        suite_add(&test);                                                                      \
    }                                                                                          \
    static void name(int _i CK_ATTRIBUTE_UNUSED)

#endif
