/* spring_groups.h - springs in groups of LANES that share no particle, for sweeps that correct
 * them one after the other.
 *
 * The level of a spring is one more than those of all springs before it at its ends; groups are
 * of one level, and go level by level (level scheduling, Anderson and Saad 1989). Each particle
 * is then corrected in the order of its springs: the bits are those of a loop over springs,
 * while a group is a loop over vectors. On a grid, whose springs stand row by row, a level is a
 * front through several rows. */
#ifndef SPRING_GROUPS_H
#define SPRING_GROUPS_H

#include <clothsim/integrator.h>

/* Springs of a group at once; a vector has all, four or two of them (positions.h). */
enum { LANES = 8 };

/* Springs of a group, for a step of h. Lanes left over join the particle n to itself. */
struct spring_group {
    _Alignas(64) double length[LANES]; /* L in m */
    double compliance[LANES];          /* 1/(k h h) in 1/kg */
    double multiplier[LANES];          /* l in kg m */
    uint32_t a[LANES], b[LANES];       /* where the particles begin in `positions` */
};

/* Dampers along the springs of a group: g = c/(k h), and d at the begin of the step in m. */
struct axial_group {
    _Alignas(64) double gamma[LANES];
    double old[3][LANES];
};

/* Dampers of a group against every relative velocity. */
struct relative_group {
    _Alignas(64) double compliance[LANES]; /* 1/(c h) in 1/kg, 0: none */
    double old[3][LANES];                  /* d as above */
    double multiplier[3][LANES];           /* kg m */
};

struct spring_groups {
    uint32_t n;
    uint32_t *spring;  /* (n, LANES) */
    double *positions; /* (n particles + 1, 4) x in m and the inverse mass in 1/kg */
    struct spring_group *groups;
    struct axial_group *axial;
    struct relative_group *relative; /* NULL: there are none at the begin of the run */
    bool is_damped;                  /* an axial damper acts */
};

/* Groups the springs of the view; [create]. Needs CS_NEED_SPRINGS. */
enum cs_step spring_groups_init(struct spring_groups *self, const struct cs_host *host);

/* Reads the springs' constants for a step of h in s: events and ramps change them. */
void spring_groups_read_constants(struct spring_groups *self, const struct cs_view *view,
                                  double h);

/* Reads the particles from x (3,n). */
void spring_groups_gather(struct spring_groups *self, const struct cs_view *view,
                          const double *x);

/* The loops over groups, with vectors of one width. */
struct spring_sweeps {
    /* Notes the positions read last as those at the begin of a step, for dampers. */
    void (*note_old)(struct spring_groups *self);
    /* One pass over all springs, which corrects the particles; is_first: with multipliers 0
     * before it. */
    void (*sweep)(struct spring_groups *self, bool is_first);
};
extern const struct spring_sweeps spring_sweeps_2, spring_sweeps_4, spring_sweeps_8;

/* The quickest sweeps of this processor; bits are those of all others. */
const struct spring_sweeps *spring_sweeps(void);

/* Writes the particles to x (3,n). */
void spring_groups_scatter(const struct spring_groups *self, const struct cs_view *view,
                           double *x);

#endif
