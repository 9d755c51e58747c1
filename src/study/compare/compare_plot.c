/* Prints cells as a log-log diagram: a gnuplot script that holds its data. */
#include "study/compare/compare_curves.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>

/* gnuplot's point types: circle, square, triangle, diamond, inverted triangle */
static const int shapes[CS_CURVE_SHAPES] = {7, 5, 9, 13, 11};

/* Sets the labels of an axis as a list: gnuplot's own have no label on less than a decade. */
static void print_ticks(const char *axis, const double range[2], struct cs_text *out) {
    struct cs_tick ticks[CS_TICKS_MAX];
    const uint32_t n = cs_curves_ticks(range, ticks);
    cs_text_add(out, "set %srange [%.6g:%.6g]\nset %stics (", axis, pow(10, range[0]),
                pow(10, range[1]), axis);
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_tick *tick = ticks + k;
        cs_text_add(out, "%s\"", k ? ", " : "");
        if (tick->label && tick->digit > 1)
            cs_text_add(out, "%d·", tick->digit);
        if (tick->label)
            cs_text_add(out, "10^{%d}", tick->decade);
        cs_text_add(out, "\" %de%d%s", tick->digit, tick->decade, tick->label ? "" : " 1");
    }
    cs_text_add(out, ")\n");
}

/* Titles, axes, grid, and the grey area below the reference's own error. */
static void print_head(const struct cs_curves *curves, struct cs_text *out) {
    const struct cs_plot_settings *settings = curves->settings;
    cs_text_add(out, "# gnuplot %s.gp makes %s.png, .svg and .pdf\n", settings->name,
                settings->name);
    cs_text_add(out, "set title \"%s\" noenhanced\n", settings->title);
    cs_text_add(out, "set xlabel \"");
    cs_column_add_label(settings->x, out);
    cs_text_add(out, "\"\nset ylabel \"");
    cs_column_add_label(settings->y, out);
    cs_text_add(out, "\"\n");
    cs_text_add(out, "set encoding utf8\nset logscale xy\nset tics scale 1,0.5\n"
                     "set border lw 1.2 lc rgb \"#404040\"\n"
                     "set grid xtics ytics mxtics mytics lt 1 lw 0.8 lc rgb \"#cfcfcf\", lt 1 "
                     "lw 0.4 lc rgb \"#ececec\"\n"
                     "set key outside right top Left reverse samplen 2.5 spacing 1.05 "
                     "\n");
    print_ticks("x", curves->x, out);
    print_ticks("y", curves->y, out);
    /* grey below the reference's own error, where no difference means anything */
    if (cs_curves_show_bar(curves))
        cs_text_add(out,
                    "set object 1 rectangle from graph 0, graph 0 to graph 1, first %.6g "
                    "behind fillcolor rgb \"#dcdcdc\" fillstyle solid noborder\n",
                    curves->error_bar);
}

/* One data point, with as many digits as it needs. */
static void print_pair(double x, double y, const char *behind, struct cs_text *out) {
    cs_text_add_real(out, x);
    cs_text_add(out, " ");
    cs_text_add_real(out, y);
    cs_text_add(out, "%s", behind);
}

/* Data blocks of curve c: points, quartiles, rings, crosses. Empty blocks are not plotted. */
static void print_curve(const struct cs_curves *curves, uint32_t c, struct cs_text *out) {
    const struct cs_plot_settings *settings = curves->settings;
    const struct cs_curve *curve = curves->list + c;
    const struct cs_cell *first = settings->cells + curve->first, *end = first + curve->n;
    double x, y;
    cs_text_add(out, "$points%u << END\n", c);
    for (const struct cs_cell *cell = first; cell < end; cell++)
        if (cs_curves_point(settings, cell, &x, &y))
            print_pair(x, y, "\n", out);
    cs_text_add(out, "END\n$bars%u << END\n", c);
    for (const struct cs_cell *cell = first; cell < end; cell++)
        if (cs_curves_point(settings, cell, &x, &y) && cs_curves_quartiles(settings, cell)) {
            print_pair(x, y, " ", out);
            print_pair(cell->cpu_low, cell->cpu_high, "\n", out);
        }
    cs_text_add(out, "END\n$rings%u << END\n", c);
    for (const struct cs_cell *cell = first; cell < end; cell++)
        if (cs_cell_has_crossings(cell) && cs_curves_point(settings, cell, &x, &y))
            print_pair(x, y, "\n", out);
    cs_text_add(out, "END\n$crosses%u << END\n", c);
    for (const struct cs_cell *cell = first; cell < end; cell++)
        if (cs_curves_cross(curves, cell, &x))
            cs_text_add(out, "%.6g %.6g\n", x, cs_curves_edge(curves));
    cs_text_add(out, "END\n");
}

/* Data blocks of all curves and of the front. */
static void print_data(const struct cs_curves *curves, struct cs_text *out) {
    const struct cs_plot_settings *settings = curves->settings;
    double x, y;
    for (uint32_t c = 0; c < curves->n; c++)
        print_curve(curves, c, out);
    cs_text_add(out, "$front << END\n");
    for (uint32_t k = UINT32_MAX; cs_curves_front(curves, &k);)
        if (cs_curves_point(settings, settings->cells + k, &x, &y))
            print_pair(x, y, "\n", out);
    cs_text_add(out, "END\n");
}

/* Plot elements of a curve. Empty blocks are left out, because gnuplot warns of them. */
static void plot_curve(const struct cs_curves *curves, uint32_t c, struct cs_text *out) {
    const struct cs_curve *curve = curves->list + c;
    const int style = curve->style;
    const char *colour = style < 0 ? "#808080" : cs_curve_colours[style % CS_CURVE_COLOURS];
    if (style >= 0)
        cs_text_add(out,
                    " $points%u with linespoints linewidth 1.8 dashtype %d pointtype "
                    "%d pointsize 1.1 linecolor rgb \"%s\" title \"%s\" noenhanced, \\\n",
                    c, style < CS_CURVE_COLOURS ? 1 : 2, shapes[style % CS_CURVE_SHAPES],
                    colour, curves->settings->cells[curve->first].series);
    if (style >= 0 && curve->bars > 0)
        cs_text_add(out,
                    " $bars%u using 1:2:3:4 with xerrorbars pointtype 0 linewidth 1.5 "
                    "linecolor rgb \"%s\" notitle, \\\n",
                    c, colour);
    if (style >= 0 && curve->crossing_marks > 0)
        cs_text_add(out,
                    " $rings%u with points pointtype 6 pointsize 2.2 linewidth 1.6 linecolor "
                    "rgb \"%s\" notitle, \\\n",
                    c, CS_RING_COLOUR);
    if (curve->failed_marks > 0)
        cs_text_add(out,
                    " $crosses%u with points pointtype 2 pointsize 0.9 linewidth 1.5 "
                    "linecolor rgb \"%s\" notitle, \\\n",
                    c, colour);
}

/* A line of the legend without a curve. */
static void plot_words(const char *words, struct cs_text *out) {
    cs_text_add(out, " NaN with lines linecolor rgb \"white\" title \"%s\", \\\n", words);
}

/* Plots the curves of a family below its name. */
static void plot_family(const struct cs_curves *curves, int family, struct cs_text *out) {
    char words[64];
    bool named = false;
    for (uint32_t c = 0; c < curves->n; c++) {
        if (curves->list[c].family != family)
            continue;
        if (curves->list[c].style >= 0 && !named) {
            snprintf(words, sizeof words, "{/:Bold %s}", cs_family_names[family]);
            plot_words(words, out);
            named = true;
        }
        plot_curve(curves, c, out);
    }
}

/* The plot command: the front first, because later elements are drawn above it. */
static void print_plot(const struct cs_curves *curves, struct cs_text *out) {
    char words[64];
    uint32_t first = UINT32_MAX, crosses = 0, rings = 0;
    cs_text_add(out, "plot");
    for (uint32_t c = 0; c < curves->n; c++)
        crosses += curves->list[c].failed_marks, rings += curves->list[c].crossing_marks;
    if (cs_curves_front(curves, &first))
        cs_text_add(
            out,
            " $front with steps linewidth 7 linecolor rgb \"%s\" title \"front: nothing "
            "is cheaper and better\", \\\n",
            CS_FRONT_COLOUR);
    for (int family = 0; cs_family_names[family]; family++)
        plot_family(curves, family, out);
    if (cs_curves_left_out(curves) > 0) {
        snprintf(words, sizeof words, "%u more: clothsim plot --family",
                 cs_curves_left_out(curves));
        plot_words(words, out);
    }
    if (cs_curves_show_bar(curves))
        cs_text_add(out, " NaN with boxes fillstyle solid noborder linecolor rgb \"#dcdcdc\" "
                         "title \"below the reference's own error\", \\\n");
    if (crosses > 0)
        cs_text_add(out, " NaN with points pointtype 2 linecolor rgb \"#404040\" title "
                         "\"did not finish\", \\\n");
    if (rings > 0)
        cs_text_add(out,
                    " NaN with points pointtype 6 linecolor rgb \"%s\" title \"edges through "
                    "triangles\", \\\n",
                    CS_RING_COLOUR);
    cs_text_add(out, " NaN notitle\n");
}

void cs_plot_print(const struct cs_plot_settings *settings, struct cs_text *out) {
    struct cs_curves curves;
    cs_curves_make(&curves, settings);
    print_head(&curves, out);
    print_data(&curves, out);
    cs_text_add(out, "set terminal pngcairo size 1200,800 font \"DejaVu Sans,12\"\n");
    cs_text_add(out, "set output \"%s.png\"\n", settings->name);
    print_plot(&curves, out);
    cs_text_add(out,
                "set terminal svg size 1200,800 font \"DejaVu Sans,14\"\n"
                "set output \"%s.svg\"\nreplot\n",
                settings->name);
    /* as wide as a column of a paper; the legend goes below, where there is room */
    cs_text_add(out,
                "set terminal pdfcairo size 8.6cm,11cm font \"DejaVu Sans,6\" linewidth 0.6 "
                "pointscale 0.4\nset key below maxcols 2 font \",5\"\nset title\nset xlabel "
                "offset 0,0.6\n"
                "set output \"%s.pdf\"\nreplot\n",
                settings->name);
}

enum cs_status cs_plot_write(const struct cs_plot_settings *settings, const char *folder,
                             struct cs_gnuplot *gnuplot, struct cs_error *error) {
    struct cs_text script = {0}, path = {0};
    cs_plot_print(settings, &script);
    cs_text_add(&path, "%s/%s.gp", folder, settings->name);
    if (script.failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a diagram");
    else if (!cs_file_write(cs_text_get(&path), cs_text_get(&script), script.length, error))
        cs_gnuplot_run(folder, settings->name, gnuplot, error);
    cs_text_finish(&script);
    cs_text_finish(&path);
    return error->status;
}
