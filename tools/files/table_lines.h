/* table_lines.h - draws columns of a table as lines. */
#ifndef CS_TABLE_LINES_H
#define CS_TABLE_LINES_H

#include "shared/table_plot.h"

/* True for a word of "a,b,c". */
bool cs_list_has(const char *list, const char *word);

/* Texts are borrowed. */
struct cs_line_settings {
    const char *x, *y;    /* NULL: see below; y: "NAME,NAME" */
    const char *log_axes; /* "", "x", "y" or "xy" */
    const char *path;     /* for messages */
};

/* Adds lines over x ("t", or the first column), a panel per unit: of all columns that are not
 * zero throughout, but for indices and bounds. A table whose first column is "series" has a
 * line for each. CS_ERR_USAGE for names that are not there, CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_table_lines_add(struct cs_diagram *plot, const struct cs_number_table *table,
                                  const struct cs_line_settings *settings,
                                  struct cs_error *error);

#endif
