/* compare_cell.h - one row of a comparison: a method at one step or tolerance, and its results.
 */
#ifndef CS_CELL_H
#define CS_CELL_H

#include "base/hash.h"
#include "session/provenance_write.h"
#include "session/session.h"
#include "session/table.h"

/* One row. All fields are values, so rows can be copied and moved. Figures that do not apply
 * are NAN: an error beyond the horizon, an order that is not steady. */
struct cs_cell {
    char series[CS_SERIES_BYTES]; /* its curve: a method with its options, under one name */
    char method[64];
    char fixed[192];   /* options that all cells of the series share */
    char options[256]; /* all of them: "dt=0.001"; "": all at their defaults */
    char control[16];  /* "dt", "rtol", or "" */
    char outcome[48];  /* "finished", "blew up: not finite", "over budget", "gave up", "failed",
                          "refused" */
    char note[240];    /* the method's reason, or its remarks */
    char key[40];      /* hash of everything that the row depends on, but for the machine */
    char machine[CS_MACHINE_NAME], version[24]; /* that it was timed on and with */
    char state_hash[CS_HASH_DIGITS];            /* at its end */
    char module[CS_HASH_DIGITS];                /* of the method's file */
    char family[24];                            /* see cs_family_names */
    bool adaptive;
    double value;            /* of control */
    double target;           /* error that the value was sought for; NAN: of the sweep */
    double low, high;        /* further values of control may be run between them; no column */
    bool open;               /* they are the method's own, not the user's; no column */
    uint32_t declared_order; /* of the method or its variant; 0: not known; no column */
    double step;             /* mean length of an internal step in s */
    double time;             /* reached, in s */
    double error, max_error; /* m at the end: mass-weighted RMS, largest of a particle */
    double path_error, max_path_error; /* m over all frames */
    double velocity_error;             /* m/s at the end, mass-weighted RMS */
    double energy_error; /* largest |E - E_ref| over frames / largest kinetic energy */
    double centre_error, box_error; /* m, largest over frames: centre of mass, bounding box */
    double strain;                  /* largest over frames */
    double crossings;               /* most of all frames, where they are counted */
    double bar;                     /* m, error of the reference itself */
    double order;                   /* slope from the row before, where it is steady */
    double achieved;                /* error / (rtol x motion) of an adaptive method */
    double work; /* evals + jvps + iterations + sweeps: each about a pass over the springs */
    double evals, jvps, solves, iterations, sweeps, setups, steps, rejected, newton, clamped;
    double cpu, cpu_low, cpu_high; /* s: median and quartiles of rounds */
    double wall;                   /* s, of the first run */
    double runs, outliers;         /* timed ones; those far above the median */
    double ledger[CS_WORKS];       /* J, where it was asked for: see sim/energy_ledger.h */
};

/* The columns of compare.csv; every writer and the reader work by this table. */
extern const struct cs_column cs_columns[];
extern const uint32_t cs_n_columns;

/* Reads a file into malloc'd cells (n), the caller's. Columns are found by name; absent ones
 * leave their fields empty, unknown ones are ignored. A last line without its end is dropped:
 * it was being written when the process ended. Rows without a name are dropped too. unchecked:
 * a table without checks is taken. CS_ERR_FILE: also of more than 10,000 lines; CS_ERR_MEMORY.
 */
enum cs_status cs_csv_read(const char *path, bool unchecked, struct cs_cell **cells,
                           uint32_t *n, struct cs_error *error);

/* Families of methods in the order of the legend, closed by NULL. */
extern const char *const cs_family_names[];
/* Family of a method, from its traits and fidelity. */
const char *cs_family_of(const struct cs_integrator *integrator);

/* Returns the column of that name, or NULL. */
const struct cs_column *cs_column_find(const char *name);
/* Names of the columns that can be drawn, closed by NULL. */
const char *const *cs_column_axes(void);
/* Value of a cell in a column of numbers. */
double cs_cell_number(const struct cs_cell *cell, const struct cs_column *column);

/* Adds options as readers want them: "dt=0.00208333" for "dt=0.0020833333333333333". */
void cs_options_add_short(const char *options, struct cs_text *out);

/* Makes a cell without results; its series is named after the method. */
void cs_cell_init(struct cs_cell *cell, const char *method);
/* Makes rows of another machine a series of their own, "NAME@HOST": times of two machines are
 * not comparable. here: the name of this machine. */
void cs_cell_name_machine(struct cs_cell *cell, const char *here);
/* True if two cells are on one curve. */
bool cs_cell_same_series(const struct cs_cell *a, const struct cs_cell *b);
/* True if the error of the n-th cell of a list, counted from 1, is that of rounding: three
 * times in a row it hardly fell, though steps became shorter. Far from the motion (m), because
 * long steps may not fall either. */
bool cs_cell_is_rounding(const struct cs_cell *cell, uint32_t n, double motion);
/* A column's typical value at one of n cells, those of a series together. Errors under error
 * control scatter: 3.7e-8 and 7.0e-7 m were measured at tolerances 5 % apart. Typical is the
 * median over the series' cells with tolerances within half a decade, brought to the cell's own
 * in proportion; *low and *high are the ends of these values. Of other methods, and where the
 * cell has no such value, all three are the cell's own. */
double cs_cell_typical(const struct cs_cell *cells, uint32_t n, const struct cs_cell *cell,
                       const struct cs_column *column, double *low, double *high);
/* True if the run reached its last frame. */
bool cs_cell_is_finished(const struct cs_cell *cell);
/* True if the method failed or gave up: the note says why. */
bool cs_cell_has_failed(const struct cs_cell *cell);
/* True if the energy ledger is known. Comparing a number with itself tests for NAN. */
static inline bool cs_cell_has_ledger(const struct cs_cell *cell) {
    return cell->ledger[CS_WORK_INTEGRATOR] == cell->ledger[CS_WORK_INTEGRATOR];
}
/* True if edges went through triangles; false if they were not counted. */
static inline bool cs_cell_has_crossings(const struct cs_cell *cell) {
    return cell->crossings > 0;
}

#endif
