/* former.h - the contract as modules were built against it before its calls were renamed
 * (share is parallel_for now, rate bounds_at, max_share max_step_fraction). It never changes:
 * tables of ABI 1 grow at their ends alone, so a module with these offsets must still load and
 * step. Meanings are in <clothsim/integrator.h>. */
#ifndef FORMER_H
#define FORMER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum cs_type {
    CS_REAL,
    CS_INT,
    CS_BOOL,
    CS_CHOICE,
    CS_VECTOR,
    CS_COUNTS,
    CS_TEXT,
    CS_TABLE,
    CS_LIST
};
struct cs_table;

struct cs_option {
    const char *name;
    const char *unit;
    const char *help;
    enum cs_type type;
    uint32_t count;
    size_t offset;
    double def, min, max;
    const double *defs;
    const char *const *choices;
    const struct cs_table *table;
};

#define CS_HAS(table, field)                                                                   \
    ((size_t)((const char *)(&(table)->field + 1) - (const char *)(table)) <= (table)->size)

struct cs_vector_kernels {
    uint32_t size;
    void (*linear_sum)(size_t n, double a, const double *x, double b, const double *y,
                       double *z);
    double (*dot)(size_t n, const double *x, const double *y);
    double (*weighted_square)(size_t n, const double *x, const double *w);
    double (*max_norm)(size_t n, const double *x);
    void (*share)(size_t n, void (*part)(void *arg, size_t begin, size_t end), void *arg);
};

struct cs_view {
    uint32_t size;
    uint32_t n;
    const double *mass;
    const double *inv_mass;
    const double *start;
    double omega;
    double delta;
    uint32_t n_springs;
    const uint32_t *ends;
    const double *length;
    const double *stiffness;
    const double *damping;
    const uint32_t *kind;
    const uint8_t *axial;
    uint32_t n_clusters;
    const uint32_t *cluster_begin;
    const uint32_t *cluster_items;
    const double *cluster_alpha;
    const double *cluster_beta;
    const double *cluster_step;
    uint32_t n_colliders;
    const double *collider_origin, *collider_velocity, *collider_spin;
};

enum { CS_ABI = 1, CS_PART_ALL = 0x7fffffff, CS_SYMPLECTIC = 1 << 3, CS_FIDELITY_ODE = 0 };

enum cs_step { CS_STEP_OK, CS_STEP_HALT, CS_STEP_FAIL };

struct cs_host {
    uint32_t size;
    void *ctx;
    const struct cs_view *view;
    const struct cs_vector_kernels *vector;
    void *(*alloc)(void *ctx, size_t bytes);
    enum cs_step (*fail)(void *ctx, const char *format, ...);
    void (*note)(void *ctx, const char *format, ...);
    void (*force)(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                  double *f);
    double (*energy)(void *ctx, double t, const double *x, const double *v);
    void (*jvp)(void *ctx, double t, const double *x, const double *v, uint32_t parts,
                const double *dx, const double *dv, double *df);
    void (*diagonal)(void *ctx, double t, const double *x, const double *v, double *kxx,
                     double *dvv);
    enum cs_step (*solve_setup)(void *ctx, double t, const double *x, const double *v,
                                double cm, double cd, double ck, uint32_t flags);
    enum cs_step (*solve)(void *ctx, const double *b, double rtol, double *u);
    void (*apply)(void *ctx, const double *p, double *y);
    enum cs_step (*commit)(void *ctx, double t, double dt, double *x, double *v, bool *changed);
    void (*rate)(void *ctx, double t, const double *x, const double *v, double *omega,
                 double *delta);
    double (*max_share)(void *ctx, double t0, const double *x0, double t1, const double *x1);
    double (*longest_step)(void *ctx, double t, const double *x, const double *v);
    void (*blocks)(void *ctx, double t, const double *x, const double *v, double h,
                   double *blocks);
    void (*force_diagonal)(void *ctx, double t, const double *x, const double *v, double *f,
                           double *blocks);
    bool may_pass;
};

struct cs_stats {
    uint32_t size;
    uint64_t rejected;
    uint64_t newton;
    uint64_t setups;
};
struct cs_option_use;
struct cs_archive;

struct cs_integrator {
    uint32_t size;
    const char *name;
    const char *summary;
    const char *source;
    uint32_t order;
    uint32_t order_damped;
    uint32_t needs, traits;
    uint32_t fidelity;
    const char *const *fails;
    const struct cs_option *options;
    uint32_t n_options;
    uint32_t options_size;
    enum cs_step (*create)(const struct cs_host *host, const void *options, void **self);
    enum cs_step (*restart)(void *self, double t, const double *x, const double *v);
    enum cs_step (*advance)(void *self, double t0, double t1, double *x, double *v);
    void (*stats)(const void *self, struct cs_stats *out);
    void (*destroy)(void *self);
    void (*goals)(const void *self, const double *x, double *g);
    const struct cs_option_use *uses;
    uint32_t n_uses;
    enum cs_step (*save)(void *self, const struct cs_archive *archive);
    enum cs_step (*load)(void *self, const struct cs_archive *archive);
    const char *library;
};

struct cs_module {
    uint32_t abi;
    uint32_t size;
    uint32_t n;
    const struct cs_integrator *const *integrators;
};

#endif
