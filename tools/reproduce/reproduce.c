/* Reproduces a run or a picture, and names the first difference. */
#include "reproduce/reproduce.h"

#include "base/hash.h"
#include "session/frame_picture.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "shared/image_diff.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A reproduction in progress; zeroed: nothing. */
struct work {
    struct cs_reproduction *reproduction;
    const struct cs_reproduction_settings *settings;
    struct cs_provenance carried;
    struct cs_session session;
    struct cs_serialiser serialiser; /* for methods that restart at each checkpoint */
};

/* Records the first difference; everything after it is skipped. */
static void differ(struct work *work, const char *what, const char *then, const char *now) {
    cs_text_add(&work->reproduction->first_difference, "%s was %s, is %s", what, then, now);
}

static bool has_differed(const struct work *work) {
    return work->reproduction->first_difference.length;
}

/* Opens a session from the provenance, and notes changes since the result was made. */
static enum cs_status begin(struct work *work, bool render, struct cs_error *error) {
    struct cs_session_settings asked = work->settings->session;
    asked.render = render;
    if (cs_provenance_to_session(&work->carried, work->settings->folder, &asked, error) ||
        cs_session_open(&work->session, &asked, error))
        return error->status;
    return cs_provenance_add_changes(&work->carried, &work->session, &work->reproduction->notes,
                                     error);
}

static void finish(struct work *work) {
    cs_serialiser_finish(&work->serialiser);
    cs_session_close(&work->session);
    cs_provenance_finish(&work->carried);
}

/* Saves a checkpoint where the original run did: a method without saved history restarts there,
 * which changes its next steps. */
static enum cs_status restart(struct work *work, struct cs_error *error) {
    struct cs_run *run = &work->session.run;
    const uint32_t every = work->carried.restarts;
    if (!every || run->frame % every != 0 || cs_run_method_has_history(run->integrator))
        return CS_OK;
    cs_serialiser_begin(&work->serialiser);
    return cs_run_save(run, &work->serialiser, error);
}

/* Runs one frame. Returns false if the run has ended or failed. */
static bool step(struct work *work, uint32_t total, struct cs_error *error) {
    const struct cs_reproduction_settings *settings = work->settings;
    struct cs_run *run = &work->session.run;
    struct cs_follow follow = {.run = run, .last = run->frame + 1.0, .every = 1};
    if (!cs_follow_next(&follow, error))
        return false;
    if (settings->progress)
        settings->progress(settings->ctx, run->frame, total);
    return true;
}

static enum cs_status take_end(const struct work *work, struct cs_run_result *result,
                               struct cs_error *error) {
    char where[32];
    snprintf(where, sizeof where, " in frame %u", work->session.run.frame + 1);
    return cs_follow_result(&work->session.run, where, result, error);
}

/* Compares the hash of the present state with the stored one. */
static void compare_state(struct work *work, const char *then) {
    const struct cs_run *run = &work->session.run;
    char now[CS_HASH_DIGITS], what[48];
    cs_run_hash(run, now);
    snprintf(what, sizeof what, "the state of frame %u", run->frame);
    if (strcmp(then, now) != 0)
        differ(work, what, then, now);
}

/* Compares the outcomes. A run that ended by itself did so in the frame after its last one,
 * hence one more step. An interrupted run has no outcome to compare. */
static enum cs_status compare_end(struct work *work, uint32_t total, struct cs_error *error) {
    const struct cs_json *root = work->carried.json;
    const char *then = cs_provenance_text(root, "outcome");
    const char *detail = cs_provenance_text(root, "outcome_detail");
    struct cs_run_result now;
    if (!strcmp(then, cs_outcome_text(CS_INTERRUPTED)))
        return CS_OK;
    if (strcmp(then, cs_outcome_text(CS_RUNNING)) != 0)
        step(work, total, error);
    if (take_end(work, &now, error))
        return error->status;
    if (strcmp(then, cs_outcome_text(now.outcome)) != 0)
        differ(work, "the outcome", then, cs_outcome_text(now.outcome));
    else if (cs_outcome_has_reason(now.outcome) && !strstr(detail, now.message))
        differ(work, "the reason", detail, now.message);
    else
        cs_text_add(&work->reproduction->equal_items, " and the outcome");
    return CS_OK;
}

/* The original run has a state where this one has ended: that is the difference. */
static enum cs_status describe_early_end(struct work *work, struct cs_error *error) {
    char what[48];
    struct cs_run_result now;
    snprintf(what, sizeof what, "the end of frame %u", work->session.run.frame + 1);
    if (!take_end(work, &now, error))
        differ(work, what, "a state", now.message);
    return error->status;
}

/* Compares frame by frame up to the first difference. */
static enum cs_status compare_frames(struct work *work, struct cs_error *error) {
    const struct cs_json *frames = cs_json_find(work->carried.json, "frames");
    const uint32_t total = cs_json_count(frames);
    const struct cs_json *frame = cs_json_first(frames);
    uint32_t equal = 0;
    for (; frame && !has_differed(work) && !error->status; frame = cs_json_next(frame)) {
        const struct cs_json *number = cs_json_find_kind(frame, "number", CS_JSON_NUMBER);
        const bool is_start = number && cs_json_number(number) == 0;
        if (!is_start && !step(work, total, error)) {
            describe_early_end(work, error);
            break;
        }
        compare_state(work, cs_provenance_text(frame, "hash"));
        equal += !has_differed(work);
        restart(work, error);
    }
    cs_text_add(&work->reproduction->equal_items, "%u of %u states", equal, total);
    return error->status || has_differed(work) ? error->status
                                               : compare_end(work, total, error);
}

static void describe(struct work *work, uint32_t frames) {
    cs_text_add(&work->reproduction->description, "%u frame%s of %s by %s", frames,
                frames == 1 ? "" : "s", work->carried.scene_file, work->carried.method);
}

enum cs_status cs_reproduction_of_run(struct cs_reproduction *reproduction,
                                      const struct cs_reproduction_settings *settings,
                                      struct cs_error *error) {
    struct work work = {.reproduction = reproduction, .settings = settings};
    if (!cs_provenance_read(&work.carried, settings->file, error)) {
        const struct cs_json *frames = cs_json_find(work.carried.json, "frames");
        describe(&work, frames ? cs_json_count(frames) : 0);
        if (!frames || cs_json_kind_of(frames) != CS_JSON_LIST)
            cs_fail(error, CS_ERR_FILE, "%s: expected \"frames\", a list of states",
                    settings->file);
        else if (!begin(&work, false, error))
            compare_frames(&work, error);
    }
    finish(&work);
    return error->status;
}

enum { FRAME, STATE, PIXELS, RUN, TEXTS };
static const char *const keys[TEXTS] = {"clothsim:frame", "clothsim:state-hash",
                                        "clothsim:pixel-hash", "clothsim:run"};

/* The renderer of the original picture, because only its pixels can be equal. */
static enum cs_renderer_kind renderer_of(const struct cs_provenance *provenance) {
    for (int k = 0; cs_renderer_names[k]; k++)
        if (!strcmp(cs_renderer_names[k], provenance->renderer_name))
            return (enum cs_renderer_kind)k;
    return CS_RENDERER_AUTO;
}

/* Compares pixels. They must be equal if the renderer is the same; another renderer or version
 * must be within a tolerance (cs_image_difference_passes). */
static void compare_pixels(struct work *work, const struct cs_image *then,
                           const struct cs_image *now, const char *drawn_by) {
    struct cs_reproduction *reproduction = work->reproduction;
    const bool same = !work->carried.fast_render && !strcmp(drawn_by, work->carried.renderer);
    if (then->width != now->width || then->height != now->height) {
        cs_text_add(&reproduction->first_difference,
                    "it has %u x %u pixels, the scene says %u x %u", then->width, then->height,
                    now->width, now->height);
        return;
    }
    const struct cs_image_difference d = cs_image_compare(then, now);
    if (!same)
        cs_text_add(&reproduction->notes, "the renderer was %s, is %s\n",
                    work->carried.renderer, drawn_by);
    if (d.pixels && (same || !cs_image_difference_passes(&d)))
        cs_text_add(&reproduction->first_difference,
                    "%llu of %llu pixels differ, by at most %d levels of 255",
                    (unsigned long long)d.pixels,
                    (unsigned long long)then->width * then->height, d.largest);
    else
        cs_text_add(&reproduction->equal_items,
                    d.pixels ? ", pixels within the tolerance between renderers"
                             : " and all pixels");
}

/* Draws the state and compares it with the pixels of the file. */
static enum cs_status draw(struct work *work, const struct cs_image *then, const char *pixels,
                           struct cs_error *error) {
    struct cs_image now = {0};
    struct cs_text drawn_by = {0};
    char hash[CS_HASH_DIGITS];
    cs_hash_bytes(then->rgb, cs_image_bytes(then), hash);
    if (strcmp(hash, pixels) != 0)
        cs_text_add(&work->reproduction->notes,
                    "the pixels in the file have changed since it was written\n");
    const struct cs_render *render = work->session.scene->render;
    /* as the run had it: colours are not laid on white then */
    if (render->background.kind == CS_BACKGROUND_NONE &&
        !(now.alpha = malloc((size_t)render->size[0] * (size_t)render->size[1])))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
    else if (!cs_snapshot_draw(&work->session.run, NULL, renderer_of(&work->carried), &now,
                               &drawn_by, error))
        compare_pixels(work, then, &now, cs_text_get(&drawn_by));
    free(now.rgb);
    free(now.alpha);
    cs_text_finish(&drawn_by);
    return error->status;
}

/* Runs to the frame of the picture, restarting where the original did, and compares. */
static enum cs_status compare_picture(struct work *work, uint32_t frame, char **texts,
                                      const struct cs_image *image, struct cs_error *error) {
    while (work->session.run.frame < frame && !error->status) {
        if (!step(work, frame, error))
            return describe_early_end(work, error);
        if (work->session.run.frame < frame)
            restart(work, error);
    }
    if (error->status)
        return error->status;
    compare_state(work, texts[STATE]);
    if (has_differed(work))
        return CS_OK;
    cs_text_add(&work->reproduction->equal_items, "the state");
    return draw(work, image, texts[PIXELS], error);
}

enum cs_status cs_reproduction_of_picture(struct cs_reproduction *reproduction,
                                          const struct cs_reproduction_settings *settings,
                                          struct cs_error *error) {
    struct work work = {.reproduction = reproduction, .settings = settings};
    struct cs_image image;
    char *texts[TEXTS];
    double frame = 0;
    if (cs_png_read_texts(settings->file, keys, TEXTS, texts, &image, error))
        return error->status;
    for (int k = 0; k < TEXTS && !error->status; k++)
        if (!texts[k] ||
            (k == FRAME && (!cs_parse_real(texts[k], &frame) || !(frame >= 0) || frame > 1e9)))
            cs_fail(error, CS_ERR_FILE,
                    "%s: expected a picture of clothsim run, with a text %s", settings->file,
                    keys[k]);
    if (!error->status &&
        !cs_provenance_read_text(&work.carried, settings->file, texts[RUN], error)) {
        cs_text_add(&reproduction->description, "frame %.0f of %s by %s", frame,
                    work.carried.scene_file, work.carried.method);
        if (!begin(&work, true, error))
            compare_picture(&work, (uint32_t)frame, texts, &image, error);
    }
    finish(&work);
    free(image.rgb);
    for (int k = 0; k < TEXTS; k++)
        free(texts[k]);
    return error->status;
}

void cs_reproduction_finish(struct cs_reproduction *reproduction) {
    cs_text_finish(&reproduction->description);
    cs_text_finish(&reproduction->notes);
    cs_text_finish(&reproduction->equal_items);
    cs_text_finish(&reproduction->first_difference);
}
