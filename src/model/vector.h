/* vector.h - sums in one fixed order: blocks of 4096 by 8 lanes, block sums added serially. */
#ifndef CS_MODEL_VECTOR_H
#define CS_MODEL_VECTOR_H

#include <clothsim/system.h>

extern const struct cs_vector_kernels cs_vector_kernels;

double cs_vector_dot(size_t n, const double *x, const double *y);

#endif
