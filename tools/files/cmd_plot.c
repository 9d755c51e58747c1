/* clothsim plot: draws a table that the program wrote.
 *
 *   FILE -> a comparison: cells -> cs_plot_make; a stability map: cs_table_plot_read; other
 *   numbers, of which a spectrum may be made: cs_table_lines_add
 *   -> the terminal, or NAME.png, NAME.svg, NAME.pdf */
#include "base/file.h"
#include "base/install_paths.h"
#include "cli/commands.h"
#include "cli/file_conflicts.h"
#include "cli/line/print.h"
#include "cli/show/screen.h"
#include "files/force_length.h"
#include "files/particle_read.h"
#include "files/spectrum.h"
#include "files/table_lines.h"
#include "study/compare/compare_curves.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct options {
    const char *x, *y, *family, *methods, *log_axes, *out, *title, *stretch;
    double width;
    uint32_t particle, formats; /* 1 << cs_format; 0: all */
    bool spectrum, show, quiet;
};
static const struct options defaults = {
    .width = CS_WIDTH_PAGE, .log_axes = "", .particle = UINT32_MAX};

static const struct cs_arg rows[] = {
    {"x", 0, "COLUMN",
     "column of the x axis (default: work and cpu of a comparison, t of other tables)",
     CS_ARG_INTO(struct options, x)},
    {"y", 0, "COLUMN,...",
     "column of the y axis (default: error); other tables than comparisons take several "
     "(default: all, a panel per unit)",
     CS_ARG_INTO(struct options, y)},
    {"family", 0, "FAMILY",
     "all series of one family, such as \"adaptive implicit\" (default: the twelve nearest to "
     "the front)",
     CS_ARG_INTO(struct options, family), .names = cs_family_names},
    {"methods", 0, "NAME,...", "only these methods or series",
     CS_ARG_INTO(struct options, methods)},
    {"log", 0, "AXES", "x, y or xy: logarithmic axes, of tables other than comparisons",
     CS_ARG_INTO(struct options, log_axes)},
    {"spectrum", 0, NULL,
     "draw amplitudes over the frequency instead, and name the lowest frequencies",
     CS_ARG_INTO(struct options, spectrum)},
    {"particle", 0, "N", "motion of particle N of a run.npz, of run --export npz",
     CS_ARG_INTO(struct options, particle), .max = UINT32_MAX - 1},
    {"stretch", 0, "LOW..HIGH",
     "force of the first body of a scene against its length along x, relative to the start",
     CS_ARG_INTO(struct options, stretch)},
    {"width", 0, "MM", "width in print (default: 180, two columns of a journal; 88 is one)",
     CS_ARG_INTO(struct options, width)},
    {"format", 0, "NAME,...", "any of png, svg and pdf (default: all)",
     CS_ARG_INTO(struct options, formats), .names = cs_format_names, .repeatable = true},
    {"out", 'o', "NAME",
     "write NAME.png, NAME.svg and NAME.pdf (default: FILE without its ending; of a comparison "
     "Y_X[_FAMILY] in its folder where these are given)",
     CS_ARG_INTO(struct options, out)},
    {"title", 0, "TEXT", "title above the diagram (default: FILE)",
     CS_ARG_INTO(struct options, title)},
    {"show", 0, NULL, "draw the diagram in the terminal, and write no files",
     CS_ARG_INTO(struct options, show)},
    CS_ARG_QUIET(struct options, quiet),
};

static enum cs_status read_axis(const char *option, const char *name,
                                const struct cs_column **column, struct cs_error *error) {
    *column = cs_column_find(name);
    return *column && (*column)->drawn
               ? CS_OK
               : cs_arg_refuse_name(option, cs_column_axes(), name, error);
}

static bool is_of_particle(const struct options *options) {
    return options->particle != UINT32_MAX;
}

/* NAME of the files: --out, Y_X[_FAMILY] of a comparison, or FILE without its ending and with
 * what is computed from it. */
static void find_name(const struct cs_args *args, const struct cs_plot_settings *settings,
                      char name[4096]) {
    const struct options *options = args->options;
    const char *file = args->operands[0], *slash = strrchr(file, '/'),
               *dot = strrchr(file, '.');
    const int folder = slash ? (int)(slash - file) + 1 : 0;
    if (options->out)
        snprintf(name, 4096, "%s", options->out);
    else if (settings->cells && (options->x || options->y || options->family)) {
        snprintf(name, 4096, "%.*s%s_%s%s%s", folder, file, settings->y->name,
                 settings->x->name, options->family ? "_" : "",
                 options->family ? options->family : "");
        /* families have blanks */
        for (char *c = name + folder; *c; c++)
            *c = *c == ' ' ? '-' : *c;
    } else
        snprintf(name, 4096, "%.*s%s%s", dot && dot >= file + folder ? (int)(dot - file) : 4000,
                 file, options->stretch || is_of_particle(options) ? "-" : "",
                 options->stretch          ? "stretch"
                 : is_of_particle(options) ? "particle"
                                           : "");
    if (!options->out && options->spectrum)
        strncat(name, "-spectrum", 4095 - strlen(name));
}

static enum cs_status show(const struct cs_diagram *diagram, struct cs_error *error) {
    struct cs_screen screen;
    struct cs_text text = {0};
    if (cs_screen_open(&screen, false, error))
        return error->status;
    cs_screen_print_diagram(&screen, diagram, &text);
    return cs_print_raw(stdout, &text, error);
}

/* Refuses a diagram of the name of its table. */
static enum cs_status check_names(const char *table, const char *name, unsigned formats,
                                  struct cs_error *error) {
    for (int k = 0; k < CS_FORMATS && !error->status; k++) {
        char path[4096 + 8];
        snprintf(path, sizeof path, "%s.%s", name, cs_format_names[k]);
        if (formats >> k & 1)
            cs_file_conflicts_pair(path, "--out", table, "the table", error);
    }
    return error->status;
}

/* Writes NAME.csv: the numbers that were computed for the diagram. */
static enum cs_status write_table(const struct cs_number_table *table, const char *table_file,
                                  const char *name, struct cs_error *error) {
    struct cs_text text = {0};
    char path[4096 + 8];
    snprintf(path, sizeof path, "%s.csv", name);
    if (cs_file_conflicts_pair(path, "--out", table_file, "the table", error))
        return error->status;
    for (uint32_t c = 0; c < table->columns; c++)
        cs_text_add(&text, "%s%s", c ? "," : "", table->names[c]);
    for (uint32_t r = 0; r < table->rows; r++)
        for (uint32_t c = 0; c < table->columns; c++) {
            char number[CS_REAL_DIGITS];
            cs_print_real(cs_number_table_at(table, r, c), number);
            cs_text_add(&text, "%s%s", c ? "," : "\n", number);
        }
    cs_text_add(&text, "\n");
    cs_file_write_text(path, &text, error);
    cs_text_finish(&text);
    return error->status;
}

/* computed: for the diagram; NULL: it draws the file's own numbers */
static enum cs_status finish(struct cs_args *args, const struct cs_diagram *diagram,
                             const struct cs_plot_settings *settings,
                             const struct cs_number_table *computed, struct cs_error *error) {
    const struct options *options = args->options;
    char name[4096];
    const unsigned formats = options->formats ? options->formats : CS_FORMATS_ALL;
    struct cs_text text = {0};
    if (options->show)
        return show(diagram, error);
    find_name(args, settings, name);
    const char *slash = strrchr(name, '/');
    if (!*name || (slash && !slash[1]))
        return cs_fail(error, CS_ERR_USAGE, "--out: expected a file name without extension");
    /* nothing is written over the table */
    if (check_names(args->operands[0], name, formats, error) ||
        (computed && write_table(computed, args->operands[0], name, error)) ||
        cs_diagram_write(cs_renderer_folder(), diagram, name, formats, error) || options->quiet)
        return error->status;
    for (int k = 0; k < CS_FORMATS; k++)
        if (formats >> k & 1)
            cs_text_add(&text, "%s%s.%s", text.length ? ", " : "", name, cs_format_names[k]);
    if (computed)
        cs_text_add(&text, ", %s.csv", name);
    cs_text_add(&text, "\n");
    return cs_print_out(stdout, &text, error);
}

/* The first name of "a,b" that no cell has; a series may have commas itself. NULL: none. */
static const char *find_unknown(const char *list, const struct cs_cell *cells, uint32_t n) {
    for (size_t most; list && *list; list += most + (list[most] == ',')) {
        most = 0;
        for (uint32_t k = 0; k < 2 * n; k++) {
            const char *name = k < n ? cells[k].series : cells[k - n].method;
            const size_t length = strlen(name);
            if (!strncmp(list, name, length) && strchr(",", list[length]) && length > most)
                most = length;
        }
        if (!most)
            return list;
    }
    return NULL;
}

/* Keeps the cells of the family and methods that were given. Fails if there are none, or none
 * of a method: an empty diagram would hide a mistake in a name. */
static enum cs_status select_cells(const struct options *options, const char *file,
                                   struct cs_cell *cells, uint32_t *n, struct cs_error *error) {
    const char *family = options->family, *methods = options->methods,
               *unknown = find_unknown(methods, cells, *n);
    const uint32_t all = *n;
    *n = 0;
    for (uint32_t k = 0; k < all; k++)
        if ((!family || !strcmp(family, cells[k].family)) &&
            (!methods || cs_list_has(methods, cells[k].series) ||
             cs_list_has(methods, cells[k].method)))
            cells[(*n)++] = cells[k];
    if (!all)
        return cs_fail(error, CS_ERR_FILE, "%s: found no rows below names of columns", file);
    if (unknown)
        return cs_fail(error, CS_ERR_USAGE, "--methods: found no \"%.*s\" series in %s",
                       (int)strcspn(unknown, ","), unknown, file);
    return *n ? CS_OK
              : cs_fail(error, CS_ERR_USAGE, "--family: found no \"%s\" series in %s%s", family,
                        file, methods ? " of --methods" : "");
}

static enum cs_status plot_comparison(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    struct cs_plot_settings settings = {.all = options->family || options->methods,
                                        .title =
                                            options->title ? options->title : args->operands[0],
                                        .width = options->width};
    struct cs_diagram plot = {0};
    struct cs_cell *cells;
    if (read_axis("x", options->x ? options->x : "work", &settings.x, error) ||
        read_axis("y", options->y ? options->y : "error", &settings.y, error) ||
        cs_csv_read(args->operands[0], true, &cells, &settings.n, error))
        return error->status;
    settings.cells = cells;
    /* a terminal has room for one panel */
    settings.second = options->x || options->show ? NULL : cs_column_find("cpu");
    if (!select_cells(options, args->operands[0], cells, &settings.n, error) &&
        !cs_plot_make(&plot, &settings, error))
        finish(args, &plot, &settings, NULL, error);
    cs_plot_finish(&plot);
    free(cells);
    return error->status;
}

/* Replaces the table by its spectrum, and draws it with its lowest frequencies. */
static enum cs_status add_spectrum(struct cs_diagram *plot, struct cs_number_table *table,
                                   const struct cs_line_settings *lines, uint32_t particle,
                                   struct cs_error *error) {
    double seconds;
    char name[32];
    const bool joint = particle != UINT32_MAX;
    snprintf(name, sizeof name, "particle %u", particle);
    if (cs_spectrum_make(table, joint ? name : NULL, &seconds, &plot->arena, error) ||
        cs_table_lines_add(plot, table, lines, error))
        return error->status;
    for (struct cs_panel *p = plot->panels; p < plot->panels + plot->n_panels; p++) {
        char label[CS_LABEL_BYTES];
        snprintf(label, sizeof label, "%s", p->y.label);
        snprintf(p->y.label, CS_LABEL_BYTES, "amplitude %s%.140s", joint ? "in m" : "of ",
                 joint ? "" : label);
    }
    cs_spectrum_add_peaks(plot, table, seconds);
    return CS_OK;
}

/* Reads or makes the table that the options ask for: of a particle, of a force, or the file. */
static enum cs_status open_table(const struct cs_args *args, struct cs_diagram *plot,
                                 struct cs_number_table *table, struct cs_error *error) {
    const struct options *options = args->options;
    const char *file = args->operands[0];
    double low, high;
    if (is_of_particle(options))
        return cs_particle_read(file, options->particle, &plot->arena, table, error);
    if (!options->stretch)
        return cs_table_plot_read(plot, table, file, error);
    if (!cs_parse_range(options->stretch, &low, &high) || !(low < high && high <= 100))
        return cs_fail(error, CS_ERR_USAGE,
                       "--stretch: expected LOW..HIGH, both above 0 and up to 100, found "
                       "\"%.60s\"",
                       options->stretch);
    return cs_force_length_measure(file, low, high, &plot->arena, table, error);
}

static enum cs_status plot_table(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const bool computed = options->spectrum || options->stretch || is_of_particle(options);
    const struct cs_line_settings lines = {options->x, options->y, options->log_axes,
                                           args->operands[0]};
    struct cs_diagram plot;
    struct cs_number_table table;
    cs_plot_begin(&plot, options->title ? options->title : args->operands[0], options->width);
    if (!open_table(args, &plot, &table, error)) {
        /* a map has its panel already */
        if (plot.n_panels && options->spectrum)
            cs_fail(error, CS_ERR_USAGE, "--spectrum: a stability map has none");
        else if (options->spectrum)
            add_spectrum(&plot, &table, &lines, options->particle, error);
        else if (!plot.n_panels)
            cs_table_lines_add(&plot, &table, &lines, error);
        if (!error->status && is_of_particle(options) && !options->spectrum)
            snprintf(plot.panels->y.label, CS_LABEL_BYTES, "position in m");
        if (!error->status)
            finish(args, &plot, &(struct cs_plot_settings){0}, computed ? &table : NULL, error);
    }
    cs_plot_finish(&plot);
    return error->status;
}

/* True for the table of a comparison, which begins with the name of the series. */
static enum cs_status find_kind(const char *path, bool *comparison, struct cs_error *error) {
    struct cs_rows file;
    if (cs_rows_open(&file, path, 0, error))
        return error->status;
    const char *names = cs_rows_next(&file);
    *comparison = names && (!strncmp(names, "series,method", strlen("series,method")) ||
                            !strncmp(names, "method", strlen("method")));
    cs_rows_close(&file);
    return CS_OK;
}

static enum cs_status plot(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    static const char *const of_comparisons[] = {"family", "methods"}, *const of_others[] = {
                                                                           "log", "spectrum"};
    const char *ending = strrchr(args->operands[0], '.');
    bool comparison = false;
    if (options->show && options->out)
        return cs_fail(error, CS_ERR_USAGE, "--show writes no files: remove --show or --out");
    if (!(options->width >= 40 && options->width <= 1000))
        return cs_fail(error, CS_ERR_USAGE, "--width: expected 40 to 1000 mm, found %g",
                       options->width);
    if (options->log_axes[strspn(options->log_axes, "xy")])
        return cs_fail(error, CS_ERR_USAGE, "--log: expected x, y or xy, found \"%.60s\"",
                       options->log_axes);
    const bool computed = options->stretch || is_of_particle(options);
    if (!computed && ending && !strcmp(ending, ".npz"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--particle: an archive of a run needs the number of one");
    if (cs_args_refuse_both(args, "stretch", "particle", error) ||
        cs_args_refuse_both(args, "stretch", "spectrum", error) ||
        (!computed && find_kind(args->operands[0], &comparison, error)))
        return error->status;
    for (int k = 0; k < 2; k++) {
        const char *option = (comparison ? of_others : of_comparisons)[k];
        if (cs_args_is_given(args, option))
            return cs_fail(error, CS_ERR_USAGE, "--%s: %s is %s comparison: remove it", option,
                           args->operands[0], comparison ? "a" : "no");
    }
    return (comparison ? plot_comparison : plot_table)(args, error);
}

const struct cs_command cs_command_plot = {
    .name = "plot",
    .operands = "FILE",
    .summary = "draw a comparison, a stability map, or a table of a run",
    .notes = "Examples: clothsim plot compare/compare.csv --x evals --y max_error\n"
             "          clothsim plot out/monitor.csv --y kinetic,elastic --width 88\n"
             "          clothsim plot out/run.npz --particle 12 --spectrum --log y\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = plot,
};
