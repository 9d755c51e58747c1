/* nystrom.h - explicit Runge-Kutta pairs in Nystrom form, with error control.
 *
 * On dx/dt = v, dv/dt = F a Runge-Kutta method with the table a_ij and nodes c_i is
 *   V_i = v + h sum_j a_ij F_j,  X_i = x + c_i h v + h^2 sum_j (a a)_ij F_j,
 *   F_i = F(t + c_i h, X_i, V_i)
 * since c_i is the sum of the a_ij (Hairer, Norsett, Wanner 1993, sec. II.14). It stores F_i
 * of 3n numbers in place of slopes of 6n, and reads each once for both halves of the state. */
#ifndef NYSTROM_H
#define NYSTROM_H

#include "adaptive_step.h"

#include <clothsim/tableau.h>

enum { NYSTROM_STAGES = CS_TABLEAU_STAGES + 2 };

/* A pair of stages `stages`, the last of which stands at the new state: its row is b. Needs
 * sum_i b_i a_ij = b_j (1 - c_j), unless by_table. a_ij may have a diagonal for esdirk.h. */
struct nystrom_pair {
    int stages, power;                     /* power: that of the local error in h */
    bool by_table;                         /* the sum of the last stage takes all a_ij */
    const double *nodes;                   /* (stages) */
    const double (*table)[NYSTROM_STAGES]; /* (stages, NYSTROM_STAGES) a_ij */
    const double *difference;              /* (stages): weights of the error estimate */
    const double *lower_order;             /* (stages) b_j minus those of a method of order 3,
                                            * see dop853.c; NULL: none */
};

/* The stages that a sum takes, with their weights in velocity and position, and the time of
 * the sum in steps, for the free motion. */
struct nystrom_sum {
    double node;
    int terms, stage[NYSTROM_STAGES];
    double velocity[NYSTROM_STAGES], position[NYSTROM_STAGES];
};

/* The sum with weights b (stages) in velocity, and in position sum_i b_i a_ij or, with nodes,
 * b_j (1 - c_j). a_ij may have a diagonal. The node is 0. */
struct nystrom_sum nystrom_sum_of(int stages, const double (*table)[NYSTROM_STAGES],
                                  const double *b, const double *nodes);

/* z (6n) = y and its free motion, plus the sum of the f (3,n) each, in m/s2; with y NULL the
 * sum alone. */
void nystrom_combine(const struct cs_host *host, const struct nystrom_sum *sum,
                     double *const *f, double h, const double *y, double *z);

/* The sum of stage i of a pair; that of the last one leads to the new state. */
struct nystrom_sum nystrom_stage(const struct nystrom_pair *pair, int i);

/* Calls of the descriptor; create with struct adaptive_options. lower: the pair of lower order
 * that may take steps (see nystrom.c); NULL: none. */
enum cs_step nystrom_create(const struct cs_host *host, const void *options,
                            const struct nystrom_pair *pair, const struct nystrom_pair *lower,
                            void **out);
enum cs_step nystrom_restart(void *self, double t, const double *x, const double *v);
enum cs_step nystrom_archive(void *self, const struct cs_archive *archive);

#define NYSTROM_METHOD(struct_, rows_)                                                         \
    ADAPTIVE_METHOD_OF(struct_, rows_, nystrom_restart, nystrom_archive)

#endif
