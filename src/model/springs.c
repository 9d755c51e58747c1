/* Kernels over spring runs: force, energy, Jacobian product. Rows are done in pieces that fit a
 * small buffer on the stack; within a piece no spring waits for another, so the loops
 * vectorise. */
#include "model/springs.h"

#include "model/rows.h"

#include <clothsim/integrator.h>
#include <float.h>
#include <math.h>

uint32_t cs_springs_of_grid(const struct cs_body *body, uint32_t body_index, uint32_t first,
                            struct cs_spring_run *runs, uint32_t *n_springs) {
    const struct cs_spring_law *law = &body->springs;
    const uint32_t columns = (uint32_t)body->cloth.grid[0],
                   rows = (uint32_t)body->cloth.grid[1];
    const double dx = columns > 1 ? body->cloth.size[0] / (columns - 1) : 0;
    const double dy = rows > 1 ? body->cloth.size[1] / (rows - 1) : 0;
    const double stiffness[CS_SPRING_KINDS] = {law->stretch, law->shear, law->bend};

    /* the six forward directions: steps right and down */
    static const struct {
        int32_t right, down;
        uint32_t kind;
    } forward[6] = {{1, 0, CS_SPRING_STRETCH}, {0, 1, CS_SPRING_STRETCH},
                    {1, 1, CS_SPRING_SHEAR},   {-1, 1, CS_SPRING_SHEAR},
                    {2, 0, CS_SPRING_BEND},    {0, 2, CS_SPRING_BEND}};

    uint32_t n_runs = 0;
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t d = 0; d < 6; d++) {
            const int32_t right = forward[d].right, down = forward[d].down;
            const uint32_t reach = (uint32_t)(right < 0 ? -right : right);
            const double k = stiffness[forward[d].kind];
            if (i + (uint32_t)down >= rows || reach >= columns || k == 0)
                continue;
            const uint32_t row = first + i * columns, below = row + (uint32_t)down * columns;
            const double length = sqrt(right * dx * (right * dx) + down * dy * (down * dy));
            if (runs)
                runs[n_runs] = (struct cs_spring_run){
                    .a = row + (right < 0 ? reach : 0),
                    .b = below + (right > 0 ? reach : 0),
                    .count = columns - reach,
                    .kind = forward[d].kind,
                    .body = body_index,
                    .first = *n_springs,
                    .stiffness = law->stiffness_unit == CS_STIFFNESS_N ? k / length : k,
                    .length = length,
                    .damping = law->damping,
                    .axial = law->damping_model == CS_DAMPING_AXIAL,
                };
            n_runs++;
            *n_springs += columns - reach;
        }
    return n_runs;
}

/* force of one piece; k and c are 0 where the part was not asked for */
CS_INLINE void piece_force(uint32_t count, struct ends x, struct ends v, double k, double L,
                           double c, const bool damped, const bool axial, double *restrict fx,
                           double *restrict fy, double *restrict fz) {
    for (uint32_t i = 0; i < count; i++) {
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

CS_CLONES void cs_springs_add_force(const struct cs_springs *springs, uint32_t n,
                                    const double *x, const double *v, uint32_t parts,
                                    double *f) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const double k = parts & (CS_PART_STRETCH << run->kind) ? run->stiffness : 0;
        const double c = parts & CS_PART_DAMPING ? run->damping : 0;
        if (k == 0 && c == 0)
            continue;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const uint32_t left = run->count - start, count = left < PIECE ? left : PIECE;
            const uint32_t a = run->a + start, b = run->b + start;
            const struct ends xs = ends_of(x, n, a, b), vs = ends_of(v, n, a, b);
            /* three copies of the loop, so that a scene without damping never reads v */
            if (c == 0)
                piece_force(count, xs, vs, k, run->length, c, false, false, fx, fy, fz);
            else if (run->axial)
                piece_force(count, xs, vs, k, run->length, c, true, true, fx, fy, fz);
            else
                piece_force(count, xs, vs, k, run->length, c, true, false, fx, fy, fz);
            scatter(count, fx, fy, fz, n, a, b, f);
        }
    }
}

double cs_springs_energy(const struct cs_springs *springs, uint32_t n, const double *x,
                         uint32_t parts) {
    double energy = 0;
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        if (!(parts & (CS_PART_STRETCH << run->kind)))
            continue;
        const struct ends e = ends_of(x, n, run->a, run->b);
        double sum = 0;
        for (uint32_t i = 0; i < run->count; i++) {
            const double dx = e.bx[i] - e.ax[i], dy = e.by[i] - e.ay[i], dz = e.bz[i] - e.az[i];
            const double stretch = sqrt(dx * dx + dy * dy + dz * dz) - run->length;
            sum += stretch * stretch;
        }
        energy += 0.5 * run->stiffness * sum;
    }
    return energy;
}

/* What dx and dv at the ends do to the force of each spring of a piece: with u the unit
 * direction, l the length, e and g the differences of dx and dv, w that of v:
 *   elastic    k (1 - L/l) e + k L/l (u.e) u
 *   axial      d (g.u) u + d [(w.du) u + (w.u) du],  du = (e - (u.e) u) / l
 *   relative   d g
 * moved: dx is given; turned: dv is given. */
CS_INLINE void piece_jvp(uint32_t count, struct ends x, struct ends v, struct ends dx,
                         struct ends dv, const struct cs_spring_run *run, double k, double c,
                         const bool moved, const bool turned, double *restrict fx,
                         double *restrict fy, double *restrict fz) {
    const double L = run->length;
    const double axial = run->axial ? c : 0, relative = run->axial ? 0 : c;
    for (uint32_t i = 0; i < count; i++) {
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

CS_CLONES void cs_springs_add_jvp(const struct cs_springs *springs, uint32_t n, const double *x,
                                  const double *v, uint32_t parts, const double *dx,
                                  const double *dv, double *df) {
    double fx[PIECE], fy[PIECE], fz[PIECE];
    for (uint32_t r = 0; r < springs->n_runs; r++) {
        const struct cs_spring_run *run = springs->runs + r;
        const double k = parts & (CS_PART_STRETCH << run->kind) ? run->stiffness : 0;
        const double c = parts & CS_PART_DAMPING ? run->damping : 0;
        if ((k == 0 && c == 0) || (c == 0 && !dx))
            continue;
        for (uint32_t start = 0; start < run->count; start += PIECE) {
            const uint32_t left = run->count - start, count = left < PIECE ? left : PIECE;
            const uint32_t a = run->a + start, b = run->b + start;
            const struct ends xs = ends_of(x, n, a, b), vs = ends_of(v, n, a, b);
            /* a direction that is not given stands for itself, and is not read */
            const struct ends xd = ends_of(dx ? dx : x, n, a, b);
            const struct ends vd = ends_of(dv ? dv : v, n, a, b);
            if (dx && dv)
                piece_jvp(count, xs, vs, xd, vd, run, k, c, true, true, fx, fy, fz);
            else if (dx)
                piece_jvp(count, xs, vs, xd, vd, run, k, c, true, false, fx, fy, fz);
            else
                piece_jvp(count, xs, vs, xd, vd, run, k, c, false, true, fx, fy, fz);
            scatter(count, fx, fy, fz, n, a, b, df);
        }
    }
}
