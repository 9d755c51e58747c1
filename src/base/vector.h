/* vector.h - loops over arrays in blocks, shared among threads, and sums in one fixed order:
 * blocks of 4096, 8 lanes per block, block sums added serially. */
#ifndef CS_MODEL_VECTOR_H
#define CS_MODEL_VECTOR_H

#include <clothsim/system.h>

/* The kernels of the module contract. */
extern const struct cs_vector_kernels cs_vector_kernels;

/* Dot product of two arrays of n numbers; and one that is summed in the order of the index. */
double cs_vector_dot(size_t n, const double *x, const double *y);
double cs_vector_dot_in_order(size_t n, const double *x, const double *y);

/* Calls part(arg, begin, end) for blocks that cover 0..n-1, concurrently. A part must write
 * only what belongs to its own items. The size of blocks depends on the number of threads, so
 * no sum may depend on it. */
void cs_vector_parallel_for(size_t n, void (*part)(void *arg, size_t begin, size_t end),
                            void *arg);

/* Sets *low and *high to the smallest and largest of now - then, for n > 0; a NaN in the first
 * number stays. */
void cs_vector_span(size_t n, const double *now, const double *then, double *low, double *high);

/* Returns the sum of part(arg, begin, end) over blocks of 4096, added in their order. Parts run
 * concurrently and must not write. 0 if n is 0. */
double cs_vector_sum(size_t n, double (*part)(const void *arg, size_t begin, size_t end),
                     const void *arg);

/* Compiler settings for files whose loops compute one whole item per iteration,
 * lane by lane, and must vectorise. Include it before everything that is inlined there. */

#if defined(__GNUC__) && !defined(__clang__)
/* Otherwise gcc keeps branches around operations that could trap, and does not vectorise such
 * loops. Results are the same. */
#pragma GCC optimize("no-trapping-math")
#endif

#endif
