/* stability_state.h - settings of a stability map, and its results so far. */
#ifndef CS_STABILITY_STATE_H
#define CS_STABILITY_STATE_H

#include "base/hash.h"
#include "base/table.h"
#include "sim/series.h"
#include "study/stability/stability_axis.h"
#include "study/stability/stability_boundary.h"

/* Request for a map. Texts and arrays are borrowed for the life of the map. */
struct cs_stability_settings {
    struct cs_session_settings session; /* integrator: NAME or NAME:key=value,... */
    const char *folder; /* where an unfinished map is kept to go on from; NULL: nowhere */
    const char *series; /* what the map is called; NULL or "": by the method and its options */
    enum cs_axis axis;
    struct cs_range values, dt; /* of the axis, of the rows */
    uint32_t columns, rows;
    double seconds;        /* simulated by every cell, but not more than CS_CELL_STEPS steps */
    double budget;         /* s of processor time for a cell */
    struct cs_shard shard; /* of the columns; zeroed: all */
    uint32_t workers;
    /* about ten times a second, with the cells done; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
};
/* Columns and rows that a map may have at most, each. */
enum { CS_MAP_CELLS_MAX = 1024 };

/* One column: a value on the axis, its reference, its cells and their border. */
struct cs_stability_column {
    double value;                     /* of the axis */
    struct cs_reference reference;    /* with the curves of theory */
    bool has_reference, has_boundary; /* found already */
    double boundary; /* s; 0: below all that was tried; HUGE_VAL: above; NAN: unknown */
    struct cs_stability_cell *cells; /* (rows), by rising dt; dt 0: not tried yet */
};

/* The file of an unfinished map; an empty path: none. */
struct cs_journal {
    struct cs_row_table table;
    char key[CS_HASH_DIGITS];
};

/* A map and everything it owns; zeroed: empty. */
struct cs_stability {
    const struct cs_stability_settings *settings; /* borrowed */
    const struct cs_integrator *integrator;       /* of the session below */
    char series[CS_SERIES_BYTES];
    struct cs_session session;           /* the scene as it is given */
    struct cs_stability_column *columns; /* (n_columns); workers see them */
    uint32_t n_columns, n_rows;
    double scene_value; /* the scene's own value on the axis */
    double *dt;         /* (n_rows) rising */
    bool is_complete;   /* else columns of other shards are not there */
    double wall;        /* s */
    struct cs_journal journal;
    struct cs_arena arena;
};

#endif
