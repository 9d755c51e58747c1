/* clothsim plot: draws two columns of a comparison against each other. */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "study/compare/compare_cell.h"
#include "study/compare/compare_plot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLOT_X, PLOT_Y, PLOT_FAMILY, PLOT_OUT, PLOT_TITLE, PLOT_QUIET, PLOT_ROWS };

static const struct cs_arg rows[PLOT_ROWS] = {
    [PLOT_X] = {"x", 'x', "COLUMN", "column of the x axis (default: cpu)", false},
    [PLOT_Y] = {"y", 'y', "COLUMN", "column of the y axis (default: error)", false},
    [PLOT_FAMILY] = {"family", 'f', "FAMILY",
                     "all series of one family, such as \"adaptive implicit\" (default: the "
                     "twelve that come nearest to the front)",
                     false},
    [PLOT_OUT] =
        {"out", 'o', "NAME",
         "writes NAME.gp, and NAME.png, .svg and .pdf where gnuplot is found (default: "
         "Y_X beside FILE)",
         false},
    [PLOT_TITLE] = {"title", 0, "TEXT", "title above the diagram (default: FILE)", false},
    [PLOT_QUIET] = {"quiet", 'q', NULL, "print nothing", false},
};

static enum cs_status read_axis(const struct cs_args *args, uint32_t row, const char *name,
                                const struct cs_column **column, struct cs_error *error) {
    const char *const *names = cs_column_axes();
    const char *given = cs_args_get(args, row);
    *column = cs_column_find(given ? given : name);
    if (*column && (*column)->label)
        return CS_OK;
    struct cs_text list = {0};
    for (uint32_t k = 0; names[k]; k++)
        cs_text_add(&list, "%s%s", k ? ", " : "", names[k]);
    cs_fail(error, CS_ERR_USAGE, "--%s: expected one of %s, found \"%.60s\"", rows[row].name,
            cs_text_get(&list), given);
    cs_text_finish(&list);
    return error->status;
}

static enum cs_status read_family(const struct cs_args *args, const char **family,
                                  struct cs_error *error) {
    const char *given = cs_args_get(args, PLOT_FAMILY);
    struct cs_text list = {0};
    *family = given;
    for (uint32_t k = 0; given && cs_family_names[k]; k++) {
        if (!strcmp(given, cs_family_names[k]))
            given = NULL;
        cs_text_add(&list, "%s%s", k ? ", " : "", cs_family_names[k]);
    }
    if (given)
        cs_fail(error, CS_ERR_USAGE, "--family: expected one of %s, found \"%.60s\"",
                cs_text_get(&list), given);
    cs_text_finish(&list);
    return error->status;
}

/* a name inside a quoted text of the script */
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

static enum cs_status tell(const struct cs_args *args, const char *path, bool drawn,
                           struct cs_error *error) {
    struct cs_text text = {0};
    if (cs_args_get(args, PLOT_QUIET))
        return CS_OK;
    if (drawn)
        cs_text_add(&text, "%s.gp, %s.png, %s.svg, %s.pdf\n", path, path, path, path);
    else
        cs_text_add(&text, "%s.gp (gnuplot, which draws it, was not found)\n", path);
    return cs_print_out(stdout, &text, error);
}

static enum cs_status draw(struct cs_args *args, struct cs_plot_settings *settings,
                           struct cs_error *error) {
    const char *file = args->operands[0], *out = cs_args_get(args, PLOT_OUT),
               *title = cs_args_get(args, PLOT_TITLE);
    const char *slash = strrchr(file, '/');
    char folder[4096], path[4096];
    bool drawn;
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
        return cs_fail(error, CS_ERR_USAGE, "--out: expected a name without its ending");
    if (cs_plot_write(settings, folder, &drawn, error))
        return error->status;
    return tell(args, path, drawn, error);
}

/* a diagram of nothing is a mistake in the name of the family */
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
    struct cs_plot_settings settings = {0};
    struct cs_cell *cells;
    if (read_axis(args, PLOT_X, "cpu", &settings.x, error) ||
        read_axis(args, PLOT_Y, "error", &settings.y, error) ||
        read_family(args, &settings.family, error) ||
        cs_csv_read(args->operands[0], &cells, &settings.n, error))
        return error->status;
    settings.cells = cells;
    if (!check_cells(&settings, args->operands[0], error))
        draw(args, &settings, error);
    free(cells);
    return error->status;
}

const struct cs_command cs_command_plot = {
    .name = "plot",
    .operands = "FILE",
    .summary = "draw the compare.csv of a comparison, with any two columns",
    .notes = "Example: clothsim plot compare/compare.csv --x evals --y max_error\n",
    .rows = rows,
    .n_rows = PLOT_ROWS,
    .least = 1,
    .most = 1,
    .main = plot,
};
