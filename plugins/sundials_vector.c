/* The operations that SUNDIALS asks of a vector; see sundials_vector.h. */
#include "sundials_vector.h"

#include <math.h>

/* numbers of an array that several loops pass over while it stays in the cache */
enum { BLOCK = 512 };

static struct sundials_vectors *pool_of(N_Vector vector) {
    return ((struct sundials_slot *)vector->content)->pool;
}

static size_t length_of(N_Vector vector) {
    return 6 * (size_t)pool_of(vector)->host->view->n;
}

static N_Vector_ID get_id(N_Vector vector) {
    (void)vector;
    return SUNDIALS_NVEC_CUSTOM;
}

static sunindextype get_length(N_Vector vector) {
    return (sunindextype)length_of(vector);
}

static N_Vector clone(N_Vector vector) {
    return sundials_vectors_acquire(pool_of(vector));
}

static void release_vector(N_Vector vector) {
    ((struct sundials_slot *)vector->content)->in_use = false;
}

static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
    pool_of(z)->host->vector->linear_sum(length_of(z), a, sundials_data(x), b, sundials_data(y),
                                         sundials_data(z));
}

CS_CLONES static void set_constant(sunrealtype c, N_Vector z) {
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = c;
}

CS_CLONES static void multiply(N_Vector x, N_Vector y, N_Vector z) {
    const double *a = sundials_data(x), *b = sundials_data(y);
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = a[i] * b[i];
}

CS_CLONES static void divide(N_Vector x, N_Vector y, N_Vector z) {
    const double *a = sundials_data(x), *b = sundials_data(y);
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = a[i] / b[i];
}

CS_CLONES static void scale(sunrealtype c, N_Vector x, N_Vector z) {
    const double *a = sundials_data(x);
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = c * a[i];
    if (c == 1 && x != z) {
        pool_of(z)->copied_from = x;
        pool_of(z)->copied_to = z;
    }
}

CS_CLONES static void vector_abs(N_Vector x, N_Vector z) {
    const double *a = sundials_data(x);
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = fabs(a[i]);
}

CS_CLONES static void invert(N_Vector x, N_Vector z) {
    const double *a = sundials_data(x);
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = 1 / a[i];
}

CS_CLONES static void add_constant(N_Vector x, sunrealtype b, N_Vector z) {
    const double *a = sundials_data(x);
    double *out = sundials_data(z);
    CS_INDEPENDENT
    for (size_t i = 0, n = length_of(z); i < n; i++)
        out[i] = a[i] + b;
}

/* z = sum of c_k x_k, in their order; x_0 may be z. In blocks that stay in the cache. */
CS_CLONES static int combine(int n, sunrealtype *c, N_Vector *x, N_Vector z) {
    const struct cs_vector_kernels *vector = pool_of(z)->host->vector;
    const size_t length = length_of(z);
    for (size_t start = 0; start < length; start += BLOCK) {
        const size_t count = length - start < BLOCK ? length - start : BLOCK;
        const double *first = sundials_data(x[0]) + start;
        double *out = sundials_data(z) + start;
        CS_INDEPENDENT
        for (size_t i = 0; i < count; i++)
            out[i] = c[0] * first[i];
        for (int k = 1; k < n; k++)
            vector->linear_sum(count, c[k], sundials_data(x[k]) + start, 1, out, out);
    }
    return 0;
}

/* z_k = a_k x + y_k; z_k may be y_k. Block by block, so that x is read once. */
static int add_multiples(int n, sunrealtype *a, N_Vector x, N_Vector *y, N_Vector *z) {
    const struct cs_vector_kernels *vector = pool_of(x)->host->vector;
    const size_t length = length_of(x);
    for (size_t start = 0; start < length; start += BLOCK) {
        const size_t count = length - start < BLOCK ? length - start : BLOCK;
        for (int k = 0; k < n; k++)
            vector->linear_sum(count, a[k], sundials_data(x) + start, 1,
                               sundials_data(y[k]) + start, sundials_data(z[k]) + start);
    }
    return 0;
}

static sunrealtype dot(N_Vector x, N_Vector y) {
    return pool_of(x)->host->vector->dot(length_of(x), sundials_data(x), sundials_data(y));
}

static sunrealtype max_norm(N_Vector x) {
    return pool_of(x)->host->vector->max_norm(length_of(x), sundials_data(x));
}

static sunrealtype weighted_norm(N_Vector x, N_Vector w) {
    const size_t n = length_of(x);
    return sqrt(pool_of(x)->host->vector->weighted_sum_of_squares(n, sundials_data(x),
                                                                  sundials_data(w)) /
                (double)n);
}

static sunrealtype smallest(N_Vector x) {
    const double *a = sundials_data(x);
    double least = a[0];
    for (size_t i = 1, n = length_of(x); i < n; i++)
        if (a[i] < least)
            least = a[i];
    return least;
}

static const struct _generic_N_Vector_Ops operations = {
    .nvgetvectorid = get_id,
    .nvclone = clone,
    .nvcloneempty = clone,
    .nvdestroy = release_vector,
    .nvgetlength = get_length,
    .nvlinearsum = linear_sum,
    .nvconst = set_constant,
    .nvprod = multiply,
    .nvdiv = divide,
    .nvscale = scale,
    .nvabs = vector_abs,
    .nvinv = invert,
    .nvaddconst = add_constant,
    .nvdotprod = dot,
    .nvmaxnorm = max_norm,
    .nvwrmsnorm = weighted_norm,
    .nvmin = smallest,
    .nvlinearcombination = combine,
    .nvscaleaddmulti = add_multiples,
};

enum cs_step sundials_vectors_init(struct sundials_vectors *pool, const struct cs_host *host,
                                   int n, SUNContext context) {
    pool->host = host;
    pool->ops = operations;
    if (!(pool->slots = host->alloc(host->ctx, (size_t)n * sizeof *pool->slots)))
        return CS_STEP_FAIL;
    for (; pool->n < n; pool->n++) {
        struct sundials_slot *slot = pool->slots + pool->n;
        slot->pool = pool;
        slot->vector.content = slot;
        slot->vector.ops = &pool->ops;
        slot->vector.sunctx = context;
        slot->data = host->alloc(host->ctx, 6 * sizeof(double) * host->view->n);
        if (!slot->data)
            return CS_STEP_FAIL;
    }
    return CS_STEP_OK;
}

N_Vector sundials_vectors_acquire(struct sundials_vectors *pool) {
    for (int i = 0; i < pool->n; i++)
        if (!pool->slots[i].in_use) {
            pool->slots[i].in_use = true;
            return &pool->slots[i].vector;
        }
    return NULL;
}
