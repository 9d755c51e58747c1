/* Plays the pictures of a run in the terminal. */
#include "film/film_sheet.h"

#include "base/clock.h"
#include "base/png.h"
#include "cli/line/print.h"
#include "cli/show/screen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { PATH_BYTES = 4096 };

/* Returns early after an interruption. */
static void wait_until(double wall) {
    const double seconds = wall - cs_clock_wall();
    const struct timespec time = {.tv_sec = (time_t)fmax(seconds, 0),
                                  .tv_nsec = (long)(1e9 * fmod(fmax(seconds, 0), 1))};
    nanosleep(&time, NULL);
}

static enum cs_status show(struct cs_screen *screen, const char *folder,
                           const struct cs_film_report *report, uint32_t k,
                           struct cs_error *error) {
    char path[PATH_BYTES], caption[80];
    struct cs_image image;
    const struct cs_film_picture *picture = report->pictures + k;
    snprintf(path, sizeof path, "%.4000s/frame_%05u.png", folder, picture->number);
    snprintf(caption, sizeof caption, "picture %u of %u, %.4g s", k + 1, report->n,
             picture->frame / report->fps);
    if (cs_png_read_on_white(path, &image, error))
        return error->status;
    cs_screen_show_image(screen, &image, caption, error);
    free(image.rgb);
    return error->status;
}

enum cs_status cs_film_show(const char *folder, const struct cs_film_report *report,
                            double rate, struct cs_error *error) {
    const volatile sig_atomic_t *stop = cs_interrupt_catch();
    struct cs_screen screen;
    if (cs_screen_open(&screen, true, error))
        return error->status;
    const double start = cs_clock_wall();
    for (uint32_t k = 0; k < report->n && !*stop && !error->status; k++) {
        const double due = start + k / rate;
        const bool late = cs_clock_wall() > due + 1 / rate;
        if (late && k + 1 < report->n)
            continue;
        wait_until(due);
        show(&screen, folder, report, k, error);
    }
    return error->status || !*stop ? error->status
                                   : cs_fail(error, CS_ERR_INTERRUPT, "interrupted");
}
