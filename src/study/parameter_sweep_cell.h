/* parameter_sweep_cell.h - one cell of a sweep: its values, its key, its run, its row. */
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

/* Reads the scene with the cell's values. The key is of what the scene means, mesh files too,
 * of the method with its options and the build of its module, of the number of frames and the
 * program's version; of a cell that is refused, of what was asked and why not. CS_ERR_USAGE and
 * what else is no fault of the cell's own; CS_ERR_MEMORY. */
enum cs_status cs_parameter_sweep_cell_open(struct cs_parameter_sweep_cell *cell,
                                            const struct cs_parameter_sweep *product,
                                            uint32_t number, struct cs_error *error);
void cs_parameter_sweep_cell_close(struct cs_parameter_sweep_cell *cell);

/* Runs it and adds its row. CS_ERR_INTERRUPT, CS_ERR_MEMORY; what the scene or the method
 * refuses is a row, and counted. */
enum cs_status cs_parameter_sweep_cell_run(struct cs_parameter_sweep_cell *cell,
                                           struct cs_parameter_sweep *product,
                                           struct cs_text *out, struct cs_error *error);

/* Adds the names of the columns, without the end of the line. */
void cs_parameter_sweep_add_head(const struct cs_parameter_sweep *product, struct cs_text *out);

#endif
