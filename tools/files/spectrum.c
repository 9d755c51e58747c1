/* Computes spectra by the fast Fourier transform, and finds their peaks. */
#include "files/spectrum.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Fraction of the highest peak, and periods in the samples, that a peak has at least. */
#define PEAK_LEAST 0.04
#define PERIODS    2
/* Largest deviation of a sample's time, as a fraction of the distance of samples. */
#define EVEN 1e-3
/* Samples are at least so many seconds apart, and at most its inverse: frequencies are finite.
 */
#define APART 1e-300

enum { SAMPLES_MIN = 8 };

/* Transforms n numbers, a power of two, in place (Cooley, Tukey 1965): bits of the index
 * reversed, then butterflies of rising length. */
static void transform(double complex *a, size_t n) {
    for (size_t i = 0, j = 0; i < n; i++) {
        if (i < j) {
            const double complex other = a[i];
            a[i] = a[j];
            a[j] = other;
        }
        /* adds 1 to the reversed index */
        size_t bit = n >> 1;
        for (; bit && j & bit; bit >>= 1)
            j ^= bit;
        j |= bit;
    }
    for (size_t length = 2; length <= n; length *= 2)
        for (size_t k = 0; k < length / 2; k++) {
            const double angle = -2 * M_PI * (double)k / (double)length;
            const double complex turn = cos(angle) + sin(angle) * (double complex)I;
            for (size_t at = k; at < n; at += length) {
                const double complex even = a[at], odd = turn * a[at + length / 2];
                a[at] = even + odd;
                a[at + length / 2] = even - odd;
            }
        }
}

/* Distance of the samples in s; 0 after a failure. */
static double sample_distance(const struct cs_number_table *table, uint32_t t,
                              struct cs_error *error) {
    if (t == table->columns || table->rows < SAMPLES_MIN) {
        cs_fail(error, CS_ERR_USAGE,
                "--spectrum: found %u rows%s, expected %d or more over \"t\"", table->rows,
                t == table->columns ? " without a column \"t\"" : "", SAMPLES_MIN);
        return 0;
    }
    const double first = cs_number_table_at(table, 0, t),
                 dt = (cs_number_table_at(table, table->rows - 1, t) - first) /
                      (table->rows - 1);
    if (!(dt > APART && dt < 1 / APART)) {
        cs_fail(error, CS_ERR_USAGE, "--spectrum: found samples %g s apart, expected above 0",
                dt);
        return 0;
    }
    for (uint32_t r = 0; r < table->rows; r++)
        if (!(fabs(cs_number_table_at(table, r, t) - first - r * dt) <= EVEN * dt)) {
            cs_fail(error, CS_ERR_USAGE,
                    "--spectrum: found t = %g s in row %u, expected equal distances (%g s)",
                    cs_number_table_at(table, r, t), r + 1, first + r * dt);
            return 0;
        }
    return dt;
}

/* line (size) = transform of a column about its mean, under the window, with zeros after it. */
static void transform_column(const struct cs_number_table *table, uint32_t column,
                             double complex *line, size_t size) {
    const uint32_t n = table->rows;
    double mean = 0;
    for (uint32_t r = 0; r < n; r++)
        mean += cs_number_table_at(table, r, column) / n;
    memset(line, 0, size * sizeof *line);
    for (uint32_t r = 0; r < n; r++)
        line[r] = (cs_number_table_at(table, r, column) - mean) *
                  (0.5 - 0.5 * cos(2 * M_PI * r / (n - 1)));
    transform(line, size);
}

/* out's column of amplitudes; added: as a component of the vector there. */
static void set_amplitudes(struct cs_number_table *table, uint32_t column,
                           const double complex *line, double window, bool added) {
    for (uint32_t r = 0; r < table->rows; r++) {
        double *at = table->values + (size_t)r * table->columns + column;
        const double amplitude = 2 * cabs(line[r]) / window;
        *at = added ? hypot(*at, amplitude) : amplitude;
    }
}

enum cs_status cs_spectrum_make(struct cs_number_table *table, const char *joint,
                                double *seconds, struct cs_arena *arena,
                                struct cs_error *error) {
    const uint32_t t = cs_number_table_find(table, "t");
    struct cs_number_table out = {
        .columns = joint ? 2 : 1,
        .names = {cs_arena_copy_text(arena, "frequency in Hz", error),
                  cs_arena_copy_text(arena, joint ? joint : "", error)}};
    size_t size = 1;
    const double dt = sample_distance(table, t, error);
    if (error->status)
        return error->status;
    *seconds = dt * (table->rows - 1);
    while (size < 4 * (size_t)table->rows)
        size *= 2;
    for (uint32_t c = 0; c < table->columns && !joint; c++)
        if (c != t)
            out.names[out.columns++] = table->names[c];
    out.rows = (uint32_t)(size / 2 + 1);
    out.values =
        cs_arena_alloc_array(arena, (size_t)out.rows * out.columns, sizeof *out.values, error);
    double complex *line = cs_arena_alloc_array(arena, size, sizeof *line, error);
    for (uint32_t r = 0; !error->status && r < out.rows; r++)
        out.values[(size_t)r * out.columns] = r / (dt * (double)size);
    for (uint32_t c = 0, into = 1; !error->status && c < table->columns; c++)
        if (c != t) {
            transform_column(table, c, line, size);
            /* the sum of the window */
            set_amplitudes(&out, into, line, 0.5 * (table->rows - 1), joint);
            into += !joint;
        }
    out.words = table->words;
    if (!error->status)
        *table = out;
    return error->status;
}

/* True for a local maximum at row r; *vertex: of the parabola there, in rows. */
static bool is_peak(const struct cs_number_table *table, uint32_t column, uint32_t r,
                    double least, double *vertex) {
    const double below = cs_number_table_at(table, r - 1, column),
                 here = cs_number_table_at(table, r, column),
                 above = cs_number_table_at(table, r + 1, column);
    const double left = log(below), middle = log(here), right = log(above);
    *vertex = r + (left - right) / (2 * (left - 2 * middle + right));
    return here > least && below < here && here >= above;
}

/* Frequencies in Hz of the lowest peaks of a column; returns their number. */
static uint32_t find_peaks(const struct cs_number_table *table, uint32_t column, double seconds,
                           double peaks[CS_SPECTRUM_PEAKS]) {
    const double spacing = cs_number_table_at(table, 1, 0);
    double most = 0, vertex;
    uint32_t n = 0;
    for (uint32_t r = 0; r < table->rows; r++)
        most = fmax(most, cs_number_table_at(table, r, column));
    for (uint32_t r = (uint32_t)ceil(PERIODS / (seconds * spacing));
         r + 1 < table->rows && n < CS_SPECTRUM_PEAKS; r++)
        if (is_peak(table, column, r, PEAK_LEAST * most, &vertex))
            peaks[n++] = vertex * spacing;
    return n;
}

/* Marks the point of a line that is nearest to a frequency. */
static void mark_point(struct cs_series *series, double frequency) {
    struct cs_point *nearest = series->points;
    for (struct cs_point *p = series->points; p < series->points + series->n; p++)
        if (fabs(p->x - frequency) < fabs(nearest->x - frequency))
            nearest = p;
    nearest->mark = CS_MARK_FULL;
}

void cs_spectrum_add_peaks(struct cs_diagram *plot, const struct cs_number_table *table,
                           double seconds) {
    for (uint32_t k = 0; k < plot->n_panels; k++)
        for (uint32_t s = 0; s < plot->panels[k].n_series; s++) {
            struct cs_series *series = plot->panels[k].series + s;
            double peaks[CS_SPECTRUM_PEAKS];
            char text[CS_LABEL_BYTES];
            const uint32_t n =
                find_peaks(table, cs_number_table_find(table, series->name), seconds, peaks);
            int at = snprintf(text, sizeof text, "%.60s:", series->name);
            for (uint32_t p = 0; p < n; p++) {
                mark_point(series, peaks[p]);
                at += snprintf(text + at, sizeof text - (size_t)at, " %.4g Hz%s", peaks[p],
                               p + 1 < n ? "," : "");
            }
            cs_diagram_add_key(plot, CS_KEY_SAMPLE, series->style.colour, ' ',
                               n ? text : "no peak has two periods in the samples")
                ->style = series->style;
        }
}
