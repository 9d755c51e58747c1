/* A method enters the physics tests by its traits alone: the template's, which no test names,
 * is built as a module beside these tests. */
#include "methods.h"

#include <stdlib.h>
#include <string.h>

#define ADDED "midpoint" /* of plugins/template.c: explicit, of order 2, with steps of dt */

static const struct method_asked *find(const struct methods *methods, const char *name) {
    for (size_t k = 0; k < methods->n; k++)
        if (methods_is(methods->list[k].text, name))
            return methods->list + k;
    return NULL;
}

TEST(traits_choose_an_added_method) {
    const struct methods all = methods_find_all(&(struct methods_query){.rtol = 1e-3});
    const struct methods fixed = methods_find_all(&(struct methods_query){
        .without = CS_IMPLICIT | CS_ADAPTIVE, .dt = 0.25, .rtol = 1e-3, .residual = 1e-9});
    const struct methods kept = methods_find_all(
        &(struct methods_query){.without = CS_ADAPTIVE, .dt = 0.25, .dt_for = CS_IMPLICIT});
    ck_assert_ptr_nonnull(find(&all, ADDED));
    ck_assert_str_eq(find(&all, ADDED)->text, ADDED);
    ck_assert_uint_eq(find(&all, ADDED)->order, 2);
    ck_assert_str_eq(find(&fixed, ADDED)->text, ADDED ":dt=0.25");
    ck_assert_str_eq(find(&kept, ADDED)->text, ADDED);
    ck_assert_str_eq(find(&kept, "backward-euler")->text, "backward-euler:dt=0.25");
}

TEST(traits_leave_methods_out) {
    static const uint32_t others[] = {CS_IMPLICIT, CS_ADAPTIVE, CS_SYMPLECTIC,
                                      CS_IMPLICIT | CS_SYMPLECTIC};
    for (size_t k = 0; k < LENGTH(others); k++) {
        const struct methods methods =
            methods_find_all(&(struct methods_query){.with = others[k]});
        ck_assert_ptr_null(find(&methods, ADDED));
        for (size_t m = 0; m < methods.n; m++)
            ck_assert_uint_eq(methods.list[m].traits & others[k], others[k]);
    }
    const struct methods all = methods_find_all(&(struct methods_query){0});
    ck_assert_ptr_null(find(&all, "shape-matching")); // of another model
}

TEST(exceptions_are_of_one_test) {
    const struct methods all = methods_find_all(&(struct methods_query){.dt = 0.5});
    const struct methods box =
        methods_find_all(&(struct methods_query){.test = "box", .dt = 0.5});
    const struct methods slide = methods_find_all(&(struct methods_query){.test = "slide"});
    ck_assert_str_eq(find(&all, "xpbd")->text, "xpbd:dt=0.5");
    ck_assert_str_eq(find(&box, "xpbd")->text, "xpbd:iterations=30,dt=0.5");
    ck_assert_ptr_nonnull(find(&all, "implicit-block"));
    ck_assert_ptr_null(find(&slide, "implicit-block"));
    ck_assert_uint_eq(slide.n, all.n - 1);
}

TEST(other_options_come_last) {
    static const char *const more[] = {"position-verlet:loss=0.01", "rk4:dt=1", NULL};
    const struct methods methods =
        methods_find_all(&(struct methods_query){.dt = 0.5, .more = more});
    ck_assert_str_eq(methods.list[methods.n - 2].text, more[0]);
    ck_assert_str_eq(methods.list[methods.n - 1].text, more[1]);
    ck_assert_uint_eq(methods.list[methods.n - 1].order, 4);
    ck_assert_str_eq(find(&methods, "rk4")->text, "rk4:dt=0.5");
}

/* In a build with a sanitizer four tests share the methods; elsewhere each takes all. */
TEST(each_method_is_taken_by_one_test_in_four) {
    static const char *const names[] = {"a", "b", "c", "d"};
    const struct methods_query query = {.more = (const char *const[]){"rk4:dt=1", NULL}};
    const struct methods all = methods_find_all(&query);
#ifdef CS_SANITIZED
    const size_t times = 1;
#else
    const size_t times = LENGTH(names);
#endif
    size_t taken = 0;
    unsetenv("SANITIZE_ALL");
    for (size_t t = 0; t < LENGTH(names); t++) {
        suite_test = names[t];
        const struct methods part = methods_find(&query);
        ck_assert_str_eq(part.list[part.n - 1].text, "rk4:dt=1");
        for (size_t k = 0; k + 1 < part.n; k++)
            ck_assert_ptr_nonnull(find(&all, part.list[k].text));
        taken += part.n - 1;
    }
    ck_assert_uint_eq(taken, times * all.n_by_trait);
    setenv("SANITIZE_ALL", "1", 1);
    ck_assert_uint_eq(methods_find(&query).n, all.n);
}
