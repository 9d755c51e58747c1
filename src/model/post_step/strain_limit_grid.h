/* strain_limit_grid.h - one pass of the strain limit over a grid, vectorised.
 *
 * A pass goes along all rows, each from its first spring to its last, then down: all springs
 * from the first row to the second, and so on. A backward pass is the exact reverse. Springs
 * that are handled side by side share no particle (different rows, or all springs between two
 * rows), so that the width of vectors does not change a bit of the result. */
#ifndef CS_STRAIN_LIMIT_GRID_H
#define CS_STRAIN_LIMIT_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A grid in the arrays of the system, which it borrows. */
struct cs_strain_limit_grid {
    size_t n;               /* particles of all bodies */
    double *x, *v;          /* (3,n) at the grid's first particle, borrowed */
    const double *inv_mass; /* likewise, (n) in 1/kg */
    size_t columns, rows;
    /* m, largest lengths of springs along rows and between rows; 0: there are none */
    double row_springs, column_springs;
    /* 1/s: change of velocity per displacement */
    double inverse_dt;
};

/* Runs one pass; returns the number of springs that were shortened. */
uint64_t cs_strain_limit_grid_pass(const struct cs_strain_limit_grid *grid, bool backwards);

#endif
