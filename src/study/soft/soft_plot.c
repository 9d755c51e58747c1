/* soft_plot.c - the diagram of soft.h: the soft-body thesis's two graphs side by side. */
#include "study/soft/soft.h"

/* filled markers: one step a picture, as the thesis counts; open ones: stable frames */
struct curve {
    enum cs_soft_series series;
    int column; /* 8: one step a picture; 9: all steps of a frame */
    const char *colour, *title;
    int points;
};

static void add_curves(const struct curve *curves, uint32_t n, int x, struct cs_text *out) {
    for (uint32_t k = 0; k < n; k++)
        cs_text_add(out,
                    "%s'soft.csv' using (strcol(1) eq '%s' ? $%d : NaN):%d every ::1 with "
                    "linespoints lw 2 dt %d pt %d ps 1.1 lc rgb '%s' title '%s'",
                    k ? ", \\\n  " : "plot \\\n  ", cs_soft_names[curves[k].series], x,
                    curves[k].column, curves[k].column == 8 ? 1 : 2, curves[k].points,
                    curves[k].colour, curves[k].title);
    cs_text_add(out, "\n");
}

void cs_soft_print_plot(const struct cs_soft *soft, struct cs_text *out) {
    static const struct curve springs[] = {
        {CS_SOFT_SMALL, 8, "#2171b5", "smaller body, one step a picture", 7},
        {CS_SOFT_LARGE, 8, "#d7301f", "larger body, one step a picture", 5},
        {CS_SOFT_SMALL, 9, "#2171b5", "smaller body, stable frames", 6},
        {CS_SOFT_LARGE, 9, "#d7301f", "larger body, stable frames", 4},
    };
    static const struct curve vertices[] = {
        {CS_SOFT_MATCHED, 8, "#238b45", "shape matching", 9},
        {CS_SOFT_SURFACE, 8, "#e08214", "surface springs, one step a picture", 7},
        {CS_SOFT_NETWORK, 8, "#6a51a3", "network, one step a picture", 5},
        {CS_SOFT_SURFACE, 9, "#e08214", "surface springs, stable frames", 6},
        {CS_SOFT_NETWORK, 9, "#6a51a3", "network, stable frames", 4},
        {CS_SOFT_IMPLICIT, 9, "#1b1b1b", "network, one implicit step a frame", 13},
    };
    cs_text_add(
        out,
        "# gnuplot soft.gp makes soft.png\n"
        "set terminal pngcairo size 1500,720 font 'sans,13' background '#ffffff'\n"
        "set output 'soft.png'\nset datafile separator ','\n"
        "set multiplot layout 1,2 title \"Soft bodies: %s\" font 'sans,16' noenhanced\n",
        soft->draw ? "pictures a second, simulated and drawn"
                   : "pictures a second, simulated only");
    cs_text_add(out, "set logscale xy\nset format xy '10^{%%T}'\nset mxtics 10\nset mytics 10\n"
                     "set grid xtics ytics lc rgb '#dddddd'\nset tics out nomirror\n"
                     "set border 3 lc rgb '#555555'\n"
                     "set key below Left reverse samplen 2 spacing 1.2 maxrows 3\n"
                     "set ylabel '1/s'\n");
    cs_text_add(out, "set xlabel 'springs'\n");
    add_curves(springs, sizeof springs / sizeof *springs, 3, out);
    cs_text_add(out, "set xlabel 'vertices'\n");
    add_curves(vertices, sizeof vertices / sizeof *vertices, 2, out);
    cs_text_add(out, "unset multiplot\n");
}
