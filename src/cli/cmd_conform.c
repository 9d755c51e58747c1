/* clothsim conform: prints a method's conformance card as text or JSON.
 *
 *   operands (NAME:options or module files) -> registry -> per method: cs_conform_check
 *   -> a line per check as it ends -> counts -> exit status
 * Expected failures pass; failed claims and stale declarations make the command fail. */
#include "base/json_writer.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "sim/method.h"
#include "study/conform/conform.h"
#include "study/conform/conform_checks.h"
#include "study/process_pool.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NOTE_COLUMN = 55, METHODS_MAX = 64, PATIENCE_SECONDS = 60 };

struct options {
    const char *json, *only;
    bool list, quiet;
    const char *const *plugins; /* (n_plugins) */
    uint32_t n_plugins;
};
static const struct options defaults = {.json = NULL};

static const struct cs_arg rows[] = {
    {"json", 0, "FILE", "write the card as JSON too; -: instead of the text",
     CS_ARG_INTO(struct options, json)},
    {"list", 0, NULL, "list the checks", CS_ARG_INTO(struct options, list)},
    {"only", 0, "CHECK", "run only this check", CS_ARG_INTO(struct options, only)},
    {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
     CS_ARG_LIST(struct options, plugins, n_plugins)},
    {"quiet", 'q', NULL, "print only claims that failed, and the count",
     CS_ARG_INTO(struct options, quiet)},
};

/* Destination of the card; each row is printed when its check is done. */
struct output {
    const struct options *options;
    const struct cs_conform *card; /* that is being made */
    const char *settings;          /* options as given after the method's name */
    bool text, first;              /* first: no row is in the JSON yet */
    struct cs_text json;
    struct cs_conform_cache cache; /* shared by all cards */
    uint32_t counts[CS_VERDICTS];  /* over all methods */
    struct cs_error error;         /* of printing rows */
};

/* True for a verdict that makes the command fail. */
static bool is_bad(const struct cs_conform_row *row) {
    return row->verdict == CS_VERDICT_FAIL || row->verdict == CS_VERDICT_STALE;
}

/* One line per check, for readers and programs. */
static void print_row(const struct cs_conform_row *row, struct cs_error *error) {
    struct cs_text out = {0};
    char figure[32] = "", bound[32] = "", left[128];
    if (!isnan(row->bound)) {
        snprintf(figure, sizeof figure, "%.3g", row->figure);
        snprintf(bound, sizeof bound, "<= %.3g", row->bound);
    }
    snprintf(left, sizeof left, "%-9s %-20s %10s %-13s", cs_verdict_text(row->verdict),
             row->check, figure, bound);
    // one line a check, however long: it is read by programs as well
    cs_text_add(&out, "%-*s%s%s\n", NOTE_COLUMN, left, row->note,
                row->verdict == CS_VERDICT_STALE ? " (named in fails, but it passes)" : "");
    cs_print_out(stdout, &out, error);
}

/* Adds a number with all 17 digits, null for NAN or infinity. */
static void add_number(struct cs_text *json, const char *key, double value) {
    cs_json_write(json, ", %s: ", key);
    if (isfinite(value))
        cs_text_add(json, "%.17g", value);
    else
        cs_text_add(json, "null");
}

static void add_json(struct output *output, const struct cs_conform_row *row) {
    struct cs_text *json = &output->json;
    cs_json_write(json, ",\n    {'check': %s, 'verdict': %s", row->check,
                  cs_verdict_text(row->verdict));
    add_number(json, "figure", row->figure);
    add_number(json, "bound", row->bound);
    cs_json_write(json, ", 'note': %s}", row->note);
    output->first = false;
}

static const char *fidelity_text(uint32_t fidelity) {
    static const char *const texts[] = {"ODE", "implicit Euler in its limit", "consistent only",
                                        "another model"};
    return fidelity < sizeof texts / sizeof *texts ? texts[fidelity] : "unknown";
}

/* Name, options, order and fidelity of a method, before its first row. */
static void print_head(const struct output *output) {
    const struct cs_integrator *method = output->card->method;
    printf("%s%s%s: order %u (%u with damping), fidelity: %s\n", method->name,
           *output->settings ? ":" : "", output->settings, method->order, method->order_damped,
           fidelity_text(method->fidelity));
}

/* Called after each check. */
static void report(void *ctx, const struct cs_conform_row *row) {
    struct output *output = ctx;
    if (output->text && output->first)
        print_head(output);
    if (output->text && (!output->options->quiet || is_bad(row)))
        print_row(row, &output->error);
    add_json(output, row);
}

/* Makes the card of one method, with its options or its defaults. implicit Euler is looked up
 * by name; without it the check that needs it is skipped. */
static enum cs_status print_card(struct output *output, struct cs_registry *registry,
                                 const struct cs_integrator *method, const void *options,
                                 struct cs_error *error) {
    const struct cs_registry_entry *euler = NULL;
    struct cs_error ignored = {0};
    /* not finding it is no failure: the check that needs it is then skipped */
    if (method->fidelity != CS_FIDELITY_ODE)
        cs_registry_find(registry, "backward-euler", &euler, &ignored);
    struct cs_conform card = {
        .method = method,
        .options = options,
        .implicit_euler = euler ? euler->integrator : NULL,
        .only_check = output->options->only,
        .cache = &output->cache,
        .report = report,
        .ctx = output,
    };
    output->card = &card;
    cs_json_write(&output->json, ",\n  {'integrator': %s, 'settings': %s, 'checks': [",
                  method->name, output->settings);
    output->first = true;
    cs_conform_check(&card, error);
    output->card = NULL;
    cs_text_add(&output->json, "]}");
    for (int k = 0; k < CS_VERDICTS; k++)
        output->counts[k] += card.counts[k];
    return error->status;
}

/* True for a path or a name with the ending .so. */
static bool is_file(const char *operand) {
    const size_t length = strlen(operand);
    return strchr(operand, '/') || (length > 3 && !strcmp(operand + length - 3, ".so"));
}

/* Cards of every method of a module file. */
static enum cs_status print_file(struct output *output, struct cs_registry *registry,
                                 const char *file, struct cs_error *error) {
    const struct cs_integrator *methods[METHODS_MAX];
    const uint32_t before = registry->n;
    if (cs_registry_add_file(registry, file, error))
        return error->status;
    // copied first: finding another method may sort the entries
    uint32_t n = 0;
    for (uint32_t k = before; k < registry->n && n < METHODS_MAX; k++)
        methods[n++] = registry->entries[k].integrator;
    output->settings = "";
    for (uint32_t k = 0; k < n && !error->status; k++)
        print_card(output, registry, methods[k], NULL, error);
    return error->status;
}

/* Card of a method given as NAME or NAME:key=value,... */
static enum cs_status print_named(struct output *output, struct cs_registry *registry,
                                  const char *operand, struct cs_error *error) {
    struct cs_method method;
    const char *pairs;
    if (!cs_method_find(&method, registry, operand, &pairs, error) &&
        !cs_method_set_pairs(&method, pairs, error)) {
        output->settings = pairs ? pairs : "";
        print_card(output, registry, method.integrator, method.options, error);
    }
    cs_method_finish(&method);
    return error->status;
}

/* Writes the JSON if requested, prints the counts, and fails on failed claims. */
static enum cs_status finish(struct output *output, struct cs_error *error) {
    const char *file = output->options->json;
    cs_text_add(&output->json, "\n]\n");
    if (output->text)
        printf("%u pass, %u fail, %u expected, %u stale, %u not applicable\n",
               output->counts[CS_VERDICT_PASS], output->counts[CS_VERDICT_FAIL],
               output->counts[CS_VERDICT_EXPECTED], output->counts[CS_VERDICT_STALE],
               output->counts[CS_VERDICT_NONE]);
    if (file)
        cs_print_file(file, &output->json, error);
    if (output->error.status)
        cs_fail(error, output->error.status, "%s", output->error.message);
    const uint32_t bad = output->counts[CS_VERDICT_FAIL] + output->counts[CS_VERDICT_STALE];
    if (bad > 0)
        cs_fail(error, CS_ERR_CHECK, "%u claim%s failed", bad, bad == 1 ? "" : "s");
    return error->status;
}

static enum cs_status print_list(struct cs_error *error) {
    struct cs_text out = {0};
    cs_conform_print_checks(&out);
    return cs_print_out(stdout, &out, error);
}

static enum cs_status conform_here(void *ctx, struct cs_error *error) {
    struct cs_args *args = ctx;
    const struct options *options = args->options;
    struct cs_registry registry = {0};
    /* JSON on standard output takes the place of the text */
    struct output output = {.options = options, .text = !cs_print_is_stdout(options->json)};
    if (options->list)
        return print_list(error);
    if (args->n_operands == 0)
        return cs_fail(error, CS_ERR_USAGE, "expected an integrator or a module file");
    cs_text_add(&output.json, "[");
    cs_registry_add_files(&registry, options->plugins, options->n_plugins, error);
    for (uint32_t k = 0; k < args->n_operands && !error->status; k++) {
        if (is_file(args->operands[k]))
            print_file(&output, &registry, args->operands[k], error);
        else
            print_named(&output, &registry, args->operands[k], error);
    }
    if (!error->status)
        finish(&output, error);
    cs_text_finish(&output.json);
    cs_conform_cache_finish(&output.cache);
    cs_registry_finish(&registry);
    return error->status;
}

static enum cs_status conform(struct cs_args *args, struct cs_error *error) {
    const struct cs_isolate isolate = {
        .seconds = PATIENCE_SECONDS, .task = conform_here, .ctx = args};
    return cs_external_modules_requested(args, args->operands, args->n_operands)
               ? cs_isolate_run(&isolate, error)
               : conform_here(args, error);
}

const struct cs_command cs_command_conform = {
    .name = "conform",
    .operands = "NAME[:OPTIONS]|FILE.so ...",
    .summary = "test an integrator against the properties it claims",
    .notes = "A failed claim is expected if the integrator's descriptor names the check.\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 64,
    .main = conform,
};
