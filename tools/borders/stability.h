/* stability.h - maps the stable time steps of a method.
 *
 * The map has cells of dt against an axis of the scene. Each cell is one run with a verdict
 * (sampled_run.h) relative to the reference of its column. The border between stable and
 * unstable cells is bisected, and the limits of linear theory are computed for comparison
 * (theory.h).
 *
 *   settings -> session -> columns and rows -> journal -> per column, in a worker process:
 *   reference and limits -> cells by rising dt -> border -> journal -> report */
#ifndef CS_STABILITY_H
#define CS_STABILITY_H

#include "borders/stability_state.h"
#include "session/table.h"

/* Reads scene and method, and names the series. Returns CS_ERR_USAGE if the integrator has no
 * fixed dt; further CS_ERR_SCENE, CS_ERR_FILE, CS_ERR_MEMORY. settings must outlive the map.
 * cs_stability_finish must be called in any case. */
enum cs_status cs_stability_open(struct cs_stability *stability,
                                 const struct cs_stability_settings *settings,
                                 struct cs_error *error);
/* Makes the map. Returns CS_ERR_USAGE if the scene has no value on the axis, or if no column
 * has a reference; further CS_ERR_SCENE, CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_stability_run(struct cs_stability *stability, struct cs_error *error);
/* Frees the map and closes its session; a zeroed map is allowed. */
void cs_stability_finish(struct cs_stability *stability);

/* Prints a map as text, CSV and JSON. */

/* Adds the map as a table for readers: letters of verdicts, border and limits below, legend. */
void cs_stability_print_table(const struct cs_stability *stability, struct cs_text *out);
/* The columns of both files behind the first, which is called like the axis. */
extern const struct cs_column cs_stability_columns[], cs_stability_border_columns[];
extern const uint32_t cs_stability_n_columns, cs_stability_n_border_columns;

/* Adds one row per cell; cell_left .. cell_top are the edges of its rectangle in a diagram. */
void cs_stability_print_csv(const struct cs_stability *stability, struct cs_text *out);
/* Adds one row per column: border, limits of theory in s, and the mode that limits the step. */
void cs_stability_print_borders_csv(const struct cs_stability *stability, struct cs_text *out);
/* Adds the whole map; limits that do not exist are null. */
void cs_stability_print_json(const struct cs_stability *stability, struct cs_text *out);

#endif
