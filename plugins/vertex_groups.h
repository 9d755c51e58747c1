/* vertex_groups.h - particles of one colour in groups of LANES, with their springs in slots.
 *
 * A slot has one spring of each particle of a group, so that a loop over the lanes of a slot is
 * a loop over vectors. Particles with fewer springs than others of their group have slots
 * without one: stiffness and damping are 0 there, and the other end is the particle itself. */
#ifndef VERTEX_GROUPS_H
#define VERTEX_GROUPS_H

#include <clothsim/integrator.h>

enum { LANES = 8 };
#define NO_SPRING UINT32_MAX

/* One spring of each particle of a group, for a step of h. */
struct spring_slot {
    double stiffness[LANES], length[LANES]; /* h^2 k in kg, L in m */
    double axial[LANES], relative[LANES];   /* h c in kg */
    uint32_t spring[LANES], other[LANES];   /* NO_SPRING and the particle itself: none */
};

struct vertex_groups {
    uint32_t *item;         /* (n_groups, LANES) particles; the last one again fills a group */
    uint32_t *slot_begin;   /* (n_groups + 1) */
    uint32_t *colour_begin; /* (n_colours + 1) in groups */
    struct spring_slot *slots;
};

/* Groups the particles by the colours of the view; [create]. Needs CS_NEED_COLOURS. */
enum cs_step vertex_groups_init(struct vertex_groups *groups, const struct cs_host *host);

/* Reads the springs' constants for a step of h in s: ramps and events change them. stiffness in
 * N/m and length in m (n_springs) are the view's, or in place of them. */
void vertex_groups_read_springs(struct vertex_groups *groups, const struct cs_view *view,
                                const double *stiffness, const double *length, double h);

#endif
