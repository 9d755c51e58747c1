/* clothsim stability: maps which steps a method survives, as text, CSV, JSON and a picture. */
#include "base/json_writer.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/stability_map.h"
#include "sim/folders.h"
#include "study/stability/extreme.h"

#include <stdio.h>
#include <string.h>

/* Where the rows of the catalogue go. */
struct sink {
    const struct cs_args *args;
    struct cs_text json;
};

static bool takes_stdout(const struct cs_args *args) {
    const char *json = cs_args_get(args, STABILITY_JSON);
    return json && !strcmp(json, "-");
}

static void add_json(const struct cs_extreme_row *row, struct cs_text *out) {
    cs_json_write(out,
                  ",\n    {'scene': %s, 'method': %s, 'expected': %s, 'verdict': %s, "
                  "'message': %s, 'met': %d, 'seconds': ",
                  row->scene, row->method, row->expected, cs_stability_word(row->verdict),
                  row->message, row->met);
    cs_text_add(out, "%.3g}", row->seconds);
}

static void print_extreme(void *ctx, const struct cs_extreme_row *row) {
    struct sink *sink = ctx;
    add_json(row, &sink->json);
    if ((row->met && cs_args_get(sink->args, STABILITY_QUIET)) || takes_stdout(sink->args))
        return;
    printf("%-6s %-16s %-20s %-18s expected %-24s %6.2f s%s%s\n", row->met ? "ok" : "MISSED",
           row->scene, row->method, cs_stability_word(row->verdict), row->expected,
           row->seconds, *row->message ? "  " : "", row->message);
    fflush(stdout);
}

/* What was missed is an error of its own, which stays. */
static void write_json(const struct cs_extreme *extreme, struct sink *sink,
                       struct cs_error *error) {
    const char *path = cs_args_get(sink->args, STABILITY_JSON);
    struct cs_text out = {0};
    struct cs_error failure = {0};
    if (path) {
        cs_json_write(&out, "{\n  'met': %u, 'missed': %u,\n  'rows': [", extreme->met,
                      extreme->missed);
        cs_text_add(&out, "%s\n  ]\n}\n", cs_text_get(&sink->json));
        out.failed |= sink->json.failed;
        if (cs_print_file(path, &out, &failure))
            *error = failure;
    }
}

static enum cs_status run_extreme(struct cs_args *args,
                                  const struct cs_stability_settings *settings,
                                  const char *const *methods, uint32_t n_methods,
                                  struct cs_error *error) {
    const char *folder = cs_args_get(args, STABILITY_FOLDER);
    char installed[CS_DATA_PATH_MAX];
    const bool all = n_methods == 1 && !strcmp(methods[0], "all");
    struct sink sink = {.args = args};
    struct cs_extreme extreme = {
        .folder = folder ? folder : cs_data_find("scenes/extreme", installed, sizeof installed),
        .only_scene = args->n_operands ? args->operands[0] : NULL,
        .methods = methods,
        /* 0 stands for every method that can be used */
        .n_methods = all ? 0 : n_methods,
        .plugins = settings->session.plugins,
        .n_plugins = settings->session.n_plugins,
        .budget = settings->budget,
        .n_workers = settings->workers,
        .stop = settings->session.run.stop,
        .report = print_extreme,
        .ctx = &sink,
    };
    cs_extreme_run(&extreme, error);
    /* CS_ERR_CHECK says that an expectation was missed: the counts are valid */
    if (!error->status || error->status == CS_ERR_CHECK)
        write_json(&extreme, &sink, error);
    cs_text_finish(&sink.json);
    if ((!error->status || error->status == CS_ERR_CHECK) && !takes_stdout(args))
        printf("%u as expected, %u not\n", extreme.met, extreme.missed);
    return error->status;
}

/* Two maps of one name would be one file. */
static enum cs_status check_apart(const char *const *methods, uint32_t n,
                                  struct cs_error *error) {
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = 0; i < k; i++) {
            char names[2][CS_SERIES_BYTES];
            const char *of[] = {methods[i], methods[k]};
            if (cs_series_take_name(of, names[0], error) ||
                cs_series_take_name(of + 1, names[1], error))
                return error->status;
            if (*names[0] && !strcmp(names[0], names[1]) && strcmp(of[0], of[1]) != 0)
                return cs_fail(error, CS_ERR_USAGE,
                               "series \"%s\" is %.60s and %.60s: give one of them another "
                               "name",
                               names[0], of[0], of[1]);
        }
    return CS_OK;
}

/* One map, or those of all methods. */
static enum cs_status map(const struct cs_args *args, struct cs_stability_settings *settings,
                          const char *method, const char *folder, struct cs_error *error) {
    char series[CS_SERIES_BYTES];
    if (cs_series_take_name(&method, series, error))
        return error->status;
    settings->session.integrator = method;
    settings->series = series;
    return strcmp(method, "all") != 0 ? cs_stability_map_one(args, settings, folder, error)
                                      : cs_stability_map_all(args, settings, folder, error);
}

static enum cs_status stability(struct cs_args *args, struct cs_error *error) {
    struct cs_stability_settings settings;
    const char *folder = cs_args_get(args, STABILITY_OUT);
    const char *const *methods;
    uint32_t n_methods;
    if (cs_stability_read(args, &settings, error) ||
        cs_args_methods(args, STABILITY_INTEGRATORS, &methods, &n_methods, error))
        return error->status;
    /* before the operand is checked: here it is only part of a name, and may be absent */
    if (cs_args_get(args, STABILITY_EXTREME))
        return run_extreme(args, &settings, methods, n_methods, error);
    if (!settings.session.scene)
        return cs_fail(error, CS_ERR_USAGE,
                       "expected SCENE or --extreme (see: clothsim stability --help)");
    folder = folder ? folder : "stability";
    /* no method named: the scene's own */
    if (!n_methods)
        return cs_stability_map_one(args, &settings, folder, error);
    check_apart(methods, n_methods, error);
    for (uint32_t k = 0; k < n_methods && !error->status; k++)
        map(args, &settings, methods[k], folder, error);
    return error->status;
}

const struct cs_command cs_command_stability = {
    .name = "stability",
    .operands = "[SCENE]",
    .summary = "map which steps a method survives, beside linear theory",
    .notes = "An unstable cell is a result: the exit code is 0.\n\n"
             "Example: clothsim stability scenes/hang.json -i symplectic-euler\n",
    .rows = cs_stability_rows,
    .n_rows = STABILITY_ROWS,
    .least = 0,
    .most = 1,
    .main = stability,
};
