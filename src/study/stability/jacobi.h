/* jacobi.h - eigenvalues of a small symmetric matrix. */
#ifndef CS_JACOBI_H
#define CS_JACOBI_H

#include <stdint.h>

/* Diagonalises a (n,n), which is overwritten, by cyclic Jacobi rotations (Golub and Van Loan
 * 2013, sec. 8.5): the eigenvalues stand on its diagonal, the eigenvectors in the columns of
 * vectors (n,n). Row-major. */
void cs_jacobi(uint32_t n, double *a, double *vectors);

#endif
