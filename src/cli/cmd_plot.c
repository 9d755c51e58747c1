/* clothsim plot: draws two columns of a comparison against each other.
 *
 *   compare.csv -> cells -> columns of the axes -> cs_plot_write: NAME.gp and pictures */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/show/screen.h"
#include "study/compare/compare_cell.h"
#include "study/compare/compare_curves.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct options {
    const char *x, *y, *family, *out, *title;
    bool show, quiet;
};
static const struct options defaults = {.x = "cpu", .y = "error"};

static const struct cs_arg rows[] = {
    {"x", 0, "COLUMN", "column of the x axis (default: cpu)", CS_ARG_INTO(struct options, x)},
    {"y", 0, "COLUMN", "column of the y axis (default: error)", CS_ARG_INTO(struct options, y)},
    {"family", 0, "FAMILY",
     "all series of one family, such as \"adaptive implicit\" (default: the twelve nearest to "
     "the front)",
     CS_ARG_INTO(struct options, family)},
    {"out", 'o', "NAME",
     "write NAME.gp, and NAME.png, .svg and .pdf if gnuplot is installed (default: Y_X in the "
     "folder of FILE)",
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

static enum cs_status check_family(const char *family, struct cs_error *error) {
    for (uint32_t k = 0; family && cs_family_names[k]; k++)
        if (!strcmp(family, cs_family_names[k]))
            return CS_OK;
    return family ? cs_arg_refuse_name("family", cs_family_names, family, error) : CS_OK;
}

/* Refuses characters that would end a quoted text of the script. */
static enum cs_status check_name(const char *option, const char *text, struct cs_error *error) {
    for (const char *c = text; *c; c++)
        if (*c == '"' || *c == '\\' || (unsigned char)*c < 0x20)
            return cs_fail(error, CS_ERR_USAGE,
                           "--%s: quotes, backslashes and control characters cannot be drawn",
                           option);
    return CS_OK;
}

/* Splits "folder/name" into both; the folder of a bare name is ".". */
static void split(const char *path, char folder[4096], const char **name) {
    const char *slash = strrchr(path, '/');
    *name = slash ? slash + 1 : path;
    snprintf(folder, 4096, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
}

static enum cs_status print_files(const char *path, const struct cs_gnuplot *gnuplot,
                                  struct cs_error *error) {
    struct cs_text text = {0};
    if (gnuplot->drawn)
        cs_text_add(&text, "%s.gp, %s.png, %s.svg, %s.pdf\n", path, path, path, path);
    else
        cs_text_add(&text, "%s.gp (gnuplot, which draws it, %s)\n", path,
                    gnuplot->n_failed ? "failed" : "was not found");
    return cs_print_out(stdout, &text, error);
}

static enum cs_status draw(struct cs_args *args, struct cs_plot_settings *settings,
                           struct cs_error *error) {
    const struct options *options = args->options;
    const char *file = args->operands[0], *out = options->out, *title = options->title;
    const char *slash = strrchr(file, '/');
    char folder[4096], path[4096];
    struct cs_gnuplot gnuplot = {0};
    if (out)
        snprintf(path, sizeof path, "%s", out);
    else
        /* beside the file, named after the axes */
        snprintf(path, sizeof path, "%.*s%s_%s%s%s", slash ? (int)(slash - file) + 1 : 0, file,
                 settings->y->name, settings->x->name, settings->family ? "_" : "",
                 settings->family ? settings->family : "");
    for (char *c = path + strlen(path); settings->family && !out && c > path && *--c != '_';)
        *c = *c == ' ' ? '-' : *c;
    settings->title = title ? title : file;
    split(path, folder, &settings->name);
    /* both end up between quotes in the gnuplot script */
    if (check_name("title", settings->title, error) || check_name("out", path, error))
        return error->status;
    if (!*settings->name)
        return cs_fail(error, CS_ERR_USAGE, "--out: expected a file name without extension");
    if (cs_plot_write(settings, folder, &gnuplot, error) ||
        cs_print_gnuplot_warning(&gnuplot, error))
        return error->status;
    return options->quiet ? CS_OK : print_files(path, &gnuplot, error);
}

/* Draws in the terminal. */
static enum cs_status show(struct cs_args *args, struct cs_plot_settings *settings,
                           struct cs_error *error) {
    const struct options *options = args->options;
    struct cs_screen screen;
    struct cs_text text = {0};
    if (options->out)
        return cs_fail(error, CS_ERR_USAGE, "--show writes no files: remove --show or --out");
    if (cs_screen_open(&screen, false, error))
        return error->status;
    settings->title = options->title ? options->title : args->operands[0];
    cs_screen_print_diagram(&screen, settings, &text);
    return cs_print_out(stdout, &text, error);
}

/* Fails if the family has no series: an empty diagram would hide a mistake in its name. */
static enum cs_status check_cells(const struct cs_plot_settings *settings, const char *file,
                                  struct cs_error *error) {
    for (uint32_t k = 0; k < settings->n; k++)
        if (!settings->family || !strcmp(settings->cells[k].family, settings->family))
            return CS_OK;
    return settings->family
               ? cs_fail(error, CS_ERR_USAGE, "--family: found no \"%s\" series in %s",
                         settings->family, file)
               : CS_OK;
}

static enum cs_status plot(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    struct cs_plot_settings settings = {.family = options->family};
    struct cs_cell *cells;
    if (read_axis("x", options->x, &settings.x, error) ||
        read_axis("y", options->y, &settings.y, error) ||
        check_family(options->family, error) ||
        cs_csv_read(args->operands[0], true, &cells, &settings.n, error))
        return error->status;
    settings.cells = cells;
    if (!check_cells(&settings, args->operands[0], error))
        (options->show ? show : draw)(args, &settings, error);
    free(cells);
    return error->status;
}

const struct cs_command cs_command_plot = {
    .name = "plot",
    .operands = "FILE",
    .summary = "draw the compare.csv of a comparison, with any two columns",
    .notes = "Example: clothsim plot compare/compare.csv --x evals --y max_error\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = plot,
};
