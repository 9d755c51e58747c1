/* barrier_law.h - force between two surfaces that approach: a rational law with an energy.
 *
 * With the distance d, the range D and the stiffness k, y = d/D:
 *
 *   psi(d)  = (k D^2/12) (1-y)^4 / y                   the energy; 0 for y >= 1
 *   F = -psi' = (k D/12) (1-y)^3 (1+3y) / y^2          pushes apart
 *   K =  psi'' = (k/6) (1-y)^2 (1+2y+3y^2) / y^3       K(D/2) = 0.92 k
 *
 * psi has three continuous derivatives at y = 1 and F two, which keeps the order of methods up
 * to 4 in the mean of many contacts. Below y = 1/1000 the stiffness stays at its value there,
 * 1.67e8 k, so that a trial state that has passed through still has a finite force. To get
 * there a pair must take up 83.0 k D^2.
 *
 * A law without the pole, (k D^2/12) (1-y)^4, was tried first: at the same k a ribbon twisted
 * by four turns crossed itself. This one held.
 *
 * Branches at y = 1 and 1/1000 are written as selections, so that loops over many distances
 * vectorise. */
#ifndef CS_CONTACT_BARRIER_LAW_H
#define CS_CONTACT_BARRIER_LAW_H

#include <clothsim/clones.h>
#include <math.h>
#include <stdbool.h>

/* y below which the stiffness is constant, which keeps the forces of trial states finite. The
 * energy at the core must be far above 50 times that of what comes: a step may miss
 * CS_UNRESOLVED_ENERGY_MAX of the latter, so a lower barrier is passed unseen. At 1/20 it was
 * 1.36 k D^2, and surfaces at 10 m/s came to 1e-9 m of each other. */
#define CS_BARRIER_CORE 1e-3

/* Force F in N and stiffness K in N/m of the law at one distance. */
struct cs_barrier {
    double force, stiffness; /* N, N/m */
};

/* Clamps y into [core, 1]; *beyond is how far y lies below the core, in units of D. */
CS_INLINE double cs_barrier_core(double y, double *beyond) {
    const double inside = y < CS_BARRIER_CORE ? CS_BARRIER_CORE : y;
    *beyond = inside - y;
    return inside < 1 ? inside : 1;
}

/* F and K at the distance d; d and range D in m, k in N/m. Both are 0 from d = D on. In the
 * core F grows linearly: F(core) + K(core) D beyond. */
CS_INLINE struct cs_barrier cs_barrier_at(double d, double range, double k) {
    double beyond;
    const double y = cs_barrier_core(d / range, &beyond);
    const double a = 1 - y, inverse = 1 / y, square = a * a * (inverse * inverse);
    const double stiffness = k / 6 * (square * (1 + y * (2 + 3 * y))) * inverse;
    return (struct cs_barrier){
        k * range / 12 * (square * (a * (1 + 3 * y))) + stiffness * range * beyond, stiffness};
}

/* psi in J. In the core the integral of the linear force is added: s F + K s^2/2 over s = D
 * beyond. */
CS_INLINE double cs_barrier_energy(double d, double range, double k) {
    double beyond;
    const double y = cs_barrier_core(d / range, &beyond);
    const double a = 1 - y, square = a * a;
    const struct cs_barrier core = cs_barrier_at(y * range, range, k);
    const double further = range * beyond;
    return k * range * range / 12 * (square * square / y) +
           further * (core.force + 0.5 * core.stiffness * further);
}

/* J that a contact takes up from the range to its core, where the pole of the law ends. */
CS_INLINE double cs_barrier_capacity(double range, double k) {
    return cs_barrier_energy(CS_BARRIER_CORE * range, range, k);
}

/* m, distance at which a contact carries `load` N, to 1e-12 of the range: the range without a
 * load, 0 for one that the law does not carry. F falls with d, so that halving finds it. */
static inline double cs_barrier_loaded_distance(double range, double k, double load) {
    double low = 0, high = range;
    for (int halving = 0; halving < 40 && load > 0; halving++) {
        const double d = 0.5 * (low + high);
        if (cs_barrier_at(d, range, k).force > load)
            low = d;
        else
            high = d;
    }
    return high;
}

/* dK/dd in N/m2; 0 in the core, where K is constant, and out of range. (1-y)^2 (1+2y+3y^2) /
 * y^3 = 1/y^3 - 4 + 3y has the derivative 3 - 3/y^4, to be divided by D. */
CS_INLINE double cs_barrier_slope(double d, double range, double k) {
    const double y = d / range;
    if (!(y >= CS_BARRIER_CORE && y < 1))
        return 0;

    return k / (6 * range) * (3 - 3 / (y * y * y * y));
}

/* psi about a distance d to the second order, which is what a step knows at its start: psi, F
 * and K there in J, N and N/m. */
struct cs_barrier_model {
    double range, k, held, force, stiffness;
};

/* slopes: F and K are known, not psi alone. */
CS_INLINE struct cs_barrier_model cs_barrier_model_at(double d, double range, double k,
                                                      bool slopes) {
    const struct cs_barrier barrier = cs_barrier_at(d, range, k);
    return (struct cs_barrier_model){range, k, cs_barrier_energy(d, range, k),
                                     slopes ? barrier.force : 0,
                                     slopes ? barrier.stiffness : 0};
}

/* J, |psi(d) - (psi + F s + K s^2/2)| at a distance d, which the model holds to be nearer by s.
 */
CS_INLINE double cs_barrier_missed(const struct cs_barrier_model *model, double d, double s) {
    return fabs(cs_barrier_energy(d, model->range, model->k) - model->held - model->force * s -
                0.5 * model->stiffness * s * s);
}

#endif
