/* Loops and sums over arrays. A sum is cut into blocks of 4096 whatever the number of threads;
 * each block is summed in 8 lanes, and the block sums are added in order. The result has the
 * same bits for any number of threads and any width of vectors. */
#include "base/vector.h"

#include "base/pool.h"

#include <clothsim/clones.h>
#include <math.h>
#include <string.h>

enum {
    BLOCK = 4096,
    PART = 1024, /* items per block of loops shared by threads, where no sum depends on it */
    LANES = 8,
    WAITING = 512 /* block sums on the stack; longer arrays take several rounds */
};

/* Arguments of a shared loop. */
struct shared {
    void (*part)(void *arg, size_t begin, size_t end);
    void *arg;
    size_t n, size;
};

static void do_part(void *arg, uint32_t block) {
    const struct shared *shared = arg;
    const size_t begin = (size_t)block * shared->size, left = shared->n - begin;
    shared->part(shared->arg, begin, left < shared->size ? shared->n : begin + shared->size);
}

void cs_vector_parallel_for(size_t n, void (*part)(void *arg, size_t begin, size_t end),
                            void *arg) {
    struct shared shared = {part, arg, n, cs_pool_threads() > 1 ? PART : BLOCK};
    cs_pool_run((uint32_t)((n + shared.size - 1) / shared.size), do_part, &shared);
}

/* Arguments of a shared sum, with the sums of one round. */
struct summed {
    double (*part)(const void *arg, size_t begin, size_t end);
    const void *arg;
    size_t first, n;
    double sums[WAITING];
};

static void sum_part(void *arg, uint32_t block) {
    struct summed *summed = arg;
    const size_t begin = summed->first + (size_t)block * BLOCK, left = summed->n - begin;
    summed->sums[block] =
        summed->part(summed->arg, begin, begin + (left < BLOCK ? left : BLOCK));
}

double cs_vector_sum(size_t n, double (*part)(const void *arg, size_t begin, size_t end),
                     const void *arg) {
    double sum = 0;
    if (n <= BLOCK)
        return n ? sum + part(arg, 0, n) : sum;
    struct summed summed;
    summed.part = part;
    summed.arg = arg;
    summed.n = n;
    for (summed.first = 0; summed.first < n; summed.first += (size_t)WAITING * BLOCK) {
        const size_t left = (n - summed.first + BLOCK - 1) / BLOCK;
        const uint32_t blocks = left < WAITING ? (uint32_t)left : WAITING;
        cs_pool_run(blocks, sum_part, &summed);
        for (uint32_t b = 0; b < blocks; b++)
            sum += summed.sums[b];
    }
    return sum;
}

/* Lanes of the reduction to a span, several vectors: with fewer the compiler uses scalars. */
enum { SPAN_LANES = 32 };

/* Smallest and largest difference of each lane. */
struct span {
    double low[SPAN_LANES], high[SPAN_LANES];
};

CS_INLINE void widen(struct span *span, const double *now, const double *then) {
    for (int l = 0; l < SPAN_LANES; l++) {
        const double move = now[l] - then[l];
        span->low[l] = move < span->low[l] ? move : span->low[l];
        span->high[l] = move > span->high[l] ? move : span->high[l];
    }
}

/* Lanes are independent, because each comparison would otherwise wait for the one before. */
CS_CLONES void cs_vector_span(size_t n, const double *now, const double *then, double *low,
                              double *high) {
    struct span span;
    for (int l = 0; l < SPAN_LANES; l++)
        span.low[l] = span.high[l] = now[0] - then[0];
    for (size_t i = 0; i + SPAN_LANES <= n; i += SPAN_LANES)
        widen(&span, now + i, then + i);
    for (size_t i = n - n % SPAN_LANES; i < n; i++) {
        const double move = now[i] - then[i];
        span.low[0] = move < span.low[0] ? move : span.low[0];
        span.high[0] = move > span.high[0] ? move : span.high[0];
    }
    for (int half = SPAN_LANES / 2; half; half /= 2)
        for (int l = 0; l < half; l++) {
            const double least = span.low[half + l], most = span.high[half + l];
            span.low[l] = least < span.low[l] ? least : span.low[l];
            span.high[l] = most > span.high[l] ? most : span.high[l];
        }
    *low = span.low[0];
    *high = span.high[0];
}

/* Four of the eight lanes of a sum, and the same at any address in an array. A vector of all
 * eight would live in memory where the processor's own are shorter: with AVX2 each addition
 * then waited for stores of another width. */
enum { WIDTH = 4, VECTORS = LANES / WIDTH };
typedef double lanes __attribute__((vector_size(WIDTH * sizeof(double))));
typedef double loaded
    __attribute__((vector_size(WIDTH * sizeof(double)), aligned(sizeof(double)), may_alias));

/* Arguments of a kernel; b and z are for linear sums alone. */
struct arrays {
    const double *x, *y;
    double a, b, *z;
};

#define load(from, k) (*(const loaded *)((from) + (k)*WIDTH))

/* Adds the items after the last whole vectors to the first lanes, and then the lanes pair by
 * pair. Vectors come by address, because how a vector is passed depends on the instruction
 * set. */
CS_INLINE double sum_lanes(const lanes whole[VECTORS], const double *rest, size_t n) {
    double s[LANES];
    memcpy(s, whole, sizeof s);
    for (size_t l = 0; l < n; l++)
        s[l] += rest[l];
    return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

CS_CLONES static double dot_part(const void *arg, size_t begin, size_t end) {
    const struct arrays *arrays = arg;
    const double *x = arrays->x + begin, *y = arrays->y + begin;
    const size_t n = end - begin;
    double rest[LANES];
    lanes sum[VECTORS] = {0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t k = 0; k < VECTORS; k++)
            sum[k] += load(x + i, k) * load(y + i, k);
    for (size_t l = 0; i + l < n; l++)
        rest[l] = x[i + l] * y[i + l];
    return sum_lanes(sum, rest, n - i);
}

double cs_vector_dot(size_t n, const double *x, const double *y) {
    const struct arrays arrays = {.x = x, .y = y};
    return cs_vector_sum(n, dot_part, &arrays);
}

double cs_vector_dot_in_order(size_t n, const double *x, const double *y) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] * y[i];
    return sum;
}

/* Sum of (x_i w_i)^2 over a block. */
CS_CLONES static double weighted_part(const void *arg, size_t begin, size_t end) {
    const struct arrays *arrays = arg;
    const double *x = arrays->x + begin, *w = arrays->y + begin;
    const size_t n = end - begin;
    double rest[LANES];
    lanes sum[VECTORS] = {0};
    size_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (size_t k = 0; k < VECTORS; k++) {
            const lanes weighted = load(x + i, k) * load(w + i, k);
            sum[k] += weighted * weighted;
        }
    for (size_t l = 0; i + l < n; l++)
        rest[l] = x[i + l] * w[i + l] * (x[i + l] * w[i + l]);
    return sum_lanes(sum, rest, n - i);
}

static double weighted_square(size_t n, const double *x, const double *w) {
    const struct arrays arrays = {.x = x, .y = w};
    return cs_vector_sum(n, weighted_part, &arrays);
}

/* z = a x + b y over a block; z may be x or y. */
CS_CLONES static void linear_part(void *arg, size_t begin, size_t end) {
    const struct arrays *arrays = arg;
    const double a = arrays->a, b = arrays->b, *x = arrays->x, *y = arrays->y;
    double *z = arrays->z;
    CS_INDEPENDENT
    for (size_t i = begin; i < end; i++)
        z[i] = a * x[i] + b * y[i];
}

static void linear_sum(size_t n, double a, const double *x, double b, const double *y,
                       double *z) {
    struct arrays arrays = {x, y, a, b, z};
    cs_vector_parallel_for(n, linear_part, &arrays);
}

/* Largest magnitude. A NaN wins and stays, so that it shows in the result. */
static double max_norm(size_t n, const double *x) {
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        if (!(fabs(x[i]) <= largest) && largest == largest)
            largest = fabs(x[i]); /* a NaN is taken, and stays */
    return largest;
}

const struct cs_vector_kernels cs_vector_kernels = {
    .size = sizeof(struct cs_vector_kernels),
    .linear_sum = linear_sum,
    .dot = cs_vector_dot,
    .weighted_sum_of_squares = weighted_square,
    .max_norm = max_norm,
    .parallel_for = cs_vector_parallel_for,
};
