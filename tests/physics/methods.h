/* methods.h - the methods that a physics test runs: those of the registry with the traits that
 * it asks for. A new method is in each test that its traits qualify it for.
 *
 * Methods of another model (CS_FIDELITY_OTHER) are in none. methods.c lists the exceptions,
 * each with its reason. */
#ifndef METHODS_H
#define METHODS_H

#include "fixture.h"

/* Zeroed: every method with its own defaults. */
struct methods_query {
    const char *test;       /* its name in the list of exceptions; NULL: it has none */
    uint32_t with, without; /* sets of enum cs_trait: has all of these, none of those */
    double dt;              /* s: the step of methods without error control; 0: their own */
    uint32_t dt_for;        /* enum cs_trait: all others keep their own step; 0: none does */
    double rtol;            /* of methods with error control; 0: their own */
    double residual;    /* rtol of the solver in methods without error control; 0: their own */
    const char *always; /* this one a part has too: no other test takes all its branches */
    const char *const *more; /* methods with other options, closed by NULL; or NULL */
};

enum { METHODS_MAX = 64 };

struct methods {
    size_t n, n_by_trait; /* in the list; chosen by their traits */
    struct method_asked {
        char text[120]; /* "NAME:key=value,..." */
        uint32_t order, order_damped, traits;
    } list[METHODS_MAX];
};

/* The methods in the order of their names, then the ones with other options, which have the
 * traits of their NAME. Fails the test if there is none. A build with a sanitizer takes a part
 * of those chosen by their traits (suite_takes), another one in each test. */
struct methods methods_find(const struct methods_query *query);

/* The same, and all of them in any build. */
struct methods methods_find_all(const struct methods_query *query);

/* A step in s at which the soft sheets of these tests show an order: small enough for the
 * slope, large enough to stay above rounding. */
double methods_step(uint32_t order);

/* Adds ",key=value" or ":key=value" to a method. */
void methods_set(char text[120], const char *name, const char *key, double value);

/* Fails unless methods with error control come within 1e-5 of dopri5 at a tolerance of 1e-13:
 * rms of the n values of `state` that `end` leaves for a method and a value of the test's own.
 */
void methods_check_agreement(void (*end)(const char *method, const char *value, double *state),
                             const char *value, size_t n);

/* Fails unless each method that is as exact in a moving frame has its own order on the mesh
 * collider of a test, to the fourth, from steps of h and h / 2 s against rk4 at h_reference; h
 * is `first` for methods of order 1, else `higher`. test: as in a query. A build with a
 * sanitizer runs its part of the methods at h alone, unless SANITIZE_ALL is set. */
void methods_check_mesh_orders(const char *test,
                               void (*end)(const char *method, double h, double *state),
                               size_t n, double h_reference, double first, double higher);

/* Whether the text names this method, with any options. */
bool methods_is(const char *text, const char *name);

#endif
