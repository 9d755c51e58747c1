/* Shows a progress line with the time that is left: one that changes on a terminal, else one
 * now and then. */
#include "cli/line/progress.h"

#include "base/clock.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

void cs_progress_begin(struct cs_progress *progress, const char *what, bool quiet) {
    *progress =
        (struct cs_progress){.shown = !quiet, .terminal = isatty(STDERR_FILENO), .label = what};
    progress->start = progress->last = cs_clock_wall();
}

/* s between two lines of a log */
#define OFF_TERMINAL 30

static void write_line(struct cs_progress *progress, const char *line) {
    const int width = (int)strlen(line);
    /* blanks cover what is left of a longer line, on the plainest of terminals too */
    fprintf(stderr, "\r%s%*s", line, width < progress->width ? progress->width - width : 0, "");
    fflush(stderr);
    progress->width = width;
}

void cs_progress_show(void *ctx, uint32_t done, uint32_t total) {
    struct cs_progress *progress = ctx;
    const double now = cs_clock_wall();
    if (!progress->shown || !done ||
        now - progress->last < (progress->terminal ? 0.1 : OFF_TERMINAL))
        return;
    const double left = (now - progress->start) / done * (total - done);
    char line[80];
    snprintf(line, sizeof line, "%s %u of %u, %u %%, %.0f:%02u left", progress->label, done,
             total, (uint32_t)(100.0 * done / total), (left - (uint32_t)left % 60) / 60,
             (uint32_t)left % 60);
    if (progress->terminal)
        write_line(progress, line);
    else
        fprintf(stderr, "%s\n", line);
    progress->last = now;
}

void cs_progress_end(struct cs_progress *progress) {
    if (!progress->width)
        return;
    write_line(progress, "");
    fputc('\r', stderr);
    fflush(stderr);
}
