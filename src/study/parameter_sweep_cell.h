/* parameter_sweep_cell.h - one cell of a sweep: its values, its key, its run, its row.
 *
 * The number of a cell is a mixed-radix number: the last key is its fastest digit, the first
 * key a slow one, and the method the slowest. */
#ifndef CS_PARAMETER_SWEEP_CELL_H
#define CS_PARAMETER_SWEEP_CELL_H

#include "base/hash.h"
#include "study/parameter_sweep_state.h"

/* The last key changes first, and the method last. Zeroed: closed. */
struct cs_parameter_sweep_cell {
    uint32_t number;
    struct cs_override overrides[CS_PARAMETER_AXES_MAX];
    const char *method;        /* NULL: the scene's own */
    struct cs_session session; /* up to the plan, unless it was refused */
    struct cs_error refusal;   /* why it was */
    char key[CS_HASH_DIGITS];
};

/* Reads the scene with the cell's values and computes its key: a hash of the resolved scene
 * with its mesh files, of method, options and module, of frames and version. The key of a
 * refused cell hashes the request and the reason. A refusal is no error here. CS_ERR_USAGE and
 * other errors that are not the cell's own; CS_ERR_MEMORY. */
enum cs_status cs_parameter_sweep_cell_open(struct cs_parameter_sweep_cell *cell,
                                            const struct cs_parameter_sweep *product,
                                            uint32_t number, struct cs_error *error);
/* Closes the cell's session. */
void cs_parameter_sweep_cell_close(struct cs_parameter_sweep_cell *cell);

/* Runs the cell and adds its row. A refusal by scene or method is a row, and counted.
 * CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
enum cs_status cs_parameter_sweep_cell_run(struct cs_parameter_sweep_cell *cell,
                                           struct cs_parameter_sweep *product,
                                           struct cs_text *out, struct cs_error *error);

/* Adds the names of the columns, without the end of the line. */
void cs_parameter_sweep_add_head(const struct cs_parameter_sweep *product, struct cs_text *out);

#endif
