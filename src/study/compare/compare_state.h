/* compare_state.h - settings of a comparison, and its results so far. */
#ifndef CS_COMPARE_STATE_H
#define CS_COMPARE_STATE_H

#include "session/table.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare_cell.h"
#include "study/compare/timing_rounds.h"
#include "study/reference/compare_reference_state.h"

/* The error norms that a comparison can be ranked by. */

/* Position norms come first (see compare_measure.c); all are distances to the reference. */
enum cs_norm {
    CS_NORM_END,
    CS_NORM_PATH,
    CS_NORM_LARGEST,
    CS_NORM_VELOCITY,
    CS_NORM_ENERGY,
    CS_NORMS
};

/* Values of --error-norm, closed by NULL, in the order of enum cs_norm. */
extern const char *const cs_norm_names[];

/* Its name in text, its unit ("" for none), and its column in compare.csv. */
const char *cs_norm_words(enum cs_norm norm);
const char *cs_norm_unit(enum cs_norm norm);
const struct cs_column *cs_norm_column(enum cs_norm norm);

/* True if the reference supports the norm: pointwise errors need a time before the horizon, the
 * energy error only families that agree. */
bool cs_norm_is_known(enum cs_norm norm, const struct cs_compare_reference *reference);

/* Error of a cell, not below the reference's own error; NAN if there is none. */
double cs_norm_of(enum cs_norm norm, const struct cs_cell *cell,
                  const struct cs_compare_reference *reference);

/* Such an error, not below the reference's own. */
double cs_norm_bounded(enum cs_norm norm, double error,
                       const struct cs_compare_reference *reference);

/* Error of a run without any information on the motion, in the unit of the norm; HUGE_VAL if
 * not known. */
double cs_norm_scale(enum cs_norm norm, const struct cs_compare_reference *reference);

/* The default budget in nominal s (cs_pass_seconds): of the sweep, of the search for equal
 * errors and of the rounds, and the most that a run may take. Search and rounds are shortened
 * alike, to PART_MIN at least, where reference and sweep leave less than they take of
 * ALL_SECONDS. Tuned on three garments of 231 to 1488 particles, whose processor time is 1.3 to
 * 3 times nominal: each ends within two minutes. */
#define CS_COMPARE_ALL_SECONDS     36.0
#define CS_COMPARE_PART_MIN        0.2
#define CS_COMPARE_SECONDS         15
#define CS_COMPARE_EQUAL_SECONDS   8.0
#define CS_COMPARE_ROUND_SECONDS   11.0
#define CS_COMPARE_RUN_SECONDS_MAX 4.0

/* Nominal s of work from which the parts of a comparison are announced. */
#define CS_COMPARE_LONG_SECONDS 5.0

/* Leading characters of a row's key: the same for all rows of a scene, time and reference. */
#define CS_COMPARE_DIGITS 16

struct cs_compare;

/* Chooses the cell to run next: *value of the control of the series of *of, which stays valid
 * until the next call; NULL: none. At the first call the cells without an outcome are those of
 * the default sweep. */
typedef enum cs_status cs_compare_next(void *ctx, struct cs_compare *compare,
                                       const struct cs_cell **of, double *value,
                                       struct cs_error *error);

/* Request for a comparison. All pointers are borrowed. */
struct cs_compare_settings {
    struct cs_recorded_run_settings run;
    const char *methods;      /* list as in cell_list_parse.h; NULL: all */
    const char *reference[2]; /* "NAME:options" of its families, or NULL */
    double accuracy;          /* m, see compare_reference.h */
    double budget;            /* nominal s of work that one run may take; 0: see below */
    double reference_budget;  /* and explicit methods of a chosen reference; 0: the default */
    bool isolates_cells;      /* each first run in a process of its own: modules from outside */
    uint32_t runs;            /* rounds of timed runs, at most; up to CS_ROUNDS_MAX */
    enum cs_norm ranking_norm; /* error norm of the ranking */
    double bound;              /* the one error to rank at; 0: all powers of 10 */
    const char *folder;        /* for compare.csv */
    const char *command;       /* that repeats it, for the report; may be NULL */
    bool html;                 /* one HTML file as well */
    bool pictures;             /* contact sheets as well */
    bool ledger;               /* each method is run once more, to say where energy went */
    struct cs_shard shard;     /* of the cells; zeroed: all */
    const char *cache;         /* folder of references */
    bool overwrite;            /* an earlier compare.csv is written over */
    cs_compare_next *next;     /* chooses the cells for `bound`; NULL: the default sweep */
    /* may be NULL; taken: the row is of an earlier run */
    void (*reference_progress)(void *ctx, uint32_t done, uint32_t total, const char *what);
    void (*on_begin)(void *ctx); /* after the reference, before the cells */
    void (*row)(void *ctx, const struct cs_cell *cell, bool taken);
    void (*on_round)(void *ctx, uint32_t done, uint32_t most); /* may be NULL */
    void *ctx;
};

/* A comparison and everything it owns; zeroed: empty. */
struct cs_compare {
    const struct cs_compare_settings *settings; /* borrowed */
    struct cs_compare_reference reference;
    struct cs_cell_list cells;
    struct cs_rounds rounds; /* of the sweep's cells */
    char scene[256];         /* path as given */
    char machine[CS_MACHINE_NAME];
    struct cs_text switched_off; /* what was switched off, "" nothing */
    char undrawn[300];           /* why there are no diagrams, "" they are there */
    struct cs_text provenance; /* origin.json: everything a row depends on besides its method */
    bool contact;              /* by force: a part of the equation of motion */
    bool by_work; /* methods are ranked by it: a program's time is that of two processes */
    uint32_t particles, springs, n_event_times; /* cuts: times of events */
    double fps, omega, time, budget;
    double pass_seconds;                  /* nominal s of one pass over the forces */
    double equal_seconds, rounds_seconds; /* nominal s of the search and of the rounds */
    uint32_t n_done;                      /* cells */
};

/* The settings of the reference, from those of the comparison. */
struct cs_compare_reference_settings
cs_compare_reference_query(const struct cs_compare_settings *settings);

/* Times the contenders for the verdict (equal_error.h) in rounds. Ends when their ratios are
 * known well enough, after settings.runs rounds, or when the work for rounds is used up.
 * Updates cpu, cpu_low, cpu_high, runs and outliers of the cells. CS_ERR_INTERRUPT,
 * CS_ERR_MEMORY. */
enum cs_status cs_compare_time(struct cs_compare *compare, struct cs_error *error);

/* Runs one cell within compare->budget and fills its errors, counts, outcome and module. cpu is
 * the time of this one run. A method that fails or blows up is an outcome. CS_ERR_INTERRUPT,
 * CS_ERR_MEMORY; the cell is then incomplete. */
enum cs_status cs_compare_measure(const struct cs_compare *compare, struct cs_cell *cell,
                                  struct cs_error *error);

/* Fills the orders of n cells, sorted by falling step within a series, where two successive
 * slopes agree. bar and scale in m: the reference's error, and the motion. */
void cs_compare_find_orders(struct cs_cell *cells, uint32_t n, double bar, double scale);

/* Stores the rows of a comparison in compare.csv while they are made, so an interrupted
 * comparison resumes. The file is locked for each read and each change. Several processes can
 * therefore fill one folder, each with its shard of cells. */

/* The open file, and the rows that it had when it was last read. */
struct cs_compare_results {
    struct cs_row_table table;
    struct cs_cell *old_rows; /* (n_old) rows of the file, owned */
    uint32_t n_old_rows;
};
/* Opens compare.csv of the folder and takes over its rows of the same scene, duration and
 * reference. A row replaces the cell with its key; other rows are added as further cells.
 * Writes the rows back, without incomplete lines. CS_ERR_USAGE if the file belongs to another
 * comparison; CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_results_open(struct cs_compare_results *results,
                                       struct cs_compare *compare, struct cs_error *error);
/* Appends one row, whole. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_results_append(struct cs_compare_results *results,
                                         const struct cs_cell *cell, struct cs_error *error);
/* Takes over the rows that other processes have appended since. */
enum cs_status cs_compare_results_refresh(struct cs_compare_results *results,
                                          struct cs_compare *compare, struct cs_error *error);
/* Writes all cells in their order, and after them rows of other processes. */
enum cs_status cs_compare_results_rewrite(struct cs_compare_results *results,
                                          const struct cs_compare *compare,
                                          struct cs_error *error);
/* Merges the compare.csv of the folders, as far as they have one, into that of the folder
 * `out`; *n: rows. unchecked: tables without checks are taken too. CS_ERR_USAGE if they belong
 * to different comparisons. */
enum cs_status cs_compare_results_merge(const char *const *folders, uint32_t n_folders,
                                        const char *out, bool unchecked, uint32_t *n,
                                        struct cs_error *error);
/* Frees the rows; the file stays. */
void cs_compare_results_close(struct cs_compare_results *results);

#endif
