/* spring_sweep.h - sweeps over groups of springs, with vectors of WIDTH springs: the whole of
 * spring_sweep_2.c, spring_sweep_4.c and spring_sweep_8.c. */
#include "positions.h"
#include "spring_groups.h"

#include <float.h>
#include <math.h>

/* WIDTH numbers of a group. */
CS_INLINE lanes *at(double *numbers) {
    return (lanes *)numbers;
}

CS_CLONES static void note_old(struct spring_groups *self) {
    lanes a[PLACE], b[PLACE];
    for (size_t k = 0; (self->is_damped || self->relative) && k < self->n * (size_t)LANES;
         k += WIDTH) {
        const size_t g = k / LANES, l = k % LANES;
        read_positions(self->positions, self->groups[g].a + l, a);
        read_positions(self->positions, self->groups[g].b + l, b);
        for (size_t c = 0; c < 3; c++) {
            *at(self->axial[g].old[c] + l) = b[c] - a[c];
            if (self->relative)
                *at(self->relative[g].old[c] + l) = b[c] - a[c];
        }
    }
}

/* Corrects WIDTH springs of a group, from lane `first` on, with their axial dampers. */
CS_INLINE void project_springs(struct spring_group *group, struct axial_group *axial,
                               size_t first, const bool damped, bool is_first, lanes *a,
                               lanes *b) {
    const lanes dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
    const lanes kept = is_first ? (lanes){0} : *at(group->multiplier + first);
    const lanes compliance = *at(group->compliance + first);
    // two particles in one place have no direction: d is 0, and nothing moves
    lanes length = DBL_MIN + dx * dx + dy * dy + dz * dz, weight = a[3] + b[3];
    for (size_t l = 0; l < WIDTH; l++)
        length[l] = sqrt(length[l]);
    lanes miss = *at(group->length + first) - length - compliance * kept;
    if (damped) {
        const lanes gamma = *at(axial->gamma + first);
        miss -= gamma * (dx / length * (dx - *at(axial->old[0] + first)) +
                         dy / length * (dy - *at(axial->old[1] + first)) +
                         dz / length * (dz - *at(axial->old[2] + first)));
        weight *= 1 + gamma;
    }
    // the rest as in project_dampers: along d, by inverse masses
    const lanes change = miss / (weight + compliance), push = change / length;
    *at(group->multiplier + first) = kept + change;
    const lanes moved[3] = {dx * push, dy * push, dz * push};
    for (size_t c = 0; c < 3; c++) {
        a[c] -= a[3] * moved[c];
        b[c] += b[3] * moved[c];
    }
}

/* Corrects their relative dampers: the constraints d = old. */
CS_INLINE void project_dampers(struct relative_group *damper, size_t first, bool is_first,
                               lanes *a, lanes *b) {
    for (size_t c = 0; c < 3; c++)
        for (size_t l = 0; l < WIDTH; l++) {
            double *multiplier = damper->multiplier[c] + first + l;
            const double kept = is_first ? 0 : *multiplier;
            const double compliance = damper->compliance[first + l], d = b[c][l] - a[c][l];
            const double change = (damper->old[c][first + l] - d - compliance * kept) /
                                  (a[3][l] + b[3][l] + compliance);
            *multiplier = kept;
            // no damper
            if (!(compliance > 0))
                continue;
            *multiplier += change;
            a[c][l] -= a[3][l] * change;
            b[c][l] += b[3][l] * change;
        }
}

/* One pass; `damped` and `related` are constants of every caller. */
CS_INLINE void sweep_groups(struct spring_groups *self, bool is_first, const bool damped,
                            const bool related) {
    lanes a[PLACE], b[PLACE];
    for (size_t g = 0; g < self->n; g++)
        for (size_t first = 0; first < LANES; first += WIDTH) {
            struct spring_group *group = self->groups + g;
            read_positions(self->positions, group->a + first, a);
            read_positions(self->positions, group->b + first, b);
            project_springs(group, self->axial + g, first, damped, is_first, a, b);
            if (related)
                project_dampers(self->relative + g, first, is_first, a, b);
            write_positions(self->positions, group->a + first, a);
            write_positions(self->positions, group->b + first, b);
        }
}

CS_CLONES static void sweep(struct spring_groups *self, bool is_first) {
    if (self->relative)
        sweep_groups(self, is_first, true, true);
    else if (self->is_damped)
        sweep_groups(self, is_first, true, false);
    else
        sweep_groups(self, is_first, false, false);
}

#define JOIN(name, width) name##width
#define OF_WIDTH(width)   JOIN(spring_sweeps_, width)
const struct spring_sweeps OF_WIDTH(WIDTH) = {note_old, sweep};
