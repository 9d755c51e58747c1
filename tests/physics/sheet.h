/* sheet.h - flat sheets of triangles as OBJ files, for tests of membranes and bending. */
#ifndef SHEET_H
#define SHEET_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>

/* Diagonals of the cells: from top right, from top left; inner points moved by up to a quarter
 * of a cell, with the shorter diagonal. */
enum sheet_pattern { SHEET_BACK, SHEET_FORTH, SHEET_IRREGULAR };

static inline double sheet_random(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53 - 0.5;
}

/* Writes a sheet in the xy plane, from 0 to w and from 0 to h, as "sheet.obj". Columns below
 * `still` do not move. radius: of a cylinder along y that it is rolled onto; 0: none. */
static inline void sheet_write_rolled(enum sheet_pattern pattern, int columns, int rows,
                                      double w, double h, int still, double radius) {
    static double X[130 * 130], Y[130 * 130];
    const double dx = w / (columns - 1), dy = h / (rows - 1);
    const double jitter = pattern == SHEET_IRREGULAR ? 0.5 : 0;
    uint64_t seed = 7;
    FILE *file = fopen("sheet.obj", "w");
    for (int i = 0; i < rows * columns; i++) {
        const int r = i / columns, c = i % columns;
        const bool in_x = c >= still && c > 0 && c + 1 < columns, in_y = r > 0 && r + 1 < rows;
        X[i] = dx * (c + (in_x ? jitter * sheet_random(&seed) : 0));
        Y[i] = dy * (r + (in_x && in_y ? jitter * sheet_random(&seed) : 0));
        if (radius > 0)
            fprintf(file, "v %.17g %.17g %.17g\n", radius * sin(X[i] / radius), Y[i],
                    radius * (1 - cos(X[i] / radius)));
        else
            fprintf(file, "v %.17g %.17g 0\n", X[i], Y[i]);
    }
    for (int r = 0; r + 1 < rows; r++)
        for (int c = 0; c + 1 < columns; c++) {
            const int a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
            const bool forth = pattern == SHEET_IRREGULAR ? hypot(X[a] - X[e], Y[a] - Y[e]) <
                                                                hypot(X[b] - X[d], Y[b] - Y[d])
                                                          : pattern == SHEET_FORTH;
            fprintf(file, "f %d %d %d\nf %d %d %d\n", a + 1, b + 1, (forth ? e : d) + 1,
                    (forth ? a : b) + 1, e + 1, d + 1);
        }
    fclose(file);
}

static inline void sheet_write(enum sheet_pattern pattern, int columns, int rows, double w,
                               double h, int still) {
    sheet_write_rolled(pattern, columns, rows, w, h, still, 0);
}

#endif
