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

static const char *yes_or_no(bool fact) {
    return fact ? "yes" : "no";
}

void cs_job_print_outputs(const struct cs_job_settings *settings, const char *renderer,
                          struct cs_text *out) {
    cs_text_add(out,
                "pictures by: %s\ndrawn every: %u\nPNG level: %u\nfast-render: %s\nstates: "
                "%s\nwatch: %s\nledger: %s\nJSON: %s\nexport:",
                settings->session.render ? renderer : "none", settings->frame_interval,
                settings->level, yes_or_no(settings->fast_render),
                yes_or_no(settings->states != NULL), yes_or_no(settings->monitor_file != NULL),
                yes_or_no(settings->ledger != NULL), yes_or_no(cs_job_wants_json(settings)));
    cs_run_export_print(&settings->export, out);
    cs_text_add(out, "\n");
}
