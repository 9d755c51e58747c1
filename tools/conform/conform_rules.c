/* Checks the rules of the contract that hold for every method. */
#include "conform/conform_checks.h"
#include "session/session.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* Pinned at two corners, pulled by gravity and wind, and falling on a floor: uses all that a
 * commit does. */
#define HANGING                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"bump\": 0.02}, \"mass\": {\"particle\": "  \
    "0.05}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 5, \"damping\": 0.1,"      \
    " \"damping_model\": \"%s\"}, \"pins\": [\"top-left\", \"top-right\"]}],"                  \
    " \"colliders\": [{\"floor\": {\"height\": -0.55}}], \"forces\": {\"drag\": 0.01,"         \
    " \"wind\": {\"direction\": [0, 0, 1], \"strength\": 2}}, \"time\": {\"fps\": 60}}"
enum { HANGING_FRAMES = 30 };

/* True if the name is one of the card's checks. */
static bool is_check(const char *name) {
#define X(check, function, of, what)                                                           \
    if (!strcmp(name, check))                                                                  \
        return true;
    CS_CONFORM_LIST(X)
#undef X
    return false;
}

/* Checks the descriptor where opening a module does not, because a run does not need it. */
void cs_check_abi(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct cs_integrator *method = conform->method;
    // all bits up to the last one of enum cs_need and of enum cs_trait
    const uint32_t needs = 2 * CS_NEED_BOUNDS - 1, traits = 2 * CS_SMOOTH_ONLY - 1;
    bool falls_off = false;
    /* a run ignores bits that it does not know, so that a slip would go unnoticed */
    if (method->needs & ~needs)
        cs_row_fail(row, "unknown bits in needs: %#x", method->needs & ~needs);
    if (method->traits & ~traits)
        cs_row_fail(row, "unknown bits in traits: %#x", method->traits & ~traits);
    if (method->fidelity > CS_FIDELITY_OTHER)
        cs_row_fail(row, "unknown fidelity %u", method->fidelity);
    if (method->order < 1 || method->order_damped < 1)
        cs_row_fail(row, "order %u and %u with damping, expected at least 1", method->order,
                    method->order_damped);
    for (const char *const *name = method->fails; name && *name; name++) {
        falls_off |= !strcmp(*name, "translation");
        if (!is_check(*name))
            cs_row_fail(row, "\"%.60s\" in fails is not a check", *name);
    }
    if (falls_off != !!(method->traits & CS_NOT_GALILEAN))
        cs_row_fail(row, "CS_NOT_GALILEAN and \"translation\" in fails must appear together: "
                         "one of them is missing");
    if (row->verdict == CS_VERDICT_PASS)
        cs_row_state(row, CS_ABI, CS_ABI, "interface of the module");
}

/* Functions of the C and C++ libraries that no method may call: their results differ from run
 * to run, or they start what the host cannot see. A * stands for the rest of a name. */
static const char *const forbidden[] = {"time",
                                        "clock*",
                                        "gettimeofday",
                                        "times",
                                        "timespec_get",
                                        "ftime",
                                        "getrusage",
                                        "getenv",
                                        "secure_getenv",
                                        "rand",
                                        "rand_r",
                                        "random*",
                                        "drand48",
                                        "erand48",
                                        "lrand48",
                                        "mrand48",
                                        "nrand48",
                                        "jrand48",
                                        "getrandom",
                                        "getentropy",
                                        "arc4random*",
                                        "sysconf",
                                        "get_nprocs*",
                                        "getpid",
                                        "gettid",
                                        "sched_*",
                                        "syscall",
                                        "pthread_*",
                                        "thrd_*",
                                        "fork",
                                        "vfork",
                                        "open*",
                                        "fopen*",
                                        "dlopen",
                                        "dlsym",
                                        "_ZNSt6chrono*",
                                        "_ZNSt13random_device*",
                                        "_ZNSt6thread*",
                                        NULL};

/* Looks at the symbols that the module asks the dynamic linker for. What a check sees of their
 * effect depends on the hour: that of a date does not change within a card. */
void cs_check_imports(const struct cs_conform *conform, struct cs_conform_row *row) {
    const void *address = (const void *)(uintptr_t)conform->method->create;
    const char *symbol;
    if (!cs_module_find_import(address, forbidden, &symbol))
        cs_row_skip(row, "it is not in a module");
    else if (symbol)
        cs_row_fail(row,
                    "its module calls %.60s: a clock, the environment, random numbers, "
                    "files and threads are not for methods",
                    symbol);
    else
        cs_row_state(row, 0, 0,
                     "symbols of a clock, the environment, random numbers, files or "
                     "threads");
}

/* Creates the method with one option at an end of its range. It must succeed, or fail with a
 * reason. */
static void try_option(const struct cs_conform *conform, struct cs_conform_row *row,
                       const struct cs_option *option, double value) {
    struct cs_probe probe;
    cs_probe_open(&probe, conform, conform->method, HANGING, "axial");
    cs_probe_set(&probe, option->name, value);
    if (!cs_probe_run(&probe, 0) && strstr(probe.error.message, "it gave no reason"))
        cs_row_fail(row, "%s = %g: create fails without a reason", option->name, value);
    cs_probe_close(&probe);
}

/* Runs the method with its defaults, then creates it with each numeric option at both ends. */
void cs_check_options(const struct cs_conform *conform, struct cs_conform_row *row) {
    const struct cs_integrator *method = conform->method;
    struct cs_probe plain;
    cs_probe_open(&plain, conform, method, HANGING, "axial");
    if (!cs_probe_run(&plain, HANGING_FRAMES))
        cs_row_fail(row, "with its defaults: %s", plain.error.message);
    cs_probe_close(&plain);
    for (uint32_t k = 0; k < method->n_options; k++) {
        const struct cs_option *option = method->options + k;
        if (!cs_method_has(method, option->name))
            continue;
        try_option(conform, row, option, option->min);
        try_option(conform, row, option, option->max);
    }
    if (row->verdict == CS_VERDICT_PASS)
        cs_row_state(row, 0, 0, "options that failed without a reason, of %u",
                     method->n_options);
}

/* The committed steps. */
struct ledger {
    double t;   /* s, the end of the last */
    double gap; /* s, the farthest that a step did not begin there */
};

/* Records at each commit the largest gap between successive steps. */
static bool store_account(struct cs_probe *probe, double t, double dt, double *x, double *v) {
    (void)x, (void)v;
    struct ledger *ledger = probe->on_commit_ctx;
    ledger->gap = fmax(ledger->gap, dt > 0 ? fabs(t - dt - ledger->t) : HUGE_VAL);
    ledger->t = t;
    return false;
}

/* The committed steps must fill the time: each begins where the last one ended, to 1e-12 s. */
void cs_check_commit(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe sheet;
    struct ledger ledger = {0};
    cs_probe_open(&sheet, conform, conform->method, HANGING, "axial");
    sheet.on_commit = store_account;
    sheet.on_commit_ctx = &ledger;
    if (!cs_probe_run(&sheet, HANGING_FRAMES))
        cs_row_fail(row, "%s", sheet.error.message);
    else
        cs_row_state(row, fmax(ledger.gap, fabs(sheet.session.run.t - ledger.t)), 1e-12,
                     "s of the time left out by the committed steps");
    cs_probe_close(&sheet);
}

/* Pinned particles must keep the bits of their positions, and zero velocities. */
void cs_check_pins(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe sheet;
    uint32_t moved = 0;
    cs_probe_open(&sheet, conform, conform->method, HANGING, "relative");
    if (!cs_probe_run(&sheet, HANGING_FRAMES))
        cs_row_fail(row, "%s", sheet.error.message);
    else {
        for (uint32_t k = 0; k < sheet.session.system.n_pinned; k++)
            for (size_t c = 0; c < 3; c++) {
                const size_t i = c * sheet.n + sheet.session.system.pinned[k];
                moved +=
                    memcmp(sheet.x + i, sheet.session.system.start + i, sizeof *sheet.x) != 0 ||
                    sheet.v[i] != 0;
            }
        cs_row_state(row, moved, 0, "components of %u pinned particles moved",
                     sheet.session.system.n_pinned);
    }
    cs_probe_close(&sheet);
}

/* True if a run from an invalid state ended as finished with a state that is not finite. */
static bool hides(struct cs_probe *probe) {
    bool finite = true;
    if (!cs_probe_run(probe, 10))
        return false;
    for (size_t i = 0; i < 6 * probe->n; i++)
        finite &= isfinite(probe->x[i]) != 0;
    return !finite;
}

void cs_check_not_finite(const struct cs_conform *conform, struct cs_conform_row *row) {
    static const char *const cases[] = {"a position that is not a number",
                                        "a speed of 1e200 m/s", "a step far too large"};
    uint32_t hidden = 0;
    const char *which = "none";
    /* a state that is not finite from the start, by overflow, or by an unstable step */
    for (int k = 0; k < 3; k++) {
        struct cs_probe sheet;
        cs_probe_open(&sheet, conform, conform->method, HANGING, "axial");
        if (k == 0 && !sheet.has_ended)
            sheet.x[sheet.n / 2] = (double)NAN;
        if (k == 1 && !sheet.has_ended)
            sheet.v[sheet.n / 2] = 1e200;
        if (k == 2)
            cs_probe_set(&sheet, "dt", 1);
        if (hides(&sheet)) {
            hidden++;
            which = cases[k];
        }
        cs_probe_close(&sheet);
    }
    cs_row_state(row, hidden, 0, "of 3 invalid runs were not reported as failures (%s)", which);
}

/* The host lets every linear solve fail: no frame may then be finished. */
void cs_check_failed_solve(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe sheet;
    if (!(conform->method->needs & CS_NEED_SOLVE)) {
        cs_row_skip(row, "it does not use the host's solver");
        return;
    }
    cs_probe_open(&sheet, conform, conform->method, HANGING, "axial");
    if (!cs_probe_run(&sheet, 0))
        cs_row_fail(row, "%s", sheet.error.message);
    else {
        cs_run_fail_solves(&sheet.session.run);
        cs_row_state(row, cs_probe_run(&sheet, 1), 0,
                     "frames finished though no linear solve succeeded");
    }
    cs_probe_close(&sheet);
}

/* Counts the values of two runs that differ; both are taken a frame further until some do. */
static uint32_t compare_runs(struct cs_probe *one, struct cs_probe *two) {
    uint32_t differ = 0;
    for (int k = 0; k < HANGING_FRAMES && !differ; k++) {
        // one after the other, so that neither can lean on the other's memory
        if (!cs_probe_run(one, 1) || !cs_probe_run(two, 1))
            break;
        for (size_t i = 0; i < 6 * one->n; i++)
            differ += memcmp(one->x + i, two->x + i, sizeof *one->x) != 0;
    }
    return differ;
}

/* Waits for the next second of the calendar: what a clock of seconds says has changed then. */
static void wait_for_next_second(void) {
    const time_t now = time(NULL);
    while (time(NULL) == now)
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
}

/* Runs in alternation must agree in all bits, and with a run in another second: no method may
 * depend on addresses, uninitialised memory, static variables, or a clock. */
void cs_check_same_bits(const struct cs_conform *conform, struct cs_conform_row *row) {
    struct cs_probe runs[3];
    for (int k = 0; k < 3; k++)
        cs_probe_open(runs + k, conform, conform->method, HANGING, "axial");
    const uint32_t differ = compare_runs(runs, runs + 1);
    const uint32_t frame = runs[0].session.run.frame;
    if (!differ && !runs[0].has_ended && !runs[1].has_ended) {
        wait_for_next_second();
        cs_probe_run(runs + 2, frame);
    }
    for (int k = 0; k < 3; k++)
        if (runs[k].has_ended)
            cs_row_fail(row, "%s", runs[k].error.message);
    cs_row_state(row, differ, 0, "values differ after frame %u", frame);
    if (!differ)
        cs_row_state(row, memcmp(runs[0].x, runs[2].x, 6 * runs[0].n * sizeof *runs[0].x) != 0,
                     0, "states differ in a run of %u frames a second later", frame);
    for (int k = 0; k < 3; k++)
        cs_probe_close(runs + k);
}
