/* Writes numbered PNG frames on a worker thread, through a queue of two images.
 *
 * The queue is a ring of slots. `given` counts frames that the caller submitted, `written`
 * those that the worker finished; slot k % depth holds frame k. The caller draws into slot
 * given % depth, the worker encodes slot written % depth. They never touch the same slot, since
 * acquire waits until given - written < depth. The lock guards the counters, the first error
 * and `closing`.
 *
 * Two images suffice: one is drawn while the other is encoded. More never gained time. */
#include "cli/run/frame_writer.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/worker_thread.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH = 2 }; /* slots of the ring */

/* One image between drawing and its file. */
struct slot {
    struct cs_image image; /* owned */
    uint32_t number, n_texts;
    struct cs_png_text *texts; /* of the arena */
    struct cs_arena arena;
};

/* Members after `lock` may be read and written only with the lock held. */
struct cs_frame_writer {
    char *folder;   /* owned */
    int level;      /* of compression */
    uint32_t depth; /* slots in use */
    struct slot slots[DEPTH];
    bool threaded;
    pthread_t worker;

    pthread_mutex_t lock; /* for what follows */
    pthread_cond_t changed;
    uint64_t given, written;
    bool closing;
    struct cs_error error; /* of the first write that failed */
    double seconds;
};

/* Outside the lock: only the encoder touches a slot that is queued. */
static void encode(struct cs_frame_writer *frames, struct slot *slot, struct cs_error *error) {
    char path[4096];
    const int length =
        snprintf(path, sizeof path, "%s/frame_%05u.png", frames->folder, slot->number);
    if (length < 0 || (size_t)length >= sizeof path)
        cs_fail(error, CS_ERR_FILE, "the path of frame %u is too long", slot->number);
    else
        cs_png_write_next(path, &slot->image, frames->level, slot->texts, slot->n_texts, error);
    cs_arena_finish(&slot->arena);
}

/* Encodes the oldest queued frame; called and left with the lock held. After a failure it only
 * releases the slot. */
static void encode_next(struct cs_frame_writer *frames) {
    struct slot *slot = frames->slots + frames->written % frames->depth;
    struct cs_error error = {0};
    const bool skip = frames->error.status != CS_OK;
    const double start = cs_clock_wall();
    pthread_mutex_unlock(&frames->lock);
    if (skip)
        cs_arena_finish(&slot->arena);
    else
        encode(frames, slot, &error);
    pthread_mutex_lock(&frames->lock);
    if (error.status)
        frames->error = error;
    frames->seconds += cs_clock_wall() - start;
    frames->written++;
    pthread_cond_broadcast(&frames->changed);
}

/* The worker: encodes until the writer closes and the queue is empty. */
static void *work(void *argument) {
    struct cs_frame_writer *frames = argument;
    pthread_mutex_lock(&frames->lock);
    for (;;) {
        while (frames->written == frames->given && !frames->closing)
            pthread_cond_wait(&frames->changed, &frames->lock);
        if (frames->written == frames->given)
            break;
        encode_next(frames);
    }
    pthread_mutex_unlock(&frames->lock);
    return NULL;
}

/* Allocates zeroed pixels of one image. */
static bool take_image(struct cs_image *image,
                       const struct cs_frame_writer_settings *settings) {
    const size_t n = (size_t)settings->width * settings->height;
    image->width = settings->width;
    image->height = settings->height;
    image->rgb = calloc(n, 3);
    image->alpha = settings->alpha ? calloc(n, 1) : NULL;
    return image->rgb && (image->alpha || !settings->alpha);
}

enum cs_status cs_frame_writer_create(const char *folder,
                                      const struct cs_frame_writer_settings *settings,
                                      struct cs_frame_writer **frames, struct cs_error *error) {
    CS_ASSERT(settings->width && settings->height);
    *frames = NULL;
    if (cs_png_load(error))
        return error->status;
    struct cs_frame_writer *made = calloc(1, sizeof *made);
    if (!made)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for frames");
    pthread_mutex_init(&made->lock, NULL);
    pthread_cond_init(&made->changed, NULL);
    made->level = settings->level;
    bool enough = (made->folder = strdup(folder)) != NULL;
    made->depth = settings->threaded ? DEPTH : 1;
    for (uint32_t i = 0; enough && i < made->depth; i++)
        enough = take_image(&made->slots[i].image, settings);
    if (!enough) {
        cs_frame_writer_destroy(made);
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for frames of %u x %u pixels",
                       settings->width, settings->height);
    }
    /* without a thread the same frames come out, only later */
    made->threaded = settings->threaded && !cs_thread_start(&made->worker, work, made);
    *frames = made;
    return CS_OK;
}

struct cs_image *cs_frame_writer_acquire(struct cs_frame_writer *frames) {
    pthread_mutex_lock(&frames->lock);
    while (frames->given - frames->written >= frames->depth)
        pthread_cond_wait(&frames->changed, &frames->lock);
    struct cs_image *image = &frames->slots[frames->given % frames->depth].image;
    pthread_mutex_unlock(&frames->lock);
    return image;
}

/* Copies texts into the slot's arena, since the caller's may change before they are written. */
static enum cs_status copy_texts(struct slot *slot, const struct cs_png_text *texts,
                                 uint32_t n_texts, struct cs_error *error) {
    slot->n_texts = n_texts;
    slot->texts = cs_arena_alloc_array(&slot->arena, n_texts, sizeof *texts, error);
    for (uint32_t i = 0; i < n_texts && !error->status; i++) {
        slot->texts[i].key = cs_arena_copy_text(&slot->arena, texts[i].key, error);
        slot->texts[i].value = cs_arena_copy_text(&slot->arena, texts[i].value, error);
    }
    if (error->status)
        cs_arena_finish(&slot->arena);
    return error->status;
}

/* Returns the first failure of a write, also to a caller that already got it. */
static enum cs_status report_first_failure(const struct cs_frame_writer *frames,
                                           struct cs_error *error) {
    return frames->error.status
               ? cs_fail(error, frames->error.status, "%s", frames->error.message)
               : CS_OK;
}

enum cs_status cs_frame_writer_submit(struct cs_frame_writer *frames, uint32_t number,
                                      const struct cs_png_text *texts, uint32_t n_texts,
                                      struct cs_error *error) {
    /* only this thread moves `given`, and the slot behind it is not yet the worker's */
    struct slot *slot = frames->slots + frames->given % frames->depth;
    slot->number = number;
    if (copy_texts(slot, texts, n_texts, error))
        return error->status;
    pthread_mutex_lock(&frames->lock);
    frames->given++;
    pthread_cond_broadcast(&frames->changed);
    if (!frames->threaded)
        encode_next(frames);
    const enum cs_status status = report_first_failure(frames, error);
    pthread_mutex_unlock(&frames->lock);
    return status;
}

enum cs_status cs_frame_writer_finish(struct cs_frame_writer *frames, double *seconds,
                                      struct cs_error *error) {
    pthread_mutex_lock(&frames->lock);
    while (frames->written < frames->given)
        pthread_cond_wait(&frames->changed, &frames->lock);
    *seconds = frames->seconds;
    const enum cs_status status = report_first_failure(frames, error);
    pthread_mutex_unlock(&frames->lock);
    return status;
}

void cs_frame_writer_destroy(struct cs_frame_writer *frames) {
    if (!frames)
        return;
    if (frames->threaded) {
        pthread_mutex_lock(&frames->lock);
        frames->closing = true;
        pthread_cond_broadcast(&frames->changed);
        pthread_mutex_unlock(&frames->lock);
        pthread_join(frames->worker, NULL);
    }
    pthread_cond_destroy(&frames->changed);
    pthread_mutex_destroy(&frames->lock);
    for (uint32_t i = 0; i < DEPTH; i++) {
        free(frames->slots[i].image.rgb);
        free(frames->slots[i].image.alpha);
    }
    free(frames->folder);
    free(frames);
}
