/* Kernels over spring runs: force, energy, Jacobian product. Rows are done in pieces that fit a
 * small buffer on the stack; within a piece no spring waits for another, so the loops
 * vectorise. */
#include "model/springs.h"

#include "model/rows.h"

#include <clothsim/integrator.h>
#include <float.h>
#include <math.h>

/* what a part asks of a run: k is 0 without its elastic force, c without its dampers */
struct asked {
    double k, c;
};

static struct asked asked_of(const struct cs_spring_run *run, uint32_t parts) {
    return (struct asked){
        parts & (CS_PART_STRETCH << run->kind) ? run->ends ? 1 : run->stiffness : 0,
        parts & CS_PART_DAMPING ? run->damping : 0};
}

/* force of one piece; listed: length and stiffness are the spring's own, and times k */
CS_INLINE void piece_force(const struct piece *piece, struct ends x, struct ends v,
                           struct asked asked, const bool listed, const bool damped,
                           const bool axial, double *restrict fx, double *restrict fy,
                           double *restrict fz) {
    const double c = asked.c, length = piece->run->length;
    const uint32_t count = piece->count;
    for (uint32_t i = 0; i < count; i++) {
        const double L = listed ? piece->lengths[i] : length;
        const double k = listed ? asked.k * piece->stiffnesses[i] : asked.k;
        const double dx = x.bx[i] - x.ax[i];
        const double dy = x.by[i] - x.ay[i];
        const double dz = x.bz[i] - x.az[i];
        /* DBL_MIN keeps two particles in one place from dividing by zero */
        const double inverse = 1 / sqrt(dx * dx + dy * dy + dz * dz + DBL_MIN);
        double pull = k * (1 - L * inverse);
        double wx = 0, wy = 0, wz = 0;
        if (damped) {
            wx = v.bx[i] - v.ax[i];
            wy = v.by[i] - v.ay[i];
            wz = v.bz[i] - v.az[i];
            if (axial)
                pull += c * ((wx * dx + wy * dy + wz * dz) * inverse * inverse);
        }
        if (damped && !axial) {
            fx[i] = pull * dx + c * wx;
            fy[i] = pull * dy + c * wy;
            fz[i] = pull * dz + c * wz;
        } else {
            fx[i] = pull * dx;
            fy[i] = pull * dy;
            fz[i] = pull * dz;
        }
    }
}

/* three copies of the loop, so that a scene without damping never reads v */
CS_INLINE void run_force(const struct cs_spring_run *run, uint32_t n, const double *x,
                         const double *v, struct asked asked, const bool listed, double *f) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    struct gathered places, speeds;
    const bool damped = asked.c != 0;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends xs = ends_of(&piece, x, n, &places);
        const struct ends vs = damped ? ends_of(&piece, v, n, &speeds) : xs;
        if (!damped)
            piece_force(&piece, xs, vs, asked, listed, false, false, fx, fy, fz);
        else if (run->axial)
            piece_force(&piece, xs, vs, asked, listed, true, true, fx, fy, fz);
        else
            piece_force(&piece, xs, vs, asked, listed, true, false, fx, fy, fz);
        scatter(&piece, fx, fy, fz, n, f);
    }
}

CS_CLONES void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                                    const double *x, const double *v, uint32_t parts,
                                    double *f) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const struct asked asked = asked_of(run, parts);
        if (asked.k == 0 && asked.c == 0)
            continue;
        if (run->ends)
            run_force(run, n, x, v, asked, true, f);
        else
            run_force(run, n, x, v, asked, false, f);
    }
}

double cs_springs_shortest(const struct cs_springs *springs) {
    double shortest = springs->n_runs ? HUGE_VAL : 0;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++)
            shortest = fmin(shortest, cs_spring_length(springs->runs + r, i));
    return shortest;
}

double cs_springs_energy(const struct cs_springs *springs, uint32_t n, const double *x,
                         uint32_t parts) {
    struct gathered places;
    double energy = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        if (!(parts & (CS_PART_STRETCH << run->kind)))
            continue;
        double sum = 0;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const struct piece piece = piece_of(run, start);
            const struct ends e = ends_of(&piece, x, n, &places);
            for (uint32_t i = 0; i < piece.count; i++) {
                const double dx = e.bx[i] - e.ax[i], dy = e.by[i] - e.ay[i];
                const double dz = e.bz[i] - e.az[i];
                const double stretch =
                    sqrt(dx * dx + dy * dy + dz * dz) - cs_spring_length(run, start + i);
                sum += (run->ends ? piece.stiffnesses[i] : 1) * (stretch * stretch);
            }
        }
        energy += 0.5 * (run->ends ? 1 : run->stiffness) * sum;
    }
    return energy;
}

double cs_springs_energy_at_twice(const struct cs_springs *springs) {
    double energy = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++)
        for (uint32_t i = 0; i < springs->runs[r].count; i++) {
            const double length = cs_spring_length(springs->runs + r, i);
            energy += 0.5 * cs_spring_stiffness(springs->runs + r, i) * length * length;
        }
    return energy;
}

/* What dx and dv at the ends do to the force of each spring of a piece: with u the unit
 * direction, l the length, e and g the differences of dx and dv, w that of v:
 *   elastic    k (1 - L/l) e + k L/l (u.e) u
 *   axial      d (g.u) u + d [(w.du) u + (w.u) du],  du = (e - (u.e) u) / l
 *   relative   d g
 * moved: dx is given; turned: dv is given. */
CS_INLINE void piece_jvp(const struct piece *piece, struct ends x, struct ends v,
                         struct ends dx, struct ends dv, struct asked asked, const bool listed,
                         const bool moved, const bool turned, double *restrict fx,
                         double *restrict fy, double *restrict fz) {
    const double axial = piece->run->axial ? asked.c : 0;
    const double relative = piece->run->axial ? 0 : asked.c;
    const double length = piece->run->length;
    const uint32_t count = piece->count;
    for (uint32_t i = 0; i < count; i++) {
        const double L = listed ? piece->lengths[i] : length;
        const double k = listed ? asked.k * piece->stiffnesses[i] : asked.k;
        const double px = x.bx[i] - x.ax[i], py = x.by[i] - x.ay[i], pz = x.bz[i] - x.az[i];
        const double inverse = 1 / sqrt(px * px + py * py + pz * pz + DBL_MIN);
        const double ux = px * inverse, uy = py * inverse, uz = pz * inverse;
        double rx = 0, ry = 0, rz = 0;
        if (moved) {
            const double ex = dx.bx[i] - dx.ax[i], ey = dx.by[i] - dx.ay[i];
            const double ez = dx.bz[i] - dx.az[i];
            const double ue = ux * ex + uy * ey + uz * ez;
            const double slack = k * (1 - L * inverse);
            double along = k * L * inverse * ue;
            const double wx = v.bx[i] - v.ax[i], wy = v.by[i] - v.ay[i], wz = v.bz[i] - v.az[i];
            const double tx = (ex - ue * ux) * inverse, ty = (ey - ue * uy) * inverse;
            const double tz = (ez - ue * uz) * inverse;
            const double closing = axial * (wx * ux + wy * uy + wz * uz);
            along += axial * (wx * tx + wy * ty + wz * tz);
            rx = slack * ex + along * ux + closing * tx;
            ry = slack * ey + along * uy + closing * ty;
            rz = slack * ez + along * uz + closing * tz;
        }
        if (turned) {
            const double gx = dv.bx[i] - dv.ax[i], gy = dv.by[i] - dv.ay[i];
            const double gz = dv.bz[i] - dv.az[i];
            const double along = axial * (gx * ux + gy * uy + gz * uz);
            rx += relative * gx + along * ux;
            ry += relative * gy + along * uy;
            rz += relative * gz + along * uz;
        }
        fx[i] = rx;
        fy[i] = ry;
        fz[i] = rz;
    }
}

CS_INLINE void run_jvp(const struct cs_spring_run *run, uint32_t n, const double *x,
                       const double *v, struct asked asked, const bool listed, const double *dx,
                       const double *dv, double *df) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    struct gathered places, speeds, moves, turns;
    for (uint32_t start = 0; start < run->count; start += PIECE) {
        const struct piece piece = piece_of(run, start);
        const struct ends xs = ends_of(&piece, x, n, &places);
        const struct ends vs = ends_of(&piece, v, n, &speeds);
        /* a direction that is not given stands for itself, and is not read */
        const struct ends xd = dx ? ends_of(&piece, dx, n, &moves) : xs;
        const struct ends vd = dv ? ends_of(&piece, dv, n, &turns) : xs;
        if (dx && dv)
            piece_jvp(&piece, xs, vs, xd, vd, asked, listed, true, true, fx, fy, fz);
        else if (dx)
            piece_jvp(&piece, xs, vs, xd, vd, asked, listed, true, false, fx, fy, fz);
        else
            piece_jvp(&piece, xs, vs, xd, vd, asked, listed, false, true, fx, fy, fz);
        scatter(&piece, fx, fy, fz, n, df);
    }
}

CS_CLONES void cs_springs_add_jvp(const struct cs_springs *springs, uint32_t n, const double *x,
                                  const double *v, uint32_t parts, const double *dx,
                                  const double *dv, double *df) {
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const struct asked asked = asked_of(run, parts);
        if ((asked.k == 0 && asked.c == 0) || (asked.c == 0 && !dx))
            continue;
        if (run->ends)
            run_jvp(run, n, x, v, asked, true, dx, dv, df);
        else
            run_jvp(run, n, x, v, asked, false, dx, dv, df);
    }
}
