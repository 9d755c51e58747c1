/* What is asked of pairs one by one. */
#include "model/pair/reaction.h"

/* column by column; the half above the diagonal is taken for both, so that it is symmetric */
void cs_reaction_turn(const struct cs_reaction *reaction, const struct cs_matrix *matrix,
                      struct cs_pair_turn *turn) {
    const struct cs_touch *touch = &reaction->touch;
    const double push = matrix->ck * cs_law_at(touch->d, touch->range, touch->k).force;
    for (int j = 0; j < 12; j++) {
        double unit[4][3] = {{0}}, column[4][3], dw[4];
        unit[j / 3][j % 3] = 1;
        cs_reaction_tangent(reaction, unit, column, dw);
        for (int i = 0; i <= j; i++)
            turn->of[i][j] = turn->of[j][i] = push * column[i / 3][i % 3];
    }
}
