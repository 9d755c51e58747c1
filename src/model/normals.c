#include "model/normals.h"

#include <float.h>
#include <math.h>

struct neighbours {
    uint32_t left, right, up, down;
};

static struct neighbours neighbours_of(const struct cs_body_range *body, uint32_t i) {
    const uint32_t row = (i - body->first) / body->columns,
                   column = (i - body->first) % body->columns;
    return (struct neighbours){
        .left = column > 0 ? i - 1 : i,
        .right = column + 1 < body->columns ? i + 1 : i,
        .up = row > 0 ? i - body->columns : i,
        .down = row + 1 < body->rows ? i + body->columns : i,
    };
}

static void difference(const double *p, uint32_t n, uint32_t from, uint32_t to, double out[3]) {
    for (size_t c = 0; c < 3; c++)
        out[c] = p[c * n + to] - p[c * n + from];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void cs_normals_update(const struct cs_system *system, const double *x) {
    const size_t n = system->view.n;
    double *nx = system->normals, *ny = nx + n, *nz = ny + n;
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *body = system->bodies + b;
        for (uint32_t i = body->first; i < body->first + body->count; i++) {
            const struct neighbours at = neighbours_of(body, i);
            double across[3], upwards[3], product[3];
            difference(x, (uint32_t)n, at.left, at.right, across);
            difference(x, (uint32_t)n, at.down, at.up, upwards);
            cross(across, upwards, product);
            const double squared =
                product[0] * product[0] + product[1] * product[1] + product[2] * product[2];
            const double inverse = 1 / sqrt(squared + DBL_MIN);
            nx[i] = product[0] * inverse;
            ny[i] = product[1] * inverse;
            nz[i] = product[2] * inverse;
        }
    }
}

void cs_normal_derivative(const struct cs_system *system, const struct cs_body_range *body,
                          uint32_t i, const double *x, const double *dx, double dn[3]) {
    const uint32_t n = system->view.n;
    const struct neighbours at = neighbours_of(body, i);
    double across[3], upwards[3], d_across[3], d_upwards[3], product[3], first[3], second[3];
    difference(x, n, at.left, at.right, across);
    difference(x, n, at.down, at.up, upwards);
    difference(dx, n, at.left, at.right, d_across);
    difference(dx, n, at.down, at.up, d_upwards);
    cross(across, upwards, product);
    cross(d_across, upwards, first);
    cross(across, d_upwards, second);

    const double inverse = 1 / sqrt(product[0] * product[0] + product[1] * product[1] +
                                    product[2] * product[2] + DBL_MIN);
    double along = 0, normal[3];
    for (int c = 0; c < 3; c++) {
        normal[c] = product[c] * inverse;
        along += normal[c] * (first[c] + second[c]);
    }
    for (int c = 0; c < 3; c++)
        dn[c] = (first[c] + second[c] - along * normal[c]) * inverse;
}
