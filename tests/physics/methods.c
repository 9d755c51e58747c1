/* Methods by their traits, and the exceptions of single tests. */
#include "methods.h"

#include "sim/registry.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Options beside the query's, or in place of them; NULL: the method is left out. */
static const struct {
    const char *test, *method, *options, *reason;
} exceptions[] = {
    {"belts", "ros2", NULL,
     "the slope of slip throws what would rest to and fro, on a plate at rest too"},
    {"bounce", "averaged-euler", NULL, "gains energy without damping"},
    {"bounce", "explicit-euler", NULL, "gains energy without damping"},
    {"bounce", "midpoint", NULL, "gains energy without damping"},
    {"bounce", "rkc2", "rtol=1e-5", "at 1e-3 its error is 5 % of the energy"},
    {"box", "avbd", "iterations=30", "by then its passes have settled"},
    {"box", "fast-mass-spring", "iterations=30", "by then its passes have settled"},
    {"box", "projective-dynamics", "iterations=30", "by then its passes have settled"},
    {"box", "vbd", "iterations=30", "by then its passes have settled"},
    {"box", "xpbd", "iterations=30", "by then its passes have settled"},
    {"crossings", "averaged-euler", "dt=1e-3", "gains energy at longer steps"},
    {"crossings", "explicit-euler", "dt=1e-3", "gains energy at longer steps"},
    {"drum", "gauss", "rtol=1e-13", "of order 4: its errors are as small as that"},
    {"drop", "midpoint", NULL, "gains energy at the step that suits the others"},
    {"events", "averaged-euler", "dt=1e-3", "its own step follows the damping alone"},
    {"events", "explicit-euler", "dt=1e-3", "its own step follows the damping alone"},
    {"exact rest", "vbd", "iterations=300", "its passes move a stiff body as a whole slowly"},
    {"free fall", "esdirk", "rtol=1e-8,newton_rtol=1e-3",
     "by default a stage may stop earlier"},
    {"let go", "implicit-block", NULL, "h K_ii v is a drag that a sliding sheet feels"},
    {"let rest", "implicit-block", NULL, "h K_ii v is a drag that a sliding sheet feels"},
    {"let rest", "ros2", NULL, "throws back what slips at the end of a step"},
    {"lift", "explicit-euler", NULL, "moves first: the floor meets it in the step after"},
    {"momentum", "ark-dirk", "linear_rtol=1e-12", "by default its solver may stop earlier"},
    {"momentum", "ark-imex", "linear_rtol=1e-12", "by default its solver may stop earlier"},
    {"momentum", "cvode-bdf", "linear_rtol=1e-12", "by default its solver may stop earlier"},
    {"momentum", "esdirk", "newton_rtol=1e-8", "by default a stage may stop earlier"},
    {"membrane", "composition", NULL, "its slope is 5.0 yet at the steps of its order"},
    {"moves", "averaged-euler", "dt=1e-3", "its own step follows the damping alone"},
    {"moves", "explicit-euler", "dt=1e-3", "its own step follows the damping alone"},
    {"one solution", "ark-dirk", "rtol=1e-11", "tighter than that its solver fails"},
    {"one solution", "ark-imex", "rtol=1e-11", "tighter than that its solver fails"},
    {"one solution", "cvode-bdf", "rtol=1e-12,max_order=5,linear_rtol=1e-8",
     "by default its order is lower and its solver looser"},
    {"membrane", "avbd", NULL, "its model is of springs alone"},
    {"membrane", "vbd", NULL, "its model is of springs alone"},
    {"membrane", "xpbd", NULL, "its model is of springs alone"},
    {"one solution", "rkc2", NULL, "its error falls as rtol^(2/3)"},
    {"one solution", "avbd", NULL, "comes no nearer than 2e-10 by extrapolation"},
    {"one solution", "vbd", NULL, "comes no nearer than 3e-10 by extrapolation"},
    {"one solution", "xpbd", NULL, "comes no nearer than 1e-8 by extrapolation"},
    {"order in contact", "composition", NULL, "its error is that of the reference there"},
    {"planted force", "rkc2", "rtol=1e-10", "its error falls as rtol^(2/3)"},
    {"pairs", "bdf2", NULL, "its slope is 1.8 yet at steps of 1 ms"},
    {"pairs", "composition", NULL, "its error is that of the reference at these steps"},
    {"pairs", "symplectic-euler", NULL, "its slope is 1.3 yet at steps of 0.25 ms"},
    {"pins", "averaged-euler", "dt=1e-3", "its own step follows the damping alone"},
    {"thin", "cvode-bdf", "atol=1e-4,linear_rtol=1e-4",
     "sinks by a tenth more in shorter steps"},
    {"pins", "cvode-bdf", "rtol=1e-2", "takes long steps then"},
    {"pins", "explicit-euler", "dt=1e-3", "its own step follows the damping alone"},
    {"slide", "avbd", "iterations=300", "its passes move a stiff body as a whole slowly"},
    {"slide", "implicit-block", NULL, "h K_ii v is a drag that a sliding sheet feels"},
    {"slide", "vbd", "iterations=300", "its passes move a stiff body as a whole slowly"},
    {"small creep", "ros2", NULL, "throws to and fro what slips at the begin of a step"},
    {"small creep", "avbd", "iterations=100", "its default passes leave 32 times the creep"},
    {"small creep", "vbd", "iterations=100", "its default passes leave 200 times the creep"},
    {"small creep", "xpbd", "iterations=40", "its default passes leave 13 times the creep"},
    {"thin", "averaged-euler", "dt=1e-4", "its own step follows the damping alone"},
    {"thin", "explicit-euler", "dt=1e-4", "its own step follows the damping alone"},
    {"thin", "implicit-block", "dt=1e-3", "gains energy at the step that suits the others"},
    {"threads", "averaged-euler", "dt=2e-4", "its own step follows the damping alone"},
    {"threads", "explicit-euler", "dt=1e-4", "its own step follows the damping alone"},
    {"turning mesh", "gauss", NULL, "its slope is 4.2 yet at steps of 1/600 s"},
};

double methods_step(uint32_t order) {
    return order == 1 ? 2.5e-4 : order == 2 ? 1e-3 : order == 4 ? 4e-3 : 5e-2;
}

void methods_set(char text[120], const char *name, const char *key, double value) {
    const int length =
        snprintf(text, 120, "%s%c%s=%.15g", name, strchr(name, ':') ? ',' : ':', key, value);
    ck_assert_int_lt(length, 120);
}

bool methods_is(const char *text, const char *name) {
    const size_t length = strlen(name);
    return !strncmp(text, name, length) && (!text[length] || text[length] == ':');
}

/* A build with a sanitizer takes one method of so many in a row. */
enum { METHODS_STRIDE = 4 };

static bool has_option(const struct cs_integrator *integrator, const char *name) {
    for (uint32_t k = 0; k < integrator->n_options; k++)
        if (!strcmp(integrator->options[k].name, name))
            return true;
    return false;
}

/* True if the text sets that option; "linear_rtol" is not "rtol". */
static bool has_set(const char *text, const char *key) {
    const size_t length = strlen(key);
    for (const char *at = text; (at = strpbrk(at, ":,"));)
        if (!strncmp(++at, key, length) && at[length] == '=')
            return true;
    return false;
}

/* Sets an option that the method has and that its exception does not name. */
static void set_option(struct method_asked *method, const struct cs_integrator *integrator,
                       const char *key, double value) {
    char before[sizeof method->text];
    if (!(value > 0) || !has_option(integrator, key) || has_set(method->text, key))
        return;
    memcpy(before, method->text, sizeof before);
    methods_set(method->text, before, key, value);
}

/* false: an exception leaves it out */
static bool set_options(struct method_asked *method, const struct cs_integrator *integrator,
                        const struct methods_query *query) {
    const bool adaptive = integrator->traits & CS_ADAPTIVE;
    const bool given = !adaptive && (integrator->traits & query->dt_for) == query->dt_for;
    snprintf(method->text, sizeof method->text, "%s", integrator->name);
    for (size_t k = 0; query->test && k < LENGTH(exceptions); k++)
        if (!strcmp(exceptions[k].test, query->test) &&
            !strcmp(exceptions[k].method, integrator->name)) {
            if (!exceptions[k].options)
                return false;
            snprintf(method->text, sizeof method->text, "%s:%s", integrator->name,
                     exceptions[k].options);
        }
    set_option(method, integrator, "dt", given ? query->dt : 0);
    set_option(method, integrator, "rtol", adaptive ? query->rtol : query->residual);
    return true;
}

static bool is_asked(const struct cs_integrator *integrator,
                     const struct methods_query *query) {
    return integrator && integrator->fidelity != CS_FIDELITY_OTHER &&
           (integrator->traits & query->with) == query->with &&
           !(integrator->traits & query->without) &&
           // most scenes have damping or contact
           (query->with & CS_SMOOTH_ONLY || !(integrator->traits & CS_SMOOTH_ONLY));
}

static void add(struct methods *methods, const struct cs_integrator *integrator,
                const struct method_asked *method) {
    ck_assert_uint_lt(methods->n, METHODS_MAX);
    struct method_asked *added = methods->list + methods->n++;
    *added = *method;
    added->order = integrator->order;
    added->order_damped = integrator->order_damped;
    added->traits = integrator->traits;
}

struct methods methods_find_all(const struct methods_query *query) {
    struct cs_registry registry = {0};
    struct cs_error error = {0};
    struct methods methods = {0};
    cs_registry_open_all(&registry, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    for (uint32_t k = 0; k < registry.n; k++) {
        const struct cs_integrator *integrator = registry.entries[k].integrator;
        struct method_asked method;
        if (is_asked(integrator, query) && set_options(&method, integrator, query))
            add(&methods, integrator, &method);
    }
    methods.n_by_trait = methods.n;
    for (const char *const *more = query->more; more && *more; more++)
        for (uint32_t k = 0; k < registry.n; k++) {
            const struct cs_integrator *integrator = registry.entries[k].integrator;
            struct method_asked method;
            snprintf(method.text, sizeof method.text, "%s", *more);
            if (integrator && methods_is(*more, integrator->name))
                add(&methods, integrator, &method);
        }
    ck_assert_uint_gt(methods.n, 0);
    cs_registry_finish(&registry);
    return methods;
}

struct methods methods_find(const struct methods_query *query) {
    const struct methods all = methods_find_all(query);
    const size_t stride = all.n_by_trait < METHODS_STRIDE ? all.n_by_trait : METHODS_STRIDE;
    struct methods taken = all;
    taken.n = 0;
    for (size_t k = 0; k < all.n; k++)
        if (k >= all.n_by_trait || suite_takes(k, stride) ||
            (query->always && methods_is(all.list[k].text, query->always)))
            taken.list[taken.n++] = all.list[k];
    return taken;
}

void methods_check_agreement(void (*end)(const char *method, const char *value, double *state),
                             const char *value, size_t n) {
    static const char *const by[] = {"cvode-bdf:rtol=1e-8", "cvode-adams:rtol=1e-9",
                                     "ark-erk:rtol=1e-9", "ark-dirk:rtol=1e-9",
                                     "ark-imex:rtol=1e-9"};
    double *reference = calloc(2 * n, sizeof *reference), *state = reference + n;
    ck_assert_ptr_nonnull(reference);
    end("dopri5:rtol=1e-13", value, reference);
    for (size_t k = 0; k < sizeof by / sizeof *by; k++) {
        if (!suite_takes(k, 2))
            continue;
        end(by[k], value, state);
        const double error = cs_rms_difference(state, reference, n);
        ck_assert_msg(error < 1e-5, "%s: %.3g", by[k], error);
    }
    free(reference);
}

void methods_check_mesh_orders(const char *test,
                               void (*end)(const char *method, double h, double *state),
                               size_t n, double h_reference, double first, double higher) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = test,
                                .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                .residual = 1e-12});
    double *reference = calloc(2 * n, sizeof *reference), *state = reference + n;
    ck_assert_ptr_nonnull(reference);
    // as with suite `orders`: a sanitizer sees each method step, and no slope is measured
    const bool is_measured = suite_takes(0, SIZE_MAX);
    if (is_measured)
        end("rk4", h_reference, reference);
    for (size_t m = 0; m < methods.n; m++) {
        const struct method_asked *method = methods.list + m;
        const double h = method->order_damped == 1 ? first : higher;
        double error[2];
        for (int k = 0; k < (is_measured ? 2 : 1); k++) {
            end(method->text, h / (1 + k), state);
            error[k] = cs_rms_difference(state, reference, n);
        }
        if (!is_measured)
            continue;
        const double order = log2(error[0] / error[1]);
        ck_assert_msg(fabs(order - method->order_damped) < 0.2, "%s: order %.3f (%.3g, %.3g)",
                      method->text, order, error[0], error[1]);
    }
    free(reference);
}
