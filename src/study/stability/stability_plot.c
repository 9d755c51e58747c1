/* stability_plot.c - a gnuplot script: cells coloured by verdict, theory's curves over them. */
#include "study/stability/stability.h"

#include <math.h>

/* green to red for eyes of every kind, then violet and greys; by verdict */
static const char *const colours[CS_FATES] = {
    [CS_FATE_BOUNDED] = "#9fd3b5", [CS_FATE_DAMPED] = "#a9c9e8",
    [CS_FATE_SHORT] = "#e3f1e8",   [CS_FATE_LOCAL] = "#f6d365",
    [CS_FATE_GLOBAL] = "#e8825a",  [CS_FATE_NOT_FINITE] = "#8e5c86",
    [CS_FATE_FAILED] = "#7f858d",  [CS_FATE_OVER_BUDGET] = "#dfe1e4"};

static void add_head(const struct cs_stability *map, const char *name, struct cs_text *out) {
    const enum cs_axis axis = map->settings->axis;
    cs_text_add(out,
                "# gnuplot %s.gp\n"
                "set terminal pngcairo size 1280,760 font 'sans,13' background '#ffffff'\n"
                "set output '%s.png'\nset datafile separator ','\n",
                name, name);
    cs_text_add(out,
                "set title \"%s: which steps survive, %s\\n%g s of motion a cell\" "
                "font 'sans,16' noenhanced\n",
                map->integrator->name, map->session.scene.path, map->settings->seconds);
    cs_text_add(out, "set xlabel '%s  [%s]'\nset ylabel 'dt  [s]' offset 1,0\n",
                cs_axis_names[axis], cs_axis_unit(axis));
    cs_text_add(out, "set logscale xy\nset format y '10^{%%T}'\nset format x '%s'\n",
                axis == CS_AXIS_RESOLUTION ? "%g" : "10^{%T}");
    cs_text_add(out,
                "set tics out nomirror\nset mxtics 10\nset mytics 10\n"
                "set border 3 lc rgb '#555555'\n"
                "set key outside right top Left reverse spacing 1.35 samplen 2.2 width -2\n"
                "set style fill solid 1.0 border lc rgb '#ffffff'\n");
}

static void add_ranges(const struct cs_stability *map, struct cs_text *out) {
    const uint32_t nc = map->n_columns, nr = map->n_rows;
    const double x0 = map->columns[0].value, x1 = map->columns[nc - 1].value;
    const double y0 = map->dt[0], y1 = map->dt[nr - 1];
    const double dx = nc > 1 ? pow(x1 / x0, 0.5 / (nc - 1)) : 1.3;
    const double dy = nr > 1 ? pow(y1 / y0, 0.5 / (nr - 1)) : 1.3;
    cs_text_add(out, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", x0 / dx, x1 * dx,
                y0 / dy, y1 * dy);
}

static bool is_there(const struct cs_stability *map, int verdict) {
    for (uint32_t c = 0; c < map->n_columns; c++)
        for (uint32_t r = 0; r < map->n_rows; r++)
            if ((int)map->columns[c].cells[r].verdict == verdict)
                return true;
    return false;
}

void cs_stability_print_plot(const struct cs_stability *map, const char *name,
                             struct cs_text *out) {
    static const struct {
        int column;
        const char *style, *title;
    } curves[] = {
        {5, "lines lw 2 dt (4,4) lc rgb '#6b7078'", "theory: row sums"},
        {4, "lines lw 2 dt (10,5) lc rgb '#23262b'", "theory: at the start"},
        {3, "lines lw 3 lc rgb '#23262b'", "theory: worst on the way"},
        {2, "points pt 7 ps 1.5 lc rgb '#23262b'", "border, bisected"},
        {2, "points pt 7 ps 0.9 lc rgb '#ffffff'", ""},
    };
    add_head(map, name, out);
    add_ranges(map, out);
    cs_text_add(out, "plot \\\n");
    for (int v = 0; v < CS_FATES; v++)
        if (is_there(map, v))
            cs_text_add(
                out,
                "  '%s.csv' using 1:($4==%d?$2:NaN):8:9:10:11 every ::1 with boxxyerror "
                "fc rgb '%s' title '%s', \\\n",
                name, v, colours[v], cs_fate_word((enum cs_fate)v));
    for (size_t k = 0; k < sizeof curves / sizeof *curves; k++)
        cs_text_add(out, "  '%s_border.csv' using 1:%d every ::1 with %s %s'%s'%s\n", name,
                    curves[k].column, curves[k].style, *curves[k].title ? "title " : "notitle ",
                    curves[k].title, k + 1 < sizeof curves / sizeof *curves ? ", \\" : "");
}
