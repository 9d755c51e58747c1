/* sweep_cell.h - one cell of a sweep: its values, its key, its run, its row; and the rows of
 * sweep.csv by their cells. A row begins with the number of its cell and ends with its key.
 *
 * The number of a cell is a mixed-radix number: the last key is its fastest digit, the first
 * key a slow one, and the method the slowest. */
#ifndef CS_SWEEP_CELL_H
#define CS_SWEEP_CELL_H

#include "base/hash.h"
#include "base/text.h"
#include "session/session.h"
#include "session/table.h"

enum { CS_PARAMETER_SWEEP_CELLS_MAX = 10000000, CS_PARAMETER_AXES_MAX = 16 };

/* Zeroed: none. */
struct cs_sweep_rows {
    struct cs_row_table table;
    struct cs_text names; /* first line; empty: not known yet */
    char **lines;         /* (n) owned, without their checks; NULL: not there */
    uint32_t n;
    bool unchecked;  /* tables without checks are read too */
    long long bytes; /* size of the table when it was read, with what this process appended */
    int cell_locks; /* descriptor, above 0: of the file whose byte k is locked while cell k runs
                     */
};

/* Fields of a row after its values. */
struct cs_sweep_fields {
    char *values[CS_PARAMETER_AXES_MAX], *method, *outcome, *note;
};

/* Sets the path of the table in a folder, which it makes; reads nothing. CS_ERR_FILE. */
enum cs_status cs_sweep_rows_open(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error);
/* Grows the array of lines to n; new ones are NULL. CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_reserve(struct cs_sweep_rows *rows, uint32_t n,
                                     struct cs_error *error);
/* Adds the rows of a folder, if there are any. CS_ERR_USAGE if their columns or keys are those
 * of a different sweep; CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_read(struct cs_sweep_rows *rows, const char *folder,
                                  struct cs_error *error);
/* Writes all rows in the order of the cells. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_write(struct cs_sweep_rows *rows, struct cs_error *error);
/* Number of rows that are there. */
uint32_t cs_sweep_rows_count(const struct cs_sweep_rows *rows);
/* The key of a row, its last column. */
const char *cs_sweep_row_key(const char *line);
/* Appends a line, with its end, and stores it. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_sweep_rows_append(struct cs_sweep_rows *rows, uint32_t cell,
                                    const struct cs_text *line, struct cs_error *error);
/* Cuts a line of n_keys values in place. Returns false if it has fewer fields. */
bool cs_sweep_row_cut(char *line, uint32_t n_keys, struct cs_sweep_fields *fields);
/* Drops the rows of failed cells. */
void cs_sweep_rows_drop_failed(struct cs_sweep_rows *rows, uint32_t n_keys);

/* Claims a cell for this process until it releases it or ends. Returns false if another process
 * has the cell, or has finished it meanwhile; its row is then read. On a file system without
 * locks every claim succeeds. CS_ERR_FILE, CS_ERR_MEMORY. */
bool cs_sweep_rows_lock_cell(struct cs_sweep_rows *rows, uint32_t cell, const char *folder,
                             struct cs_error *error);
void cs_sweep_rows_unlock_cell(const struct cs_sweep_rows *rows, uint32_t cell);
/* True if another process runs the cell. */
bool cs_sweep_rows_is_locked(const struct cs_sweep_rows *rows, uint32_t cell);

/* Frees all lines. */
void cs_sweep_rows_finish(struct cs_sweep_rows *rows);

/* Settings of a parameter sweep, and its counts so far. */

/* One key of the scene and its values. */
struct cs_parameter_axis {
    const char *path;
    char **values; /* (n) */
    uint32_t n;
};

/* Request and counts; pointers are borrowed. */
struct cs_parameter_sweep {
    struct cs_session_settings session; /* scene, plugins; integrator is not used */
    struct cs_parameter_axis keys[CS_PARAMETER_AXES_MAX];
    uint32_t n_keys;
    const char *const *methods; /* (n_methods) "NAME:options"; 0: the scene's own */
    uint32_t n_methods;
    uint32_t frames;
    struct cs_shard shard;
    const char *folder; /* of sweep.csv */
    bool overwrite;     /* an earlier sweep.csv is written over */
    bool retry_failed;  /* rows of cells that failed are dropped first */
    /* limits: cells at a time; s of a cell, and of one call into a module; bytes of the address
     * space of a cell; 0: any, and one cell */
    uint32_t jobs;
    double cell_seconds, call_seconds, cell_bytes;
    void (*progress)(void *ctx, uint32_t n_done, uint32_t total);
    void *ctx;
    struct cs_parameter_sweep_counts {
        uint32_t cells, done, reused;       /* in all; there now; of those, from earlier runs */
        uint32_t refused, failed, blown_up; /* of those there now */
        uint32_t running;         /* by other processes; of cs_parameter_sweep_count */
        char first_refusal[1024]; /* the message of the first refused one */
    } counts;                     /* out */
    /* out: of the first cell that failed by the machine, not by its scene or method */
    struct cs_error cell_failure;
    struct cs_text failed; /* out, owned: a line for each of the first failed cells */
};

/* The columns of sweep.csv behind the number of the cell and a column for each key. */
extern const struct cs_column cs_parameter_sweep_columns[];
extern const uint32_t cs_parameter_sweep_n_columns;

/* The last key changes first, and the method last. Zeroed: closed. */
struct cs_sweep_cell {
    uint32_t number;
    struct cs_override overrides[CS_PARAMETER_AXES_MAX];
    const char *method;        /* NULL: the scene's own */
    struct cs_session session; /* up to the plan, unless it was refused */
    struct cs_error refusal;   /* why it was */
    char key[CS_HASH_DIGITS];
};

/* Adds the names of the columns, without the end of the line. */
void cs_sweep_add_names(const struct cs_parameter_sweep *sweep, struct cs_text *out);

/* Reads the scene with the cell's values and computes its key: a hash of the resolved scene
 * with its mesh files, of method, options and module, of frames and version. The key of a
 * refused cell hashes the request and the reason. A refusal is no error here. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_sweep_cell_open(struct cs_sweep_cell *cell,
                                  const struct cs_parameter_sweep *sweep, uint32_t number,
                                  struct cs_error *error);

/* Runs the cell and adds its row, under these names. A failure is a row. CS_ERR_INTERRUPT,
 * CS_ERR_MEMORY. */
enum cs_status cs_sweep_cell_run(struct cs_sweep_cell *cell,
                                 const struct cs_parameter_sweep *sweep, const char *names,
                                 struct cs_text *out, struct cs_error *error);
void cs_sweep_cell_close(struct cs_sweep_cell *cell);

/* Adds the row of a cell whose process left none, with the reason as its note. */
void cs_sweep_cell_add_lost(uint32_t number, const struct cs_parameter_sweep *sweep,
                            const char *note, const char *key, const char *names,
                            struct cs_text *out);

#endif
