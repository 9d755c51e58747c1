/* gnuplot.h - runs gnuplot on a script if the program is installed. */
#ifndef CS_GNUPLOT_H
#define CS_GNUPLOT_H

#include "base/status.h"

#include <stdbool.h>

/* Runs FOLDER/SCRIPT in the working directory FOLDER. *drawn: gnuplot ran and succeeded; it may
 * be missing or fail, which is no failure here. CS_ERR_MEMORY. */
enum cs_status cs_gnuplot_run(const char *folder, const char *script, bool *drawn,
                              struct cs_error *error);

#endif
