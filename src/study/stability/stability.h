/* stability.h - which steps a method survives: cells of dt against an axis of the scene, each
 * with a verdict; the border between, bisected; and linear theory's curves beside it. */
#ifndef CS_STABILITY_H
#define CS_STABILITY_H

#include "study/stability/reference.h"

enum cs_axis { CS_AXIS_STIFFNESS, CS_AXIS_DAMPING, CS_AXIS_MASS, CS_AXIS_RESOLUTION, CS_AXES };
extern const char *const cs_axis_names[]; /* closed by NULL */
const char *cs_axis_unit(enum cs_axis axis);

/* Values from..to; 0, 0: chosen by the scene. */
struct cs_range {
    double from, to;
};

struct cs_stability_settings {
    struct cs_session_settings session; /* integrator: NAME or NAME:key=value,... */
    enum cs_axis axis;
    struct cs_range values, dt; /* of the axis, of the rows */
    uint32_t columns, rows;
    double seconds; /* simulated by every cell, but not more than CS_CELL_STEPS steps */
    double budget;  /* s of processor time for a cell */
    uint32_t workers;
    /* about ten times a second, with the cells done; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
};
enum { CS_CELL_STEPS = 20000, CS_MAP_MOST = 64 };

struct cs_stability_cell {
    double dt;
    enum cs_fate verdict;
    double drift;       /* see cs_fate_drift; NAN where the run did not come to its end */
    double time;        /* s, where the verdict showed; the end of a stable one */
    uint32_t particles; /* of a local instability: most at one time */
};

struct cs_stability_column {
    double value;                  /* of the axis */
    struct cs_reference reference; /* with the curves of theory */
    double border; /* s; 0: below all that was tried; HUGE_VAL: above; NAN: unknown */
    struct cs_stability_cell *cells; /* (rows), by rising dt */
};

struct cs_stability {
    const struct cs_stability_settings *settings; /* borrowed */
    const struct cs_integrator *integrator;       /* of the session below */
    struct cs_session session;                    /* the scene as it is given */
    struct cs_stability_column *columns;          /* (n_columns); workers see them */
    uint32_t n_columns, n_rows;
    double own;  /* the scene's own value on the axis */
    double *dt;  /* (n_rows) rising */
    double wall; /* s */
    struct cs_arena arena;
};

/* Makes the map. CS_ERR_USAGE where the integrator has no fixed dt or the axis no meaning in
 * the scene. settings outlive the map; cs_stability_finish is to be called either way. */
enum cs_status cs_stability_run(struct cs_stability *map,
                                const struct cs_stability_settings *settings,
                                struct cs_error *error);
void cs_stability_finish(struct cs_stability *map);

/* Overrides that give every body of the scene the value on the axis, in proportion to what the
 * scene has; cells of the grid for the resolution. Appended to the given ones. */
enum cs_status cs_axis_overrides(const struct cs_system *system, enum cs_axis axis,
                                 double value, struct cs_arena *arena,
                                 const struct cs_override *given, uint32_t n_given,
                                 const struct cs_override **out, uint32_t *n_out,
                                 struct cs_error *error);
/* The scene's own value: that of the first body (stretch stiffness, damping, mass of a
 * particle, columns of the grid); 0 where it has none. */
double cs_axis_own(const struct cs_system *system, enum cs_axis axis);
/* Values that the axis covers where none are asked for. */
struct cs_range cs_axis_range(const struct cs_system *system, enum cs_axis axis);

/* One cell, judged by a reference; CS_FATE_SHORT where CS_CELL_STEPS ended a sound run. */
enum cs_status cs_stability_try(const struct cs_trial_settings *settings,
                                const struct cs_reference *reference, double dt,
                                struct cs_stability_cell *cell, struct cs_error *error);

/* The largest stable step: from a step on that is stable (0: none is known) and one that is
 * not (HUGE_VAL: none is known), found and bisected to 1 % by runs over the whole time; NAN
 * where the budget of one ran out. */
enum cs_status cs_stability_border(const struct cs_trial_settings *settings,
                                   const struct cs_reference *reference, double stable,
                                   double unstable, double *border, struct cs_error *error);

/* How a map looks: as a table for people, one row a cell, and as JSON. */
void cs_stability_print_table(const struct cs_stability *map, struct cs_text *out);
void cs_stability_print_csv(const struct cs_stability *map, struct cs_text *out);
void cs_stability_print_borders_csv(const struct cs_stability *map, struct cs_text *out);
void cs_stability_print_json(const struct cs_stability *map, struct cs_text *out);
/* A gnuplot script that draws NAME.png from NAME.csv and NAME_border.csv, all in one folder. */
void cs_stability_print_plot(const struct cs_stability *map, const char *name,
                             struct cs_text *out);

#endif
