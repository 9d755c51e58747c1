/* clothsim conform: prints a method's conformance card as text or JSON.
 *
 *   operands (NAME:options or module files) -> registry -> per method: cs_conform_check
 *   -> a line per check as it ends -> counts -> exit status
 * Expected failures pass; failed claims and stale declarations make the command fail. Foreign
 * modules run in a process of their own. Where a check ends it, the check fails, and the next
 * process goes on behind it. */
#include "base/json_writer.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/run_folder.h"
#include "conform/conform.h"
#include "conform/conform_checks.h"
#include "session/process_pool.h"
#include "session/session.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NOTE_COLUMN = 55, METHODS_MAX = 64 };
/* s that a call may take, at first and after one that took longer, and after a signal to stop
 */
enum { PATIENCE_SECONDS = 60, SECOND_PATIENCE_SECONDS = 10, STOP_SECONDS = 1 };

struct options {
    const char *json, *only;
    double isolate; /* s; 0: PATIENCE_SECONDS, and only for foreign modules */
    bool list, quiet, fail_fast;
    const char *const *plugins; /* (n_plugins) */
    uint32_t n_plugins;
};
static const struct options defaults = {.json = NULL};

static const struct cs_arg rows[] = {
    {"fail-fast", 0, NULL, "stop a card at its first failed claim",
     CS_ARG_INTO(struct options, fail_fast)},
    {"isolate", 0, "SECONDS",
     "run in a separate process, and end it if one call of the method takes longer (default: "
     "60, for modules that were not installed with the program)",
     CS_ARG_INTO(struct options, isolate)},
    {"json", 0, "FILE", "write the card as JSON too; -: instead of the text",
     CS_ARG_INTO(struct options, json)},
    {"list", 0, NULL, "list the checks", CS_ARG_INTO(struct options, list)},
    {"only", 0, "CHECK[,...]", "run only these checks", CS_ARG_INTO(struct options, only),
     .names = cs_conform_check_names},
    {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
     CS_ARG_LIST(struct options, plugins, n_plugins)},
    CS_ARG_PROGRAM(struct options, plugins, n_plugins),
    CS_ARG_QUIET(struct options, quiet),
};

/* The rows so far. With a process for the modules both have it in memory that they share; where
 * that process dies, the next one skips what is done. */
struct progress {
    uint32_t n_done;      /* rows that were reported, over all cards */
    uint32_t heads, ends; /* cards that were begun and finished */
    bool in_list;         /* the JSON of this card has a row */
    const char *check;    /* under way: a constant text; NULL: none */
    uint32_t counts[CS_VERDICTS];
};

/* Destination of the cards; each row is printed when its check is done. */
struct output {
    const struct cs_args *args;
    const struct options *options;
    const struct cs_conform *conform; /* that is being made */
    const char *settings;             /* options as given after the method's name */
    struct progress *progress;
    uint32_t n_rows, n_cards;      /* met by this process */
    FILE *json;                    /* a file without a name; NULL: none was asked for */
    struct cs_conform_cache cache; /* shared by all cards of a process */
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

/* Appends to the JSON, whichever process writes, and frees the text. */
static void append(struct output *output, struct cs_text *json) {
    if (output->json && (json->failed || fseek(output->json, 0, SEEK_END) ||
                         fputs(cs_text_get(json), output->json) < 0 || fflush(output->json)))
        cs_fail(&output->error, CS_ERR_FILE, "cannot store the card as JSON");
    cs_text_finish(json);
}

static const char *fidelity_text(uint32_t fidelity) {
    static const char *const texts[] = {"ODE", "implicit Euler in its limit", "consistent only",
                                        "another model"};
    return fidelity < sizeof texts / sizeof *texts ? texts[fidelity] : "unknown";
}

/* True where rows are printed: JSON on standard output takes the place of the text. */
static bool has_text(const struct output *output) {
    return !cs_print_is_stdout(output->options->json);
}

/* Name, options, order and fidelity of a method, before its first row. */
static void print_head(struct output *output) {
    const struct cs_integrator *method = output->conform->method;
    struct cs_text json = {0};
    cs_text_add(&json, output->n_cards > 1 ? ",\n" : "\n");
    cs_json_write(&json, "  {'integrator': %s, 'settings': %s, 'checks': [", method->name,
                  output->settings);
    append(output, &json);
    output->progress->heads++;
    output->progress->in_list = false;
    if (has_text(output))
        printf("%s%s%s: order %u (%u with damping), fidelity: %s\n", method->name,
               *output->settings ? ":" : "", output->settings,
               cs_method_order(method, output->conform->options, false),
               cs_method_order(method, output->conform->options, true),
               fidelity_text(method->fidelity));
    fflush(stdout);
}

/* Called before each check: false for one that an earlier process has reported. */
static bool begin(void *ctx, const char *check) {
    struct output *output = ctx;
    if (output->n_rows++ < output->progress->n_done)
        return false;
    if (output->progress->heads < output->n_cards)
        print_head(output);
    output->progress->check = check;
    return true;
}

/* Called after each check. */
static void report(void *ctx, const struct cs_conform_row *row) {
    struct output *output = ctx;
    struct progress *progress = output->progress;
    struct cs_text json = {0};
    if (has_text(output) && (!output->options->quiet || is_bad(row)))
        print_row(row, &output->error);
    cs_text_add(&json, progress->in_list ? ",\n" : "\n");
    cs_json_write(&json, "    {'check': %s, 'verdict': %s", row->check,
                  cs_verdict_text(row->verdict));
    add_number(&json, "figure", row->figure);
    add_number(&json, "bound", row->bound);
    cs_json_write(&json, ", 'note': %s}", row->note);
    append(output, &json);
    progress->in_list = true;
    progress->counts[row->verdict]++;
    progress->check = NULL;
    progress->n_done++;
}

/* Ends the JSON of a card. */
static void end_card(struct output *output) {
    struct cs_text end = {0};
    cs_text_add(&end, "]}");
    append(output, &end);
    output->progress->ends++;
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
    struct cs_conform conform = {
        .method = method,
        .options = options,
        .implicit_euler = euler ? euler->integrator : NULL,
        .only_checks = output->options->only,
        .fail_fast = output->options->fail_fast,
        .cache = &output->cache,
        .stop = cs_interrupt_catch(),
        .begin = begin,
        .report = report,
        .ctx = output,
    };
    output->conform = &conform;
    output->n_cards++;
    cs_conform_check(&conform, error);
    output->conform = NULL;
    if (!error->status && output->progress->ends < output->n_cards)
        end_card(output);
    return error->status;
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

/* Writes the JSON if requested, prints the counts, and fails on failed claims; also of what was
 * done before an interrupt. */
static enum cs_status finish(struct output *output, struct cs_error *error) {
    const uint32_t *counts = output->progress->counts;
    struct cs_text json = {0};
    if (output->progress->ends < output->progress->heads)
        end_card(output);
    if (has_text(output))
        printf("%u pass, %u fail, %u expected, %u stale, %u not applicable\n",
               counts[CS_VERDICT_PASS], counts[CS_VERDICT_FAIL], counts[CS_VERDICT_EXPECTED],
               counts[CS_VERDICT_STALE], counts[CS_VERDICT_NONE]);
    // what all processes have appended, in brackets
    if (output->json) {
        char piece[4096];
        cs_text_add(&json, "[");
        if (fseek(output->json, 0, SEEK_SET))
            cs_fail(error, CS_ERR_FILE, "cannot read the card as JSON");
        for (size_t n; (n = fread(piece, 1, sizeof piece - 1, output->json)) > 0;) {
            piece[n] = 0;
            cs_text_add(&json, "%s", piece);
        }
        cs_text_add(&json, "\n]\n");
        if (!error->status)
            cs_print_file(output->options->json, &json, error);
        cs_text_finish(&json);
    }
    const uint32_t bad = counts[CS_VERDICT_FAIL] + counts[CS_VERDICT_STALE];
    if (bad > 0)
        cs_fail(error, CS_ERR_CHECK, "%u claim%s failed", bad, bad == 1 ? "" : "s");
    return error->status;
}

static enum cs_status print_list(struct cs_error *error) {
    struct cs_text out = {0};
    cs_conform_print_checks(&out);
    return cs_print_out(stdout, &out, error);
}

/* Makes all cards, but for the rows that are done. */
static enum cs_status print_cards(void *ctx, struct cs_error *error) {
    struct output *output = ctx;
    const struct options *options = output->options;
    struct cs_registry registry = {0};
    cs_registry_add_files(&registry, options->plugins, options->n_plugins, error);
    for (uint32_t k = 0; k < output->args->n_operands && !error->status; k++) {
        if (cs_names_code(output->args->operands[k]))
            print_file(output, &registry, output->args->operands[k], error);
        else
            print_named(output, &registry, output->args->operands[k], error);
    }
    if (output->error.status)
        cs_fail(error, output->error.status, "%s", output->error.message);
    cs_conform_cache_finish(&output->cache);
    cs_registry_finish(&registry);
    return error->status;
}

/* The same in one process after another: one that dies fails its check. A method that hangs is
 * given less time from then on, so that a card comes to an end. */
static enum cs_status print_isolated(struct output *output, struct cs_error *error) {
    struct cs_isolate isolate = {.seconds = output->options->isolate,
                                 .stop_seconds = STOP_SECONDS,
                                 .task = print_cards,
                                 .ctx = output,
                                 .stop = cs_interrupt_catch()};
    if (!(isolate.seconds > 0))
        isolate.seconds = PATIENCE_SECONDS;
    for (;;) {
        struct cs_error death = {0};
        struct cs_conform_row row = {
            .verdict = CS_VERDICT_FAIL, .figure = (double)NAN, .bound = (double)NAN};
        cs_isolate_run(&isolate, &death);
        row.check = output->progress->check;
        // done, or what is no fault of a check: usage, memory, a module that cannot be loaded
        if ((death.status != CS_ERR_MODULE && death.status != CS_ERR_INTERNAL) || !row.check) {
            *error = death;
            return error->status;
        }
        snprintf(row.note, sizeof row.note, "%.*s", (int)sizeof row.note - 1, death.message);
        report(output, &row);
        isolate.seconds = fmin(isolate.seconds, SECOND_PATIENCE_SECONDS);
    }
}

static enum cs_status conform(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    struct output output = {.args = args, .options = options};
    if (options->list)
        return print_list(error);
    if (args->n_operands == 0)
        return cs_fail(error, CS_ERR_USAGE, "expected an integrator or a module file");
    const struct cs_session_settings modules = {
        .scene = "", .plugins = args->operands, .n_plugins = args->n_operands};
    if (cs_study_output_check(&modules, options->json, "--json", error))
        return error->status;
    output.progress = cs_process_pool_shared_alloc(sizeof *output.progress, error);
    if (options->json && !(output.json = tmpfile()))
        cs_fail(error, CS_ERR_FILE, "cannot make a temporary file: %s", strerror(errno));
    if (!error->status && (options->isolate > 0 || cs_external_modules_requested(
                                                       args, args->operands, args->n_operands)))
        print_isolated(&output, error);
    else if (!error->status)
        print_cards(&output, error);
    struct cs_error later = {0};
    if (!error->status || (error->status == CS_ERR_INTERRUPT && output.progress->heads))
        finish(&output, &later);
    cs_fail(error, later.status, "%s", later.message);
    if (output.json)
        fclose(output.json);
    cs_process_pool_shared_free(output.progress, sizeof *output.progress);
    return error->status;
}

const struct cs_command cs_command_conform = {
    .name = "conform",
    .operands = "NAME[:OPTIONS]|FILE.so ...",
    .summary = CS_SUMMARY_conform,
    .notes = "A failed claim is expected if the integrator's descriptor names the check.\n\n"
             "Example: clothsim conform velocity-verlet --only order\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 64,
    .main = conform,
};
