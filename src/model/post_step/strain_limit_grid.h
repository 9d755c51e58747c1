/* strain_limit_grid.h - a pass of the strain limit over a grid, many springs side by side.
 *
 * A pass goes along all rows, each from its first spring to its last, and then down: first all
 * springs from the first row to the second, and so on. A pass backwards is the same from the
 * last to the first. What is done side by side shares no particle (rows with other rows, and
 * all springs between two rows), so that the width of vectors leaves no trace in the bits. */
#ifndef CS_STRAIN_LIMIT_GRID_H
#define CS_STRAIN_LIMIT_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cs_strain_limit_grid {
    size_t n;               /* particles of all bodies */
    double *x, *v;          /* (3,n) at the grid's first particle, borrowed */
    const double *inv_mass; /* likewise, (n) in 1/kg */
    size_t columns, rows;
    double row_springs, column_springs; /* longest springs along a row and between rows, in m;
                                           0: there are none */
    double inverse_dt;                  /* 1/s: what a move does to the velocity */
};

/* One pass; the number of springs that were too long and have been shortened. */
uint64_t cs_strain_limit_grid_pass(const struct cs_strain_limit_grid *grid, bool backwards);

#endif
