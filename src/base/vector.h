/* vector.h - loops over arrays in blocks of 4096, which threads share, and sums in one fixed
 * order: 8 lanes a block, block sums added serially. */
#ifndef CS_MODEL_VECTOR_H
#define CS_MODEL_VECTOR_H

#include <clothsim/system.h>

extern const struct cs_vector_kernels cs_vector_kernels;

double cs_vector_dot(size_t n, const double *x, const double *y);

/* Calls part(arg, begin, end) for every block of 0..n-1, several at the same time: a part may
 * write only what belongs to its items, and blocks are smaller where threads share them. */
void cs_vector_parallel_for(size_t n, void (*part)(void *arg, size_t begin, size_t end),
                            void *arg);

/* The sum of part(arg, begin, end) over the blocks, one after the other; parts are made at the
 * same time and only look. 0 where n is 0. */
double cs_vector_sum(size_t n, double (*part)(const void *arg, size_t begin, size_t end),
                     const void *arg);

#endif
