/* mesh_error.h - the error of meshes beside the error of steps.
 *
 *   a range of cells -> for each number, doubled: overrides of the grids -> a comparison of its
 *   own (compare.h) -> the last state of its verified reference
 *   -> its distance to that of the finest, at the particles of the coarser mesh
 * A method's error on a mesh is the sum of both; steps whose error is far below that of the
 * mesh pay for nothing. The finest mesh has an error too: errors of the next coarser one are
 * too small by a third at order 2. */
#ifndef CS_MESH_ERROR_H
#define CS_MESH_ERROR_H

#include "study/compare/compare_state.h"

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
