/* table_plot.h - diagrams of tables that the program writes: monitors, ledgers, stability maps.
 */
#ifndef CS_TABLE_PLOT_H
#define CS_TABLE_PLOT_H

#include "base/arena.h"
#include "base/table.h"
#include "draw/diagram.h"

/* The columns of the ledger that stand in every one: forces may add columns of their own. */
extern const struct cs_column cs_ledger_columns[];
extern const uint32_t cs_n_ledger_columns;

enum { CS_TABLE_PANELS = 8 };

/* A diagram with its memory. */
struct cs_table_plot {
    struct cs_diagram diagram;
    struct cs_panel panels[CS_TABLE_PANELS];
    struct cs_arena arena; /* names, points, boxes */
};

/* Request for a diagram; texts are borrowed. */
struct cs_table_plot_settings {
    const char *path;     /* a CSV whose first line names its columns */
    const char *x, *y;    /* NULL: see below; y: "NAME,NAME" */
    const char *log_axes; /* "", "x", "y" or "xy"; not of maps */
    const char *title;
    double width; /* mm */
};

/* Makes the diagram of a stability map, with its border in NAME_border.csv where that is there;
 * of other tables lines over x ("t", or the first column), a panel per unit: of all columns
 * that are not zero throughout, but for indices and bounds. A table whose first column is
 * "series" has a line for each. cs_table_plot_finish must be called in any case. CS_ERR_USAGE
 * for names that are not there, CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_table_plot_make(struct cs_table_plot *plot,
                                  const struct cs_table_plot_settings *settings,
                                  struct cs_error *error);
void cs_table_plot_finish(struct cs_table_plot *plot);

#endif
