/* stability_state.h - settings of a stability map, and its results so far. */
#ifndef CS_STABILITY_STATE_H
#define CS_STABILITY_STATE_H

#include "base/hash.h"
#include "base/text.h"
#include "borders/sampled_run.h"
#include "borders/study_scenes.h"
#include "borders/theory.h"
#include "session/table.h"

/* Runs a trusted reference that other runs are judged by, and evaluates
 * linear theory along its trajectory.
 *
 * Linear theory holds at one state. A spring that stretches, turns or meets a collider changes
 * K and C, so the limit at the start can be too long for the rest of the run. The bounds of
 * contact are therefore evaluated at each step of the reference, the limit wherever they are
 * the tightest so far and at times of a fixed grid, and the smallest one counts. */

/* Reference run and the limits of one method. Contains no pointers: it is stored in the journal
 * of a map as it is. */
struct cs_reference {
    bool exists; /* else only the limits at the start exist, and message says why */
    char message[320];
    double steps_ahead;        /* of a run that was not begun: beyond its budget; 0: begun */
    double seconds;            /* simulated: enough for 200 steps at the limit */
    struct cs_sampled_run run; /* velocity-verlet with a small step */
    double gershgorin_limit;   /* s, limit by Gershgorin bounds, of contact along the way */
    struct cs_theory_limit start_limit;    /* before the start is perturbed */
    struct cs_theory_limit smallest_limit; /* along the way */
    double smallest_time;                  /* s, when that was */
    struct cs_theory_limit
        end_limit; /* at the end, where contact has a part; dt HUGE_VAL: none */
};

/* Runs the scene of `settings` by velocity-verlet, and finds the limits of the method of
 * `settings` along this run.
 *
 * From `settings` the run takes seconds (as a minimum), samples, perturbation and budget; it
 * chooses its step itself and halves it up to 3 times if the run is not stable. A method
 * without option dt gets no limits (HUGE_VAL). A run beyond its budget is not begun for a
 * method with option dt and without a limit: it would show no limit. A reference that fails is
 * a result: exists is false and message says why. Errors: those of scene, method, memory, or
 * CS_ERR_INTERRUPT. */
enum cs_status cs_reference_run(struct cs_reference *reference,
                                const struct cs_sampled_run_settings *settings,
                                struct cs_error *error);

/* Judges one cell of a map, and bisects the border between stable and
 * unstable steps.
 *
 * The border assumes that stability is monotone in dt near it: every shorter step is stable,
 * every longer one unstable. Resonances of a method can violate this; the bisection then finds
 * one of several borders. */

/* Steps of one cell: a sound run that reaches them is CS_STABILITY_SHORT, not stable. */
enum { CS_CELL_STEPS = 20000 };

/* Result of one cell: one step length on one scene. */
struct cs_stability_cell {
    /* s; 0: not tried yet */
    double dt;
    enum cs_stability_verdict verdict;
    double drift;       /* see cs_stability_drift; NAN if the run did not finish */
    double time;        /* s, where the verdict showed; the end of a stable one */
    uint32_t particles; /* of a local instability: most at one time */
    double crossings;   /* most of all samples; NAN where they are not counted */
};

/* Finds the largest stable step in s, *border, to 1 %.
 *
 * stable: a stable step, 0 if none is known. unstable: an unstable one, HUGE_VAL if none is
 * known; at least one of the two must be known. The search steps by factors of 4 until it has a
 * bracket, then bisects its logarithm by runs over the whole time of the reference. *border is
 * 0 if no stable step was found, HUGE_VAL if every step up to 10 s is stable, NAN if the budget
 * of a run ended. */
enum cs_status cs_stability_boundary(const struct cs_sampled_run_settings *settings,
                                     const struct cs_reference *reference, double stable,
                                     double unstable, double *border, struct cs_error *error);

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

/* Stores the results of a map while it grows, so an interrupted map
 * resumes.
 *
 * FOLDER/SERIES.partial is a sequence of binary records of equal size: a key, a kind, a column,
 * a row, and a reference, a cell or a border. The key hashes everything the results depend on,
 * so records of a different map are skipped. Each record names its map and cell, hence the
 * order of records does not matter and files can be concatenated. */

/* Opens FOLDER/SERIES.partial and takes over its results of the same map: same version, scene,
 * start, method, axis, steps, values, times. Each record is appended whole, by the process that
 * has it. Without a folder there is no journal, and all other calls do nothing. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_journal_open(struct cs_stability *stability, struct cs_error *error);

/* Append the reference of a column, one of its cells, or its border. Called by worker
 * processes; the table locks the file. CS_ERR_FILE. */
enum cs_status cs_journal_append_reference(const struct cs_stability *stability,
                                           uint32_t column, struct cs_error *error);
enum cs_status cs_journal_append_cell(const struct cs_stability *stability, uint32_t column,
                                      uint32_t row, struct cs_error *error);
enum cs_status cs_journal_append_boundary(const struct cs_stability *stability, uint32_t column,
                                          struct cs_error *error);

/* Deletes the file of a complete map. CS_ERR_FILE. */
enum cs_status cs_journal_remove(const struct cs_stability *stability, struct cs_error *error);

/* Appends the journals of the folders to those of the folder `out`; *n: journals read. A record
 * that is cut off at the end of a file is dropped. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_journal_merge(const char *const *folders, uint32_t n_folders, const char *out,
                                uint32_t *n, struct cs_error *error);

#endif
