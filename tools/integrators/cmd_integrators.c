/* clothsim integrators: lists the integrators, or describes one with its options. */
#include "base/json_writer.h"
#include "base/options.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "session/session.h"
#include "study/compare/compare_cell.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_COLUMN = 22, INDENT = 4, DETAIL_COLUMN = 14 };

struct options {
    const char *family; /* of cs_family_names; NULL: all */
    uint32_t order;     /* 0: any */
    const char *json;
    const char *const *plugins; /* (n_plugins) */
    uint32_t n_plugins;
};
static const struct options initial = {.json = NULL};

static const struct cs_arg rows[] = {
    {"family", 0, "FAMILY", "only this family, such as \"adaptive implicit\"",
     CS_ARG_INTO(struct options, family), .names = cs_family_names},
    {"order", 0, "N", "only this order", CS_ARG_INTO(struct options, order), .min = 1,
     .max = 100},
    {"json", 0, "FILE", "write the list as JSON too, with all options; -: instead of the text",
     CS_ARG_INTO(struct options, json)},
    {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
     CS_ARG_LIST(struct options, plugins, n_plugins)},
    CS_ARG_PROGRAM(struct options, plugins, n_plugins),
};

static const struct {
    uint32_t trait;
    const char *text;
} traits[] = {
    {CS_IMPLICIT, "implicit"},
    {CS_ADAPTIVE, "adaptive"},
    {CS_MULTISTEP, "multistep"},
    {CS_SYMPLECTIC, "symplectic"},
    {CS_LIBRARY_BITS, "bit pattern depends on a library"},
    {CS_NOT_GALILEAN, "not Galilean"},
    {CS_SMOOTH_ONLY, "motion without contact and events only"},
    {CS_EXPLICIT_OUTER, "forces other than springs explicit"},
    {CS_MAKES_ENERGY, "makes energy at long steps"},
};

/* True if the filters let the method through. */
static bool is_wanted(const struct options *options, const struct cs_integrator *method) {
    return (!options->family || !strcmp(options->family, cs_family_of(method))) &&
           (!options->order || method->order == options->order);
}

/* The fidelity of a method in the words of clothsim-integrator(7). */
static const char *fidelity_text(uint32_t fidelity) {
    switch ((enum cs_fidelity)fidelity) {
    case CS_FIDELITY_ODE:
        return "converges to the equation of motion";
    case CS_FIDELITY_IMPLICIT_EULER:
        return "implicit Euler as its iterations grow";
    case CS_FIDELITY_CONSISTENT:
        return "consistent (converges only as dt -> 0)";
    case CS_FIDELITY_OTHER:
        return "another model: no error against the equation of motion";
    }
    return "unknown";
}

static void add_traits(uint32_t given, const char *before, struct cs_text *out) {
    for (uint32_t i = 0; i < sizeof traits / sizeof *traits; i++)
        if (given & traits[i].trait) {
            cs_text_add(out, "%s%s", before, traits[i].text);
            before = ", ";
        }
}

static void add_order(const struct cs_integrator *integrator, struct cs_text *out) {
    cs_text_add(out, "%u", integrator->order);
    if (integrator->order_damped != integrator->order)
        cs_text_add(out, " (%u with damping)", integrator->order_damped);
}

static void add_listed(const struct cs_integrator *integrator, struct cs_text *out) {
    struct cs_text source = {0};
    cs_text_add(out, "%-*s order ", NAME_COLUMN - 1, integrator->name);
    add_order(integrator, out);
    add_traits(integrator->traits, ", ", out);
    cs_text_add(out, "\n");
    cs_print_hanging("", integrator->summary, INDENT, out);
    cs_text_add(&source, "source: %s", integrator->source);
    cs_print_hanging("", cs_text_get(&source), INDENT, out);
    out->failed |= source.failed;
    cs_text_finish(&source);
}

static void add_refused(const struct cs_registry_entry *entry, struct cs_text *out) {
    cs_text_add(out, "refused: %s: %s\n", entry->file, entry->refusal);
}

static enum cs_status print_list(const struct options *options,
                                 const struct cs_registry *registry, struct cs_error *error) {
    struct cs_text out = {0};
    for (uint32_t i = 0; i < registry->n; i++) {
        const struct cs_registry_entry *entry = registry->entries + i;
        if (!entry->integrator)
            add_refused(entry, &out);
        else if (is_wanted(options, entry->integrator))
            add_listed(entry->integrator, &out);
    }
    return cs_print_out(stdout, &out, error);
}

/* One option: default and range in columns, then its meaning. */
static void add_option(const struct cs_option *row, const void *defaults, struct cs_text *out) {
    struct cs_text left = {0}, value = {0}, range = {0};
    const bool given = !cs_option_is_optional(row) || cs_option_is_set(row, defaults);
    if (!given)
        cs_text_add(&value, "not set");
    else
        cs_option_print_plain(row, defaults, &value);
    cs_option_print_range(row, &range);
    cs_text_add(&left, "%-*s%-*s%s", DETAIL_COLUMN, row->name, DETAIL_COLUMN,
                cs_text_get(&value), cs_text_get(&range));
    cs_text_add(out, "%s\n", cs_text_get(&left));
    cs_print_hanging("", row->help, 2 * DETAIL_COLUMN, out);
    out->failed |= left.failed || value.failed || range.failed;
    cs_text_finish(&left);
    cs_text_finish(&value);
    cs_text_finish(&range);
}

static enum cs_status add_options(const struct cs_integrator *integrator, struct cs_text *out,
                                  struct cs_error *error) {
    const struct cs_table table = {.rows = integrator->options,
                                   .n = integrator->n_options,
                                   .size = integrator->options_size};
    if (!table.n) {
        cs_text_add(out, "\nno options\n");
        return CS_OK;
    }
    /* defaults are printed from a struct, filled as for a run */
    void *defaults = calloc(1, table.size);
    if (!defaults)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of %s",
                       integrator->name);
    cs_options_default(&table, defaults);
    cs_text_add(out, "\n%-*s%-*s%s\n", DETAIL_COLUMN, "option", DETAIL_COLUMN, "default",
                "range");
    for (uint32_t r = 0; r < table.n; r++)
        add_option(table.rows + r, defaults, out);
    free(defaults);
    return CS_OK;
}

static enum cs_status print_one(const struct cs_registry_entry *found, struct cs_error *error) {
    const struct cs_integrator *integrator = found->integrator;
    struct cs_text out = {0}, order = {0}, list = {0};
    add_order(integrator, &order);
    add_traits(integrator->traits, "", &list);
    cs_print_hanging("name", integrator->name, DETAIL_COLUMN, &out);
    cs_print_hanging("method", integrator->summary, DETAIL_COLUMN, &out);
    cs_print_hanging("source", integrator->source, DETAIL_COLUMN, &out);
    cs_print_hanging("order", cs_text_get(&order), DETAIL_COLUMN, &out);
    cs_print_hanging("traits", list.length ? cs_text_get(&list) : "none", DETAIL_COLUMN, &out);
    if (CS_HAS(integrator, library) && integrator->library)
        cs_print_hanging("library", integrator->library, DETAIL_COLUMN, &out);
    cs_print_hanging("fidelity", fidelity_text(integrator->fidelity), DETAIL_COLUMN, &out);
    /* only a method that names checks it fails has this line */
    struct cs_text fails = {0};
    for (const char *const *check = integrator->fails; check && *check; check++)
        cs_text_add(&fails, "%s%s", fails.length ? ", " : "", *check);
    if (fails.length)
        cs_print_hanging("fails", cs_text_get(&fails), DETAIL_COLUMN, &out);
    out.failed |= order.failed || list.failed || fails.failed;
    cs_text_finish(&fails);
    cs_print_hanging("module", found->file, DETAIL_COLUMN, &out);
    cs_text_finish(&order);
    cs_text_finish(&list);
    if (!add_options(integrator, &out, error))
        return cs_print_out(stdout, &out, error);
    /* cs_print_out would have freed it */
    cs_text_finish(&out);
    return error->status;
}

/* Adds an option: default, range or names, and meaning. */
static void add_option_json(const struct cs_option *row, const void *defaults,
                            struct cs_text *out) {
    cs_json_write(out, ",\n      {'name': %s, 'unit': %s, 'help': %s, 'default': ", row->name,
                  row->unit, row->help);
    if (cs_option_is_optional(row) && !cs_option_is_set(row, defaults))
        cs_text_add(out, "null");
    else
        cs_option_print(row, defaults, out);
    if (row->type == CS_REAL || row->type == CS_INT)
        cs_json_write(out, ", 'min': %g, 'max': %g", row->min, row->max);
    cs_text_add(out, ", \"names\": [");
    for (const char *const *name = row->choices; name && *name; name++)
        cs_json_write(out, ", %s", *name);
    cs_text_add(out, "]}");
}

static enum cs_status add_json(const struct cs_registry_entry *entry, struct cs_text *out,
                               struct cs_error *error) {
    const struct cs_integrator *method = entry->integrator;
    const bool has_library = CS_HAS(method, library) && method->library;
    const struct cs_table table = {
        .rows = method->options, .n = method->n_options, .size = method->options_size};
    void *defaults = calloc(1, table.size + 1);
    if (!defaults)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of %s",
                       method->name);
    // as they are before a scene is known
    cs_options_default(&table, defaults);
    cs_json_write(out,
                  ",\n  {'name': %s, 'order': %u, 'order_damped': %u, 'summary': %s,\n"
                  "   'source': %s, 'fidelity': %s, 'library': %s, 'module': %s,\n"
                  "   'family': %s, 'traits': [",
                  method->name, method->order, method->order_damped, method->summary,
                  method->source, fidelity_text(method->fidelity),
                  has_library ? method->library : NULL, entry->file, cs_family_of(method));
    for (size_t k = 0; k < sizeof traits / sizeof *traits; k++)
        if (method->traits & traits[k].trait)
            cs_json_write(out, ", %s", traits[k].text);
    cs_text_add(out, "],\n   \"options\": [");
    for (uint32_t r = 0; r < table.n; r++)
        add_option_json(table.rows + r, defaults, out);
    cs_text_add(out, "]}");
    free(defaults);
    return CS_OK;
}

/* Writes n entries as JSON, those that can be used and that the filters let through. */
static enum cs_status print_json(const struct options *options,
                                 const struct cs_registry_entry *entries, uint32_t n,
                                 struct cs_error *error) {
    struct cs_text out = {0};
    cs_text_add(&out, "[");
    for (uint32_t k = 0; k < n && !error->status; k++)
        if (entries[k].integrator && is_wanted(options, entries[k].integrator))
            add_json(entries + k, &out, error);
    cs_text_add(&out, "\n]\n");
    if (error->status)
        cs_text_finish(&out);
    else
        cs_print_file(options->json, &out, error);
    return error->status;
}

/* Describes n entries. */
static enum cs_status print_entries(const struct options *options,
                                    const struct cs_registry_entry *entries, uint32_t n,
                                    struct cs_error *error) {
    for (uint32_t k = 0; k < n && !cs_print_is_stdout(options->json) && !error->status; k++)
        print_one(entries + k, error);
    if (!error->status && options->json)
        print_json(options, entries, n, error);
    return error->status;
}

/* All of the folders. */
static enum cs_status print_all(const struct options *options, struct cs_registry *registry,
                                struct cs_error *error) {
    if (cs_registry_open_all(registry, error))
        return error->status;
    if (!cs_print_is_stdout(options->json))
        print_list(options, registry, error);
    if (!error->status && options->json)
        print_json(options, registry->entries, registry->n, error);
    return error->status;
}

/* Every method of a module file. */
static enum cs_status print_file(const struct options *options, struct cs_registry *registry,
                                 const char *file, struct cs_error *error) {
    const uint32_t before = registry->n;
    if (cs_registry_add_file(registry, file, error))
        return error->status;
    return print_entries(options, registry->entries + before, registry->n - before, error);
}

static enum cs_status list(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const char *operand = args->n_operands ? args->operands[0] : NULL;
    const struct cs_registry_entry *found;
    struct cs_registry registry = {0};
    if (operand && (options->family || options->order))
        return cs_fail(error, CS_ERR_USAGE,
                       "--family and --order choose from the list, found \"%.60s\" too",
                       operand);
    if (!cs_registry_add_files(&registry, options->plugins, options->n_plugins, error)) {
        if (operand && cs_names_code(operand))
            print_file(options, &registry, operand, error);
        else if (operand && !cs_registry_find(&registry, operand, &found, error))
            print_entries(options, found, 1, error);
        else if (!operand)
            print_all(options, &registry, error);
    }
    cs_registry_finish(&registry);
    return error->status;
}

const struct cs_command cs_command_integrators = {
    .name = "integrators",
    .operands = "[NAME|FILE.so]",
    .summary = "list the integrators, or describe one and its options",
    .notes = "Modules are loaded from the program's module folder and the folders of\n"
             "CLOTHSIM_PLUGIN_PATH (absolute, separated by colons).\n\n"
             "Example: clothsim integrators --family explicit --order 4\n",
    CS_COMMAND_OPTIONS(rows, initial),
    .operands_min = 0,
    .operands_max = 1,
    .main = list,
};
