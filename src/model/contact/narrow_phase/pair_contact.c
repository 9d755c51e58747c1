/* The exact Hessian term of a pair, which is not vectorised. */
#include "model/contact/narrow_phase/pair_contact.h"

/* ck F H, column by column: column j is the tangent of the gradient along unit vector j. The
 * upper triangle is used for both halves, so that rounding leaves it symmetric. */
void cs_pair_contact_hessian(const struct cs_pair_contact *reaction,
                             const struct cs_matrix *matrix, struct cs_contact_hessian *turn) {
    const struct cs_point_contact *touch = &reaction->contact;
    const double push = matrix->ck * cs_barrier_at(touch->d, touch->range, touch->k).force;
    for (int j = 0; j < 12; j++) {
        double unit[4][3] = {{0}}, column[4][3], dw[4];
        unit[j / 3][j % 3] = 1;
        cs_pair_contact_tangent(reaction, unit, column, dw);
        for (int i = 0; i <= j; i++)
            turn->m[i][j] = turn->m[j][i] = push * column[i / 3][i % 3];
    }
}
