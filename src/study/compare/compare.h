/* compare.h - compares error and cost of many methods on one scene.
 *
 *   scene -> key -> compare.csv of an earlier run -> verified reference and horizon
 *   -> cells, by falling step or tolerance -> each run, measured, appended to compare.csv
 *   -> rounds of timed runs -> orders, ranking, verdict, warnings -> report
 * Cells are timed one at a time in this process; only stepping is timed. A series ends at its
 * first cell over budget, because shorter steps take longer. */
#ifndef CS_COMPARE_H
#define CS_COMPARE_H

#include "session/frame_picture.h"
#include "study/compare/compare_curves.h"
#include "study/compare/compare_state.h"
#include "study/compare/equal_error.h"

/* Prints a comparison as aligned text. */

/* Adds the scene with its contact and switched-off corrections, and the reference: methods,
 * error bar, horizon. */
void cs_table_add_reference(const struct cs_compare *compare, struct cs_text *out);

/* Adds the estimated work of the reference, unless it is little. */
void cs_table_add_estimate(const struct cs_compare *compare, struct cs_text *out);

/* Add the names of the columns, and the row of a cell. */
void cs_table_add_head(const struct cs_compare *compare, struct cs_text *out);
void cs_table_add_row(const struct cs_compare *compare, const struct cs_cell *cell,
                      struct cs_text *out);

/* Adds one line per series: observed order, largest stable step, achieved tolerance. */
void cs_table_add_series(const struct cs_compare *compare, bool all, struct cs_text *out);

/* Adds the energy balance of each cell, as far as it is known. */
void cs_table_add_ledger(const struct cs_compare *compare, struct cs_text *out);

/* Names of the columns of the energy balance, by enum cs_ledger_work. */
extern const char *const cs_table_work_names[];

/* Makes the comparison and fills compare.csv. If there is no valid reference, the cells have
 * costs and counts only: that is a result. On failure the finished rows stay in compare.csv.
 * settings must outlive *compare; cs_compare_finish must be called in any case. CS_ERR_USAGE
 * for methods that cannot be read or a folder of another comparison; CS_ERR_SCENE,
 * CS_ERR_MODULE, CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_compare_run(struct cs_compare *compare,
                              const struct cs_compare_settings *settings,
                              struct cs_error *error);

/* Frees all results; a zeroed object is allowed. */
void cs_compare_finish(struct cs_compare *compare);

/* Adds the page: command, reference, verdict, warnings, pictures, the diagram as SVG, tables,
 * machine. */
void cs_compare_print_html(const struct cs_compare *compare, const struct cs_ranking *ranking,
                           struct cs_text *out);

/* Writes the files of a comparison besides compare.csv: JSON, Markdown,
 * diagrams. */

/* Writes compare.json, compare.md, and compare.html on request; the diagram as compare.png,
 * .svg and .pdf for two columns of a journal and compare_column.* for one, where the module
 * that draws is there. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_write_report(struct cs_compare *compare, struct cs_error *error);

/* The settings of its diagram: error against work and, beside it, time. Without pointwise
 * errors it is the energy error, which remains valid beyond the horizon. */
void cs_compare_plot_settings(const struct cs_compare *compare, double width,
                              struct cs_plot_settings *settings);

/* Contact sheets: the last frame of each method, with particles coloured by
 * their distance to the reference. */

/* Writes FOLDER/pictures/KIND_SERIES.png. KIND is equal_step (the step with which most methods
 * finished) or equal_cost (the best of each method within a cost that all can keep). Colours
 * are powers of ten from the reference's bar to the largest error. Nothing is drawn without
 * errors of position. CS_ERR_MODULE (renderer), CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT.
 */
enum cs_status cs_compare_contact_sheet_write(struct cs_compare *compare,
                                              enum cs_renderer_kind kind,
                                              struct cs_error *error);
/* Adds the pictures that it has written to a report, if settings->pictures: html: as strips
 * with one colour bar, the pictures in the page; else as Markdown tables of their files. */
void cs_compare_contact_sheet_add(const struct cs_compare *compare, bool html,
                                  struct cs_text *out);

/* The error of meshes beside the error of steps.
 *
 *   a range of cells -> for each number, doubled: overrides of the grids -> a comparison of its
 *   own (compare.h) -> the last state of its verified reference
 *   -> its distance to that of the finest, at the particles of the coarser mesh
 * A method's error on a mesh is the sum of both; steps whose error is far below that of the
 * mesh pay for nothing. The finest mesh has an error too: errors of the next coarser one are
 * too small by a third at order 2. */

/* One mesh of a scene. */
struct cs_mesh_level {
    uint32_t cells;                /* along the first row of the first body */
    struct cs_override *overrides; /* (n_overrides) those of the session, then the grids */
    uint32_t n_overrides;
    double *x;            /* (3,n) m, last state of the reference; NULL: there is none */
    uint32_t *grids;      /* (n_bodies, 2) particles along rows and columns */
    double error, bar;    /* m: RMS distance to the finest; of the reference. NAN: not known */
    struct cs_cell *rows; /* (n_rows) finished cells of the comparison */
    uint32_t n_rows;
};

/* The meshes of one scene, coarsest first. */
struct cs_mesh_study {
    struct cs_arena arena; /* owns all */
    const char *scene;
    uint32_t n_bodies, n;
    struct cs_mesh_level *levels; /* (n) */
};

/* Reads "LOW..HIGH" and makes the levels of a scene. CS_ERR_USAGE for a range that is none, or
 * whose cells do not divide among the scene's grids; CS_ERR_SCENE for a body that is no grid.
 * On failure, too, the study must be finished. */
enum cs_status cs_mesh_study_begin(struct cs_mesh_study *study, const char *range,
                                   const struct cs_session_settings *session,
                                   struct cs_error *error);
/* Copies the results of a level from its comparison. CS_ERR_MEMORY. */
enum cs_status cs_mesh_level_store(struct cs_mesh_study *study, struct cs_mesh_level *level,
                                   const struct cs_compare *compare, struct cs_error *error);
/* Finds the errors of the meshes, once all levels are taken. */
void cs_mesh_study_measure(struct cs_mesh_study *study);

/* Writes FOLDER/mesh.csv of the studies of n scenes, and adds a line for each level and series:
 * the cheapest row whose step is more accurate than the mesh, else the most accurate one.
 * CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_mesh_studies_report(const struct cs_mesh_study *studies, uint32_t n,
                                      const char *folder, struct cs_text *out,
                                      struct cs_error *error);
/* Frees everything; a zeroed study is allowed. */
void cs_mesh_study_finish(struct cs_mesh_study *study);

#endif
