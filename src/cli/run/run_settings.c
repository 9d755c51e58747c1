/* Says what settings of a run come to. */
#include "cli/run/run_settings.h"

#include <math.h>

uint32_t cs_job_frames(const struct cs_job_settings *settings, const struct cs_scene *scene) {
    const double second = floor(scene->time.fps + 0.5);
    return settings->frames ? settings->frames : second < 1 ? 1 : (uint32_t)second;
}

bool cs_job_makes_checkpoints(const struct cs_job_settings *settings) {
    return settings->checkpoint.frames || settings->checkpoint.seconds > 0 || settings->resume;
}

bool cs_job_uses_folder(const struct cs_job_settings *settings) {
    return settings->session.render || cs_job_makes_checkpoints(settings) ||
           settings->export.formats;
}
