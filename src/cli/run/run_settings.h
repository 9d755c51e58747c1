/* run_settings.h - what a run is asked for. */
#ifndef CS_RUN_SETTINGS_H
#define CS_RUN_SETTINGS_H

#include "cli/run/run_export.h"
#include "cli/run/run_resume.h"
#include "cli/run/run_trail.h"
#include "draw/render.h"
#include "study/session.h"

struct cs_job_settings {
    struct cs_session_settings session;
    uint32_t frames;                    /* 0: one second of them */
    uint32_t every;                     /* draw every n-th frame */
    const char *folder, *states, *json; /* json "-": stdout; states, json NULL: none */
    const char *watch;                  /* CSV of energy, strain and velocity; NULL: none */
    const char *ledger;                 /* CSV of where energy went; NULL: none */
    enum cs_renderer_kind renderer;
    uint32_t level;                   /* zlib */
    struct cs_resume_pace checkpoint; /* zeroed: none */
    struct cs_run_trail trail;        /* zeroed: none */
    bool resume;                      /* go on from the checkpoint in the folder */
    struct cs_export_settings export; /* into the folder, as often as pictures */
    bool fast, hash, overwrite, quiet;
};

/* How many frames are simulated. */
uint32_t cs_job_frames(const struct cs_job_settings *settings, const struct cs_scene *scene);

/* true where the run is written as JSON somewhere. */
static inline bool cs_job_wants_json(const struct cs_job_settings *settings) {
    return settings->session.render || settings->json;
}

bool cs_job_makes_checkpoints(const struct cs_job_settings *settings);
/* Pictures, checkpoints and exports go into the folder. */
bool cs_job_uses_folder(const struct cs_job_settings *settings);

/* Adds which files there will be, a line each: checkpoints are of use only where those of a run
 * would be the same ones. renderer: what draws, where pictures are drawn. */
void cs_job_print_outputs(const struct cs_job_settings *settings, const char *renderer,
                          struct cs_text *out);

#endif
