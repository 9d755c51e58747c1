/* Runs gnuplot on a script if the program is installed. */
#include "io/gnuplot.h"

#include "io/subprocess.h"

#include <stddef.h>

enum cs_status cs_gnuplot_run(const char *folder, const char *script, bool *drawn,
                              struct cs_error *error) {
    struct cs_subprocess_result end;
    /* quiet: its warnings about fonts would only confuse the user */
    const enum cs_status status = cs_subprocess_run(
        folder, (const char *const[]){"gnuplot", script, NULL}, true, &end, error);
    *drawn = end.exited_ok;
    return status;
}
