/* gnuplot.h - runs gnuplot on a script where the program is found. */
#ifndef CS_GNUPLOT_H
#define CS_GNUPLOT_H

#include "base/status.h"

#include <stdbool.h>

/* Runs FOLDER/SCRIPT with FOLDER as the working directory. *drawn: it ran and was content; it
 * may be absent or refuse, which is no failure. CS_ERR_MEMORY. */
enum cs_status cs_gnuplot_run(const char *folder, const char *script, bool *drawn,
                              struct cs_error *error);

#endif
