/* Prints cells as a log-log diagram: a gnuplot script that holds its data. */
#include "study/compare/compare_plot.h"

#include "base/file.h"
#include "io/gnuplot.h"

#include <math.h>
#include <string.h>

enum { COLOURS = 8 };

/* A hue a family, a shade and a marker a series; open markers where matrices are solved. */
static const struct style {
    const char *colours[COLOURS];
    int points[COLOURS];
    int dash;
} styles[] = {
    {{"#08306b", "#2171b5", "#41b6c4", "#6a51a3", "#6baed6", "#0c7a9c", "#9e9ac8", "#253494"},
     {5, 7, 9, 11, 13, 15, 5, 7},
     1},
    {{"#7f0000", "#d7301f", "#fc8d59", "#b30000", "#e6a000", "#cc4c02", "#ef6548", "#8c510a"},
     {4, 6, 8, 10, 12, 14, 4, 6},
     1},
    {{"#616161", "#9e9e9e", "#3a3a3a", "#bdbdbd", "#757575", "#4e4e4e", "#8a8a8a", "#a8a8a8"},
     {7, 5, 9, 11, 13, 15, 7, 5},
     3},
    {{"#00441b", "#41ab5d", "#238b45", "#74c476", "#005a32", "#a1d99b", "#2e7d32", "#66bb6a"},
     {7, 13, 5, 9, 11, 15, 7, 13},
     2},
    {{"#7a0177", "#dd3497", "#f768a1", "#ae017e", "#c51b8a", "#49006a", "#e377c2", "#91278d"},
     {6, 12, 4, 8, 10, 14, 6, 12},
     2},
};

struct box {
    double x[2], y[2], bar;
    bool crosses; /* some did not get through */
};

static bool is_position_error(const struct cs_column *column) {
    return strstr(column->name, "error") && strstr(column->label, "in m") &&
           !strstr(column->label, "m/s");
}

bool cs_plot_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                   double *x, double *y) {
    *x = cs_cell_number(cell, settings->x);
    *y = cs_cell_number(cell, settings->y);
    const bool known = !is_position_error(settings->y) || !(cell->bar > 0) || *y >= cell->bar;
    return cs_cell_is_finished(cell) && isfinite(*x) && isfinite(*y) && *x > 0 && *y > 0 &&
           known;
}

double cs_plot_bar(const struct cs_plot_settings *settings) {
    double bar = 0;
    for (uint32_t k = 0; k < settings->n && is_position_error(settings->y); k++)
        bar = fmax(bar, settings->cells[k].bar);
    return bar;
}

static struct box bounds(const struct cs_plot_settings *settings) {
    struct box box = {{HUGE_VAL, 0}, {HUGE_VAL, 0}, cs_plot_bar(settings), false};
    for (uint32_t k = 0; k < settings->n; k++) {
        double x, y;
        if (!cs_plot_point(settings, settings->cells + k, &x, &y)) {
            box.crosses |= isfinite(x) && x > 0 && !cs_cell_is_finished(settings->cells + k);
            continue;
        }
        box.x[0] = fmin(box.x[0], x);
        box.x[1] = fmax(box.x[1], x);
        box.y[0] = fmin(box.y[0], y);
        box.y[1] = fmax(box.y[1], y);
    }
    if (!(box.x[1] > 0))
        return (struct box){{1, 10}, {1, 10}, box.bar, box.crosses};
    // room for the crosses above and for the bar below
    box.y[0] = pow(10, floor(log10(box.bar > 0 ? fmin(box.y[0], box.bar / 3) : box.y[0])));
    box.y[1] = pow(10, ceil(log10(box.y[1] * (box.crosses ? 3 : 1))));
    box.x[0] /= 1.4;
    box.x[1] *= 1.4;
    return box;
}

static void print_head(const struct cs_plot_settings *settings, const struct box *box,
                       struct cs_text *out) {
    cs_text_add(out, "# gnuplot %s.gp makes %s.png, .svg and .pdf\n", settings->name,
                settings->name);
    cs_text_add(out, "set title \"%s\" noenhanced\n", settings->title);
    cs_text_add(out, "set xlabel \"%s\"\nset ylabel \"%s\"\n", settings->x->label,
                settings->y->label);
    cs_text_add(out, "set logscale xy\nset format xy \"10^{%%L}\"\n"
                     "set mxtics 10\nset mytics 10\nset tics scale 1,0.5\n"
                     "set border lw 1.2 lc rgb \"#404040\"\n"
                     "set grid xtics ytics mxtics mytics lt 1 lw 0.8 lc rgb \"#cfcfcf\", lt 1 "
                     "lw 0.4 lc rgb \"#ececec\"\n"
                     "set key outside right top Left reverse samplen 2.5 spacing 1.05 "
                     "\n");
    cs_text_add(out, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", box->x[0], box->x[1],
                box->y[0], box->y[1]);
    /* grey below the reference's own error, where no difference means anything */
    if (box->bar > 0)
        cs_text_add(out,
                    "set object 1 rectangle from graph 0, first %.6g to graph 1, first %.6g "
                    "behind fillcolor rgb \"#dcdcdc\" fillstyle solid noborder\n"
                    "set label 1 \"below the reference's own error\" at graph 0.015, first "
                    "%.6g textcolor rgb \"#606060\" offset 0,-0.7\n",
                    box->y[0], box->bar, box->bar);
}

static int family_of(const struct cs_cell *cell) {
    for (int k = 0; cs_family_names[k]; k++)
        if (!strcmp(cell->family, cs_family_names[k]))
            return k;
    return 0;
}

/* The cells of one series stand together: first and how many. */
struct group {
    uint32_t first, n, drawn;
    int family, style;
};

enum { GROUPS_MAX = 64 };

static uint32_t find_groups(const struct cs_plot_settings *settings,
                            struct group groups[GROUPS_MAX]) {
    uint32_t n = 0;
    int used[sizeof styles / sizeof *styles] = {0};
    for (uint32_t k = 0; k < settings->n; k++) {
        const struct cs_cell *cell = settings->cells + k;
        double x, y;
        if (k == 0 || !cs_cell_same_series(cell, cell - 1)) {
            if (n == GROUPS_MAX)
                break;
            const int family = family_of(cell);
            groups[n++] = (struct group){k, 0, 0, family, used[family]++ % COLOURS};
        }
        groups[n - 1].n++;
        groups[n - 1].drawn += cs_plot_point(settings, cell, &x, &y);
    }
    return n;
}

static void print_data(const struct cs_plot_settings *settings, const struct group *group,
                       uint32_t number, const struct box *box, struct cs_text *out) {
    double x, y;
    cs_text_add(out, "$points%u << END\n", number);
    for (uint32_t k = group->first; k < group->first + group->n; k++)
        if (cs_plot_point(settings, settings->cells + k, &x, &y)) {
            cs_text_add_real(out, x);
            cs_text_add(out, " ");
            cs_text_add_real(out, y);
            cs_text_add(out, "\n");
        }
    cs_text_add(out, "END\n$crosses%u << END\n", number);
    for (uint32_t k = group->first; k < group->first + group->n; k++) {
        x = cs_cell_number(settings->cells + k, settings->x);
        if (!cs_cell_is_finished(settings->cells + k) && isfinite(x) && x > 0)
            cs_text_add(out, "%.6g %.6g\n", fmin(fmax(x, box->x[0] * 1.1), box->x[1] / 1.1),
                        box->y[1] / 1.5);
    }
    cs_text_add(out, "END\n");
}

static void print_plot(const struct cs_plot_settings *settings, const struct group *groups,
                       uint32_t n, struct cs_text *out) {
    cs_text_add(out, "plot");
    /* by family, so that the legend lists its methods below its name */
    for (int family = 0; cs_family_names[family]; family++) {
        bool named = false;
        for (uint32_t k = 0; k < n; k++) {
            const struct style *style = styles + family;
            const char *series = settings->cells[groups[k].first].series;
            const char *colour = style->colours[groups[k].style];
            if (groups[k].family != family)
                continue;
            if (groups[k].drawn > 0 && !named)
                /* a curve without points, for the name of the family in the legend */
                cs_text_add(
                    out, " NaN with lines linecolor rgb \"white\" title \"{/:Bold %s}\", \\\n",
                    cs_family_names[family]);
            named |= groups[k].drawn > 0;
            if (groups[k].drawn > 0)
                cs_text_add(
                    out,
                    " $points%u with linespoints linewidth 1.8 dashtype %d pointtype "
                    "%d pointsize 1.1 linecolor rgb \"%s\" title \"%s\" noenhanced, \\\n",
                    k, style->dash, style->points[groups[k].style], colour, series);
            if (groups[k].drawn < groups[k].n)
                cs_text_add(out,
                            " $crosses%u with points pointtype 2 pointsize 0.9 linewidth 1.5 "
                            "linecolor rgb \"%s\" notitle, \\\n",
                            k, colour);
        }
    }
    cs_text_add(out, " NaN with points pointtype 2 linecolor rgb \"#404040\" title "
                     "\"did not get through\"\n");
}

void cs_plot_print(const struct cs_plot_settings *settings, struct cs_text *out) {
    struct group groups[GROUPS_MAX];
    const struct box box = bounds(settings);
    const uint32_t n = find_groups(settings, groups);
    print_head(settings, &box, out);
    for (uint32_t k = 0; k < n; k++)
        print_data(settings, groups + k, k, &box, out);
    cs_text_add(out, "set terminal pngcairo size 1200,800 font \"DejaVu Sans,12\"\n");
    cs_text_add(out, "set output \"%s.png\"\n", settings->name);
    print_plot(settings, groups, n, out);
    cs_text_add(out,
                "set terminal svg size 1200,800 font \"DejaVu Sans,14\"\n"
                "set output \"%s.svg\"\nreplot\n",
                settings->name);
    /* as wide as a column of a paper; the legend goes below, where there is room */
    cs_text_add(out,
                "set terminal pdfcairo size 8.6cm,11cm font \"DejaVu Sans,6\" linewidth 0.6 "
                "pointscale 0.4\nset key below maxcols 2 font \",5\"\nset title\n"
                "set output \"%s.pdf\"\nreplot\n",
                settings->name);
}

enum cs_status cs_plot_write(const struct cs_plot_settings *settings, const char *folder,
                             bool *drawn, struct cs_error *error) {
    struct cs_text script = {0}, name = {0}, path = {0};
    *drawn = false;
    cs_plot_print(settings, &script);
    cs_text_add(&name, "%s.gp", settings->name);
    cs_text_add(&path, "%s/%s", folder, cs_text_get(&name));
    if (script.failed || name.failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a diagram");
    else if (!cs_file_write(cs_text_get(&path), cs_text_get(&script), script.length, error))
        cs_gnuplot_run(folder, cs_text_get(&name), drawn, error);
    cs_text_finish(&script);
    cs_text_finish(&name);
    cs_text_finish(&path);
    return error->status;
}
