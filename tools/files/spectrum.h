/* spectrum.h - amplitude over frequency of the columns of a table, and its lowest frequencies.
 */
#ifndef CS_SPECTRUM_H
#define CS_SPECTRUM_H

#include "shared/table_plot.h"

enum { CS_SPECTRUM_PEAKS = 3 };

/* Replaces a table over equally spaced "t" by the spectra of its columns over "frequency in
 * Hz", about their means. joint: its other columns are components of one vector, and become the
 * one column `joint`; NULL: each has its own. The window of Hann lets a vibration leak into its
 * neighbours alone (Harris 1978); its mean of 1/2 is divided out, so that a line has the
 * amplitude of its vibration. The samples are followed by zeros, to four times as many or up to
 * eight, which draws a peak as a curve. *seconds: from the first to the last. CS_ERR_USAGE:
 * there is no "t", or it is not equally spaced; CS_ERR_MEMORY. */
enum cs_status cs_spectrum_make(struct cs_number_table *table, const char *joint,
                                double *seconds, struct cs_arena *arena,
                                struct cs_error *error);

/* Adds the lowest frequencies of each line of the diagram to its keys, and a mark for each. A
 * peak is above 0.04 of the highest one (the window has side lobes of 0.027), has two periods
 * in the seconds of the samples, and lies at the vertex of the parabola through three
 * logarithms. */
void cs_spectrum_add_peaks(struct cs_diagram *plot, const struct cs_number_table *table,
                           double seconds);

#endif
