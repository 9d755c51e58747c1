/* sweep.h - which methods at which steps or tolerances: the cells of a comparison.
 *
 * A list is "NAME,NAME:key=value,key=low..high,SERIES=NAME:key=value,...". The cells of one
 * entry are a series, called SERIES or, where none is given, by the method and the options that
 * are not at their defaults; entries of the same method and options are one series. A range of
 * dt goes from high down by factors of 2, one of rtol by half decades. Without a range, a
 * method of fixed step takes steps of 1/fps divided by powers of 2 (explicit ones from just
 * beyond their stability limit on), an adaptive one rtol = atol from 1e-2 to 1e-9.
 */
#ifndef CS_SWEEP_H
#define CS_SWEEP_H

#include "study/compare/compare_cell.h"

#include <clothsim/integrator.h>

struct cs_sweep_settings {
    const char *list;           /* NULL: every method there is */
    const char *const *plugins; /* (n_plugins) module files */
    uint32_t n_plugins;
    double fps, omega; /* of the scene: the default steps come from them */
};

/* Zeroed: empty. */
struct cs_sweep {
    struct cs_cell *cells; /* (n) owned; those of a refused method have their outcome */
    uint32_t n, capacity;
};

/* CS_ERR_USAGE for a list that cannot be read or a method that is not there; CS_ERR_MODULE. */
enum cs_status cs_sweep_make(struct cs_sweep *sweep, const struct cs_sweep_settings *settings,
                             struct cs_error *error);
void cs_sweep_finish(struct cs_sweep *sweep);

/* Adds a cell behind those of its series that have longer steps or looser tolerances; one that
 * is there already is left as it is. CS_ERR_USAGE where the series is of another method or
 * options; CS_ERR_MEMORY. */
enum cs_status cs_sweep_add(struct cs_sweep *sweep, const struct cs_cell *cell,
                            struct cs_error *error);

/* Makes one refused cell, which says why, of a series; first is the first of its cells. */
void cs_sweep_refuse(struct cs_sweep *sweep, uint32_t first, const char *why);

/* "NAME:options" of a cell, of at most CS_CELL_INTEGRATOR characters. */
enum { CS_CELL_INTEGRATOR = 336 };
void cs_cell_integrator(const struct cs_cell *cell, char *out, size_t size);

#endif
