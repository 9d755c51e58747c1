/* Prints what soft bodies cost as tables with their meaning, as CSV, and as the soft-body
 * thesis's two graphs side by side. */
#include "study/soft/soft_report.h"

#include <math.h>

static const char *const titles[CS_SOFT_SERIES] = {
    [CS_SOFT_SMALL] = "Spring network, smaller body, more and more inner springs",
    [CS_SOFT_LARGE] = "Spring network, larger body, more and more inner springs",
    [CS_SOFT_SURFACE] = "Springs on the surface only, more and more vertices",
    [CS_SOFT_NETWORK] = "Spring network of the scene, more and more vertices",
    [CS_SOFT_IMPLICIT] = "The same by implicit-linearised, one step per frame",
    [CS_SOFT_MATCHED] = "Shape matching, more and more vertices",
};

static void add_head(enum cs_soft_series series, bool drawn, struct cs_text *out) {
    cs_text_add(out, "%s%s\n%9s %9s %12s %12s %12s", series ? "\n" : "", titles[series],
                "vertices", "springs", "step", "steps", "frame");
    cs_text_add(out, drawn ? " %12s %14s %12s\n" : "%.0s %14s %12s\n", "picture", "one step/s",
                "frames/s");
    cs_text_add(out, "%9s %9s %12s %12s %12s", "", "", "[ms]", "a frame", "[ms]");
    cs_text_add(out, drawn ? " %12s\n" : "\n", "[ms]");
}

static void add_row(const struct cs_soft_row *row, bool drawn, struct cs_text *out) {
    cs_text_add(out, "%9u %9u", row->vertices, row->springs);
    if (!(row->step_seconds > 0)) {
        cs_text_add(out, "  %s\n", cs_outcome_text(row->outcome));
        return;
    }
    cs_text_add(out, " %12.4f %12.4g %12.4g", 1e3 * row->step_seconds, row->steps,
                1e3 * row->step_seconds * row->steps);
    if (drawn)
        cs_text_add(out, " %12.4g", 1e3 * row->draw_seconds);
    cs_text_add(out, " %14.4g %12.4g%s%s\n", cs_soft_rate_one_step(row), cs_soft_rate(row),
                row->outcome == CS_RUNNING ? "" : "  ",
                row->outcome == CS_RUNNING ? "" : cs_outcome_text(row->outcome));
}

/* The row of a series with that number of vertices, or NULL. */
static const struct cs_soft_row *find(const struct cs_soft *soft, enum cs_soft_series series,
                                      uint32_t vertices) {
    for (uint32_t k = 0; k < soft->n; k++)
        if (soft->rows[k].series == series && soft->rows[k].vertices == vertices &&
            soft->rows[k].step_seconds > 0)
            return soft->rows + k;
    return NULL;
}

/* Exponents of the cost per step. */
static void add_growth(const struct cs_soft *soft, struct cs_text *out) {
    for (int s = 0; s < CS_SOFT_SERIES; s++) {
        const double growth = cs_soft_growth(soft, (enum cs_soft_series)s);
        if (isfinite(growth))
            cs_text_add(out, "%-14s time per step grows like %s^%.2f\n", cs_soft_names[s],
                        s == CS_SOFT_MATCHED ? "vertices" : "springs", growth);
    }
}

/* The largest body that all series over vertices have, or NULL. */
static const struct cs_soft_row *largest(const struct cs_soft *soft) {
    for (uint32_t k = soft->n; k-- > 0;) {
        const struct cs_soft_row *row = soft->rows + k;
        bool all = row->series == CS_SOFT_MATCHED;
        for (int s = CS_SOFT_SURFACE; s <= CS_SOFT_MATCHED; s++)
            all &= find(soft, (enum cs_soft_series)s, row->vertices) != NULL;
        if (all)
            return row;
    }
    return NULL;
}

/* Cost of shape matching relative to springs. */
static void add_ratios(const struct cs_soft *soft, struct cs_text *out) {
    const struct cs_soft_row *matched = largest(soft);
    if (!matched)
        return;
    const struct cs_soft_row *surface = find(soft, CS_SOFT_SURFACE, matched->vertices);
    const struct cs_soft_row *network = find(soft, CS_SOFT_NETWORK, matched->vertices);
    const struct cs_soft_row *implicit = find(soft, CS_SOFT_IMPLICIT, matched->vertices);
    const double frame = matched->step_seconds * matched->steps;
    cs_text_add(out,
                "%u vertices: one step of shape matching takes %.2f times one with springs on "
                "the surface\nonly, and %.2f times one with the network.\n",
                matched->vertices, matched->step_seconds / surface->step_seconds,
                matched->step_seconds / network->step_seconds);
    cs_text_add(out,
                "A frame of the network takes %.0f explicit steps, %.0f times the time of "
                "shape matching, or\n"
                "one implicit step, %.0f times the time of shape matching.\n",
                network->steps, network->step_seconds * network->steps / frame,
                implicit->step_seconds * implicit->steps / frame);
}

void cs_soft_print(const struct cs_soft *soft, struct cs_text *out) {
    for (uint32_t k = 0; k < soft->n; k++) {
        if (k == 0 || soft->rows[k].series != soft->rows[k - 1].series)
            add_head(soft->rows[k].series, soft->draw, out);
        add_row(soft->rows + k, soft->draw, out);
    }
    cs_text_add(out, "\n");
    add_growth(soft, out);
    add_ratios(soft, out);
}

void cs_soft_print_csv(const struct cs_soft *soft, struct cs_text *out) {
    cs_text_add(out, "series,vertices,springs,step_ms,steps,frame_ms,picture_ms,one_step_per_s,"
                     "frames_per_s,outcome\n");
    for (uint32_t k = 0; k < soft->n; k++) {
        const struct cs_soft_row *row = soft->rows + k;
        cs_text_add(out, "%s,%u,%u", cs_soft_names[row->series], row->vertices, row->springs);
        /* a body whose run failed has no times: its fields stay empty */
        const bool timed = row->step_seconds > 0;
        const double values[] = {1e3 * row->step_seconds,
                                 row->steps,
                                 1e3 * row->step_seconds * row->steps,
                                 soft->draw ? 1e3 * row->draw_seconds : HUGE_VAL,
                                 cs_soft_rate_one_step(row),
                                 cs_soft_rate(row)};
        for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
            cs_text_add(out, ",");
            if (timed && isfinite(values[v]))
                cs_text_add(out, "%.6g", values[v]);
        }
        cs_text_add(out, ",%s\n", cs_outcome_text(row->outcome));
    }
}

/* --- the diagram --- */

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
    /* the thesis's two graphs: over the number of springs, and over that of vertices */
    static const struct curve springs[] = {
        {CS_SOFT_SMALL, 8, "#2171b5", "smaller body, one step per picture", 7},
        {CS_SOFT_LARGE, 8, "#d7301f", "larger body, one step per picture", 5},
        {CS_SOFT_SMALL, 9, "#2171b5", "smaller body, stable frames", 6},
        {CS_SOFT_LARGE, 9, "#d7301f", "larger body, stable frames", 4},
    };
    static const struct curve vertices[] = {
        {CS_SOFT_MATCHED, 8, "#238b45", "shape matching", 9},
        {CS_SOFT_SURFACE, 8, "#e08214", "surface springs, one step per picture", 7},
        {CS_SOFT_NETWORK, 8, "#6a51a3", "network, one step per picture", 5},
        {CS_SOFT_SURFACE, 9, "#e08214", "surface springs, stable frames", 6},
        {CS_SOFT_NETWORK, 9, "#6a51a3", "network, stable frames", 4},
        {CS_SOFT_IMPLICIT, 9, "#1b1b1b", "network, one implicit step per frame", 13},
    };
    cs_text_add(
        out,
        "# gnuplot soft.gp makes soft.png\n"
        "set terminal pngcairo size 1500,720 font 'sans,13' background '#ffffff'\n"
        "set output 'soft.png'\nset datafile separator ','\n"
        "set multiplot layout 1,2 title \"Soft bodies: %s\" font 'sans,16' noenhanced\n",
        soft->draw ? "pictures per second, simulated and drawn"
                   : "pictures per second, simulated only");
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
